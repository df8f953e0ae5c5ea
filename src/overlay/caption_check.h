#pragma once

#include "scene/scene.h"

namespace cradle {

/// Throws Error(scene), a line for each fault, if captions or the title card have characters that the font lacks, or do
/// not fit into a picture of the scene's own size.
void requireReadableWords(const Scene& scene);

/// Throws Error(scene) if the title card, or all captions that are shown at once, do not fit into a picture of that
/// size (pixels) even with the smallest text.
void requireRoomForWords(const Scene& scene, int width, int height);

}  // namespace cradle
