#pragma once

#include <vector>

#include "render/drawn_hull.h"
#include "render/mirror_image.h"

namespace cradle {

/// Changed shadows on the ground, as balls mirror them. Needs a ground.
class MirroredShadows {
 public:
  explicit MirroredShadows(const Stage& stage) : stage_(stage) {}

  void addCaster(const DrawnHull& caster);
  void addDarkened(const DrawnHull& onGround);

  /// Where on a ball they may be seen; `list` has its neighbours.
  std::vector<DrawnHull> imagesOn(const SphereItem& ball, const DrawList& list) const;

  /// Whether they may be seen on a mesh that stands for a ball.
  bool areSeenOn(const MeshItem& item, const MeshBounds& bounds) const;

 private:
  double reachOf(const SphereItem& ball, double widening) const;

  const Stage& stage_;
  std::vector<BoundingBall> patches_;
};

}  // namespace cradle
