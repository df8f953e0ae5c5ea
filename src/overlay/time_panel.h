#pragma once

#include "image/canvas.h"
#include "scene/scene.h"

namespace cradle {

/// The lower right end (pixels) of the panel with the scene's name and the time, in the upper left corner of a picture.
/// It is the same at all times.
PicturePoint timePanelEnd(const Scene& scene, int width, int height);

/// Draws it; `time` (s) is that of the scene.
void drawTimePanel(Canvas& canvas, const Scene& scene, double time);

}  // namespace cradle
