#pragma once

#include <optional>

#include "image/canvas.h"
#include "scene/scene.h"

namespace cradle {

/// The lower right end (pixels) of the panel with the scene's name and the time, in the upper left corner of a picture.
/// It is the same at all times. `horizon`: the time (s) from which on the motion is one of many.
PicturePoint timePanelEnd(const Scene& scene, std::optional<double> horizon, int width, int height);

/// Draws it; `time` (s) is that of the scene.
void drawTimePanel(Canvas& canvas, const Scene& scene, std::optional<double> horizon, double time);

}  // namespace cradle
