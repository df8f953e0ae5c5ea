#pragma once

#include <optional>

#include "image/canvas.h"
#include "scene/scene.h"

namespace cradle {

/// A camera and the size of its pictures: where points of the world are seen.
struct Lens {
  Camera camera;
  int width = 0, height = 0;  // pixels

  /// Nothing for points (m, world) that are not clearly in front of the camera.
  std::optional<PicturePoint> see(const Vec3& point) const;
};

/// An arrow with a light edge around it, so that it is seen on any ground; `thickness` of the shaft in pixels. Shorter
/// than its head, it shrinks as a whole; shorter than two thicknesses, it is not drawn.
void drawArrow(Canvas& canvas, const PicturePoint& tail, const PicturePoint& tip, double thickness, const Ink& ink);

}  // namespace cradle
