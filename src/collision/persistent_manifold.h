#pragma once

#include <array>
#include <cstdint>

#include "collision/predicted_manifold.h"

namespace cradle {

/// The contact of two bodies that lasts over steps, and the forces that held it when it was last solved. As small as
/// can be: of the many of a heap each is in memory far away. Single precision holds points to 6e-8 of the body's size.
struct alignas(64) PersistentManifold {
  using Anchor = Eigen::Vector3f;  // from the centre of mass, in the body's frame

  int bodyA = kFixed, bodyB = kFixed;                     // A moves
  std::int32_t count = 0;                                 // of points
  Anchor normalOnA = Anchor::UnitY();                     // unit, A's frame
  std::array<Anchor, PredictedManifold::kMaxPoints> onA;  // m
  std::array<Anchor, PredictedManifold::kMaxPoints>
      onB;  // m; if B is fixed, world from where A was when they were found
  const ContactMaterial* material = nullptr;
  Vec3 normal = Vec3::UnitY();                                      // unit, world, from A to B
  std::array<double, PredictedManifold::kMaxPoints> separations{};  // m, along the normal, < 0: overlap
  std::array<double, PredictedManifold::kMaxPoints> forces{};       // N, along the normal, at each point
  Vec3 frictionForce = Vec3::Zero();                                // N, world, on B at the middle of the points
  double twist = 0;                                                 // N m, about the normal, on B
  double friction = 0;                                              // coefficient of now
};

/// A manifold among others: what it ties together.
struct ManifoldLink {
  std::int32_t manifold = -1;  // index
  int bodyA = kFixed, bodyB = kFixed;
  std::int32_t count = 0;  // of points
};

}  // namespace cradle
