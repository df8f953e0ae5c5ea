#pragma once

#include "commands/pictures.h"
#include "film/film_drawer.h"
#include "scene/scene.h"

namespace cradle {

/// What the command line says of pictures. Whatever is wrong with it shows before anything is simulated: throws
/// Error(usage), Error(limit) where there is too little memory to draw, or Error(scene) where words do not fit into
/// pictures of that size.
PictureOrder pictureOrderOf(const PictureOptions& options, const Scene& scene);

}  // namespace cradle
