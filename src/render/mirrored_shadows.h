#pragma once

#include <vector>

#include "render/drawn_hull.h"
#include "render/mirror_image.h"

namespace cradle {

/// Changed shadows on the ground, as spheres mirror them. Needs a ground.
class MirroredShadows {
 public:
  explicit MirroredShadows(const RenderSetup& setup) : setup_(setup) {}

  void addCaster(const DrawnHull& caster);
  void addDarkened(const DrawnHull& onGround);

  /// Where on a sphere they may be seen; `list` has its occluders.
  std::vector<DrawnHull> imagesOn(const SphereItem& sphere, const DrawList& list) const;

  /// Whether they may be seen on a mesh that stands for a sphere.
  bool areSeenOn(const MeshItem& item, const MeshBounds& bounds) const;

 private:
  double reachOf(const SphereItem& sphere, double widening) const;

  const RenderSetup& setup_;
  std::vector<BoundingSphere> patches_;
};

}  // namespace cradle
