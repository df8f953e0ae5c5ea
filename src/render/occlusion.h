#pragma once

#include <vector>

#include "render/stage.h"
#include "render/tile_mask.h"

namespace cradle {

/// What cannot be seen because balls stand before it: how far away the nearest ball is that fills a cell of 2 x 2
/// pixels.
class Occlusion {
 public:
  /// Nothing hides anything yet. `stage` must outlive this object. O(pixels).
  explicit Occlusion(const Stage& stage);

  /// A ball (m, world) that is drawn, or inside of something that is drawn. O(pixels of the ball).
  void add(const Vec3& center, double radius);

  /// Whether nothing is seen of what lies in those pixels, nowhere nearer than `nearest` (m, as depthOf() says). It may
  /// fail to notice; it is never wrong. O(pixels).
  bool hides(const PixelRectangle& pixels, double nearest) const;

  /// Distance from the plane through the eye, along the view (m).
  double depthOf(const Vec3& point) const;

 private:
  const Stage& stage_;
  const Mat3 axes_;     // of the camera: right, up, back
  const double focal_;  // pixels at a slope of 1
  const int columns_, rows_;
  std::vector<float> filledAt_;  // m, by row from the bottom, then column; infinite where nothing fills the cell
};

}  // namespace cradle
