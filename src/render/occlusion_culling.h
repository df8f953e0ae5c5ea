#pragma once

#include <vector>

#include "render/render_setup.h"
#include "render/tile_mask.h"

namespace cradle {

/// Occlusion culling by spheres: how far away the nearest sphere is that fills a cell of 2 x 2 pixels. Items behind it
/// are not drawn.
class OcclusionCulling {
 public:
  /// Nothing hides anything yet. `setup` must outlive this object. O(pixels).
  explicit OcclusionCulling(const RenderSetup& setup);

  /// A sphere (m, world) that is drawn, or inside of something that is drawn. O(pixels of the sphere).
  void add(const Vec3& center, double radius);

  /// Whether nothing is seen of what lies in those pixels, nowhere nearer than `nearest` (m, as depthOf() says). It may
  /// fail to notice; it is never wrong. O(pixels).
  bool hides(const PixelRectangle& pixels, double nearest) const;

  /// Distance from the plane through the eye, along the view (m).
  double depthOf(const Vec3& point) const;

 private:
  const RenderSetup& setup_;
  const Mat3 axes_;     // of the camera: right, up, back
  const double focal_;  // pixels at a slope of 1
  const int columns_, rows_;
  std::vector<float> filledAt_;  // m, by row from the bottom, then column; infinite where nothing fills the cell
};

}  // namespace cradle
