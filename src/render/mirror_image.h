#pragma once

#include <vector>

#include "render/draw_list.h"
#include "render/render_setup.h"

namespace cradle {

/// A sphere in space: bounds of something.
struct BoundingSphere {
  Vec3 center;        // m, world
  double radius = 0;  // m
};

/// Where on `mirror`, a sphere's surface, an eye somewhere in `eye` may see something that lies in `seen`, by one
/// reflection; the whole mirror where nothing better is known.
BoundingSphere imageIn(const BoundingSphere& mirror, const BoundingSphere& eye, const BoundingSphere& seen);

/// Where a sphere may show something on the ground: straight, or by way of one of the occluders near it. Needs a
/// ground.
std::vector<BoundingSphere> imagesOnSphere(const SphereItem& sphere, const BoundingSphere& onGround,
                                           const DrawList& list, const RenderSetup& setup);

}  // namespace cradle
