#pragma once

#include "impact/block_filling.h"
#include "impact/solver_bodies.h"

namespace cradle {

/// Two pairs of lopsided bodies, or two bodies on something fixed, that touch at points of a plane: one pair in each
/// lane of a block.
template <class Block>
struct MeetingPairs : SolverBodies {
  static constexpr double kSubStep = 1.0 / 480;  // s
  ContactMaterial material{0.4, 0.6, 0.5};
  std::vector<PersistentManifold> manifolds;
  std::vector<Vec3> points[kLanes];  // m, world
  SolverMotions motions;
  Block block{};

  MeetingPairs() {
    const Mat3 turn = rotationAbout(Vec3(3, -1, 2), 1.1).toRotationMatrix();
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3 normal = Vec3(0.1, 1, 0.05 + lane).normalized(), along = normal.unitOrthogonal(),
                 across = normal.cross(along), middle(0.2, 0.1, -0.3);
      const int a = add(2 + lane, lopsidedInertia(), middle - Vec3(0.1, 0.3, 0.05), turn);
      const int b = add(3, 2 * lopsidedInertia(), middle + Vec3(0.02, 0.25, 0.1), turn * turn);
      const double places[][2] = {{0.1, 0.2}, {-0.15, 0.12}, {-0.08, -0.17}, {0.2, -0.1}};
      for (int i = 0; i < Block::kPoints; ++i)
        points[lane].emplace_back(middle + places[i][0] * along + places[i][1] * across);
      manifolds.push_back(manifoldOf(a, Block::kBothMove ? b : kFixed, normal, points[lane]));
      manifolds.back().material = &material, manifolds.back().friction = material.dynamicFriction;
    }
    motions.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const double k = static_cast<double>(i);
      motions.velocities[i] = motionOf(i, Vec3(0.3, 1 - 2 * (i % 2 ? 1.0 : 0.0), 0.2 * k), Vec3(0.5 - k, 0.7, 1));
      motions.starts[i] = motions.velocities[i];
    }
  }
  void fill() {
    const auto still = static_cast<std::int32_t>(bodies.size());
    for (int lane = 0; lane < kLanes; ++lane) emptyLane(still, lane, block);
    for (int lane = 0; lane < kLanes; ++lane)
      fillLane(manifolds[static_cast<std::size_t>(lane)], lane, bodies, kSubStep, lane, block);
  }
  const PersistentManifold& manifold(int lane) const { return manifolds[static_cast<std::size_t>(lane)]; }
  Vec3 middle(int lane) const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : points[lane]) sum += point;
    return sum / Block::kPoints;
  }
  Vec3 tangent(int lane, int i) const {
    const Vec3 first = manifold(lane).normal.unitOrthogonal();
    return i == 0 ? first : manifold(lane).normal.cross(first);
  }
  /// The velocity (m/s) at a point of B relative to A.
  Vec3 relativeAt(int lane, const Vec3& point, const std::vector<BodyMotion>& at) const {
    return pointVelocity(at, manifold(lane).bodyB, point) - pointVelocity(at, manifold(lane).bodyA, point);
  }
  double closingAt(int lane, int i, const std::vector<BodyMotion>& at) const {
    return -manifold(lane).normal.dot(relativeAt(lane, points[lane][static_cast<std::size_t>(i)], at));
  }
  /// An impulse on B at a point, and an angular one, and their opposites on A.
  void pushBoth(int lane, const Vec3& point, const Vec3& impulse, const Vec3& angular,
                std::vector<BodyMotion>& at) const {
    push(manifold(lane).bodyB, point, impulse, angular, at);
    push(manifold(lane).bodyA, point, -impulse, -angular, at);
  }
  /// The largest difference of the bodies' motions.
  double difference(const std::vector<BodyMotion>& one, const std::vector<BodyMotion>& other) const {
    double largest = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const BodyMotion change = one[i] - other[i];
      for (const Lanes& lanes : {change.xy, change.zu, change.vw})
        largest = std::max({largest, std::abs(lanes[0]), std::abs(lanes[1])});
    }
    return largest;
  }
};

/// Anchors are off by 6e-8 of their 0.5 m, speeds by as much of some rad/s, impulses of some N s of inverse masses up
/// to a hundred times one: errors of the order of 1e-6.
constexpr double kAnchorRounding = 3e-6;

}  // namespace cradle
