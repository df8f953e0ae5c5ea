#pragma once

#include <vector>

#include "render/draw_list.h"
#include "render/stage.h"

namespace cradle {

/// A ball in space: bounds of something.
struct BoundingBall {
  Vec3 center;        // m, world
  double radius = 0;  // m
};

/// Where on `mirror`, a ball's surface, an eye somewhere in `eye` may see something that lies in `seen`, by one
/// reflection; the whole mirror where nothing better is known.
BoundingBall imageIn(const BoundingBall& mirror, const BoundingBall& eye, const BoundingBall& seen);

/// Where a ball may show something on the ground: straight, or by way of one of the neighbours near it. Needs a ground.
std::vector<BoundingBall> imagesOnBall(const SphereItem& ball, const BoundingBall& onGround, const DrawList& list,
                                       const Stage& stage);

}  // namespace cradle
