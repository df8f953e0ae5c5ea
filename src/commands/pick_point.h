#pragma once

#include <string>

#include "commands/pictures.h"

namespace cradle {

/// `cradle pick SCENE|TRAJECTORY --frame K X,Y`: prints what the centre of a pixel (column and row) shows in a frame:
/// the body, the point in its frame and in the world, the normal, the nearest vertex of its mesh, and keys of a scene
/// for a push or an anchor there. Throws Error(usage) for a frame or pixel that there is not.
void pickPoint(const std::string& input, long frame, const std::string& pixel, const PictureOptions& options,
               bool quiet);

}  // namespace cradle
