#include "impact/block_filling.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <type_traits>

#include "impact/block_passes.h"
#include "impact/meeting_pairs.h"

namespace cradle {
namespace {

template <class Block>
class FilledBlock : public ::testing::Test {};

using BlockKinds = ::testing::Types<ContactBlock<1, true>, ContactBlock<3, true>, ContactBlock<4, false>>;
TYPED_TEST_SUITE(FilledBlock, BlockKinds);

// The rows of a block, times the motions of its bodies, are the velocities of points as kinematics has them.
TYPED_TEST(FilledBlock, HasTheSpeedsOfItsPoints) {
  MeetingPairs<TypeParam> pairs;
  pairs.fill();
  const auto& block = pairs.block;
  const auto& at = pairs.motions.velocities;
  const MotionsOf<TypeParam> movers(block, at);
  const PlaneSpeeds speeds = movers.apart(block);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int i = 0; i < TypeParam::kPoints; ++i) {
      const auto& point = block.points[i];
      const bool isAlone = TypeParam::kPoints == 1;  // in the middle
      const double speed = isAlone ? speeds.middle[lane] : speeds.at(point.u, point.v)[lane];
      EXPECT_NEAR(speed, -pairs.closingAt(lane, i, at), kAnchorRounding) << lane << ' ' << i;
    }
    for (int i = 0; i < 2; ++i) {
      const double slip = movers.along(block.friction.tangents[i], block.friction.turns[i])[lane];
      EXPECT_NEAR(slip, pairs.tangent(lane, i).dot(pairs.relativeAt(lane, pairs.middle(lane), at)), kAnchorRounding);
    }
  }
}

// The masses are what Newton's and Euler's laws give: impulses at a point, or in the middle along the tangents, or
// about the normal, times the change of speed that they make.
TYPED_TEST(FilledBlock, HasTheMassesOfItsRows) {
  MeetingPairs<TypeParam> pairs;
  pairs.fill();
  const auto& block = pairs.block;
  const std::vector<BodyMotion> rest(pairs.bodies.size());
  for (int lane = 0; lane < kLanes; ++lane) {
    const Vec3 normal = pairs.manifold(lane).normal, middle = pairs.middle(lane);
    for (int i = 0; i < TypeParam::kPoints; ++i) {
      auto pushed = rest;
      pairs.pushBoth(lane, pairs.points[lane][static_cast<std::size_t>(i)], normal, Vec3::Zero(), pushed);
      EXPECT_NEAR(block.points[i].mass[lane] * -pairs.closingAt(lane, i, pushed), 1, kAnchorRounding);
      if constexpr (TypeParam::kPoints > 1) {
        const auto& m = block.plane.inertia;
        Mat3 inertia;
        inertia << m.xx[lane], m.xy[lane], m.xz[lane], m.xy[lane], m.yy[lane], m.yz[lane], m.xz[lane], m.yz[lane],
            m.zz[lane];
        const auto opening = [&](const Vec3& place) { return normal.dot(pairs.relativeAt(lane, place, pushed)); };
        const double inMiddle = opening(middle);
        const Vec3 change(inMiddle, opening(middle + pairs.tangent(lane, 0)) - inMiddle,
                          opening(middle + pairs.tangent(lane, 1)) - inMiddle);
        const Vec3 arm = pairs.points[lane][static_cast<std::size_t>(i)] - middle;
        const Vec3 expected(1, arm.dot(pairs.tangent(lane, 0)), arm.dot(pairs.tangent(lane, 1)));
        EXPECT_LT((inertia * change - expected).norm(), kAnchorRounding) << lane << ' ' << i;
        EXPECT_NEAR(block.twist.levers[i][lane], arm.norm(), kAnchorRounding);
      }
    }
    const auto& friction = block.friction;
    for (int i = 0; i < 2; ++i) {
      auto pushed = rest;
      pairs.pushBoth(lane, middle, pairs.tangent(lane, i), Vec3::Zero(), pushed);
      const Vec3 change = pairs.relativeAt(lane, middle, pushed);
      const double slip0 = pairs.tangent(lane, 0).dot(change), slip1 = pairs.tangent(lane, 1).dot(change);
      EXPECT_NEAR(friction.mass11[lane] * slip0 + friction.mass12[lane] * slip1, i == 0, kAnchorRounding);
      EXPECT_NEAR(friction.mass12[lane] * slip0 + friction.mass22[lane] * slip1, i == 1, kAnchorRounding);
    }
    if constexpr (TypeParam::kPoints > 1) {
      auto turned = rest;
      pairs.pushBoth(lane, middle, Vec3::Zero(), normal, turned);
      const double turning = MotionsOf<TypeParam>(block, turned).twist(block.twist.turns)[lane];
      EXPECT_NEAR(block.twist.mass[lane] * turning, 1, 1e-13);
    }
  }
}

// Forces are in the block as a sub-step's impulses, and come back as they were, to rounding; friction without the part
// that is not in the contact plane. A lane that stands for nothing gives nothing back.
TYPED_TEST(FilledBlock, KeepsForces) {
  MeetingPairs<TypeParam> pairs;
  for (int lane = 0; lane < kLanes; ++lane) {
    PersistentManifold& manifold = pairs.manifolds[static_cast<std::size_t>(lane)];
    manifold.forces = {3, 4, 5, 6}, manifold.twist = -0.7 - lane, manifold.separations = {-0.1, 0.2, 0.3, 0.4};
    manifold.frictionForce = 2 * pairs.tangent(lane, 0) - 3 * pairs.tangent(lane, 1);
  }
  pairs.fill();
  auto& block = pairs.block;
  const std::vector<PersistentManifold> before = pairs.manifolds;
  for (int i = 0; i < TypeParam::kPoints; ++i) {
    EXPECT_EQ(block.points[i].impulse[1], (3 + i) * pairs.kSubStep);
    EXPECT_EQ(block.points[i].separation[1], before[1].separations[static_cast<std::size_t>(i)]);
    EXPECT_EQ(block.points[i].total[1], 0);
  }
  EXPECT_EQ(block.friction.coefficient[0], 0.5);
  EXPECT_EQ(block.restitution[0], 0.4);
  for (PersistentManifold& manifold : pairs.manifolds)
    manifold.forces.fill(0), manifold.twist = 0, manifold.frictionForce.setZero();
  emptyLane(static_cast<std::int32_t>(pairs.bodies.size()), 0, block);
  storeForces(block, pairs.kSubStep, pairs.manifolds);
  EXPECT_EQ(pairs.manifolds[0].forces[0], 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(TypeParam::kPoints); ++i)
    EXPECT_NEAR(pairs.manifolds[1].forces[i], before[1].forces[i], 1e-14);
  EXPECT_LT((pairs.manifolds[1].frictionForce - before[1].frictionForce).norm(), 1e-14);
  EXPECT_NEAR(pairs.manifolds[1].twist, TypeParam::kPoints > 1 ? -1.7 : 0, 1e-15);
}

}  // namespace
}  // namespace cradle
