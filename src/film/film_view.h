#pragma once

#include "film/film_source.h"
#include "render/camera_path.h"
#include "render/framing.h"

namespace cradle {

/// The view of a film; sizes in pixels. Reads all frames of a scene that names no camera, else the first, and those up
/// to the last push.
View viewOf(FilmSource& source, int width, int height);

/// Whether pictures can be drawn while the scene is simulated: not if the camera is to keep all in view, nor if more
/// frames than should be kept come before the last push, whose arrow is shown before it takes place.
bool isSeenFromTheStart(const Scene& scene);

/// The camera of each frame. `source` must outlive it.
FilmCamera cameraOf(FilmSource& source, const View& view);

}  // namespace cradle
