#include "impact/block_passes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "impact/meeting_pairs.h"

namespace cradle {
namespace {

using OnePoint = ContactBlock<1, true>;
using ThreePoints = ContactBlock<3, true>;
using ThreeOnFixed = ContactBlock<3, false>;

constexpr double kSlowest = 0.01;  // m/s

/// What Newton's and Euler's laws make of velocities by all impulses of a block.
template <class Block>
void pushByAll(const MeetingPairs<Block>& pairs, std::vector<BodyMotion>& at) {
  const Block& block = pairs.block;
  for (int lane = 0; lane < kLanes; ++lane) {
    const Vec3 normal = pairs.manifold(lane).normal;
    for (int i = 0; i < Block::kPoints; ++i)
      pairs.pushBoth(lane, pairs.points[lane][static_cast<std::size_t>(i)], block.points[i].impulse[lane] * normal,
                     Vec3::Zero(), at);
    for (int i = 0; i < 2; ++i)
      pairs.pushBoth(lane, pairs.middle(lane), block.friction.impulses[i][lane] * pairs.tangent(lane, i), Vec3::Zero(),
                     at);
    const double twist = Block::kPoints > 1 ? block.twist.impulse[lane] : 0;
    pairs.pushBoth(lane, pairs.middle(lane), Vec3::Zero(), twist * normal, at);
  }
}

template <class Block>
void expectWarmStart() {
  MeetingPairs<Block> pairs;
  for (PersistentManifold& manifold : pairs.manifolds) {
    manifold.forces = {300, 500, 200, 0}, manifold.twist = 20;
    manifold.frictionForce = 100 * manifold.normal.unitOrthogonal() - 50 * manifold.normal.cross(Vec3::UnitX());
  }
  pairs.fill();
  auto expected = pairs.motions.velocities;
  pushByAll(pairs, expected);
  warmBlock(pairs.block, pairs.motions);
  EXPECT_LT(pairs.difference(pairs.motions.velocities, expected), kAnchorRounding);
  EXPECT_GT(pairs.difference(pairs.motions.velocities, pairs.motions.starts), 0.1);
}

TEST(BlockPasses, WarmStartGivesBodiesTheImpulsesOfTheStepBefore) {
  expectWarmStart<OnePoint>();
  expectWarmStart<ThreePoints>();
  expectWarmStart<ThreeOnFixed>();
}

// What closes is stopped, or left its slack, and both bodies get what the block's impulses give them.
TEST(BlockPasses, RelaxingStopsOnePointButForItsSlack) {
  MeetingPairs<OnePoint> pairs;
  for (PersistentManifold& manifold : pairs.manifolds) manifold.friction = 0;
  pairs.fill();
  pairs.block.points[0].slack = Lanes{0, 0.3};
  auto expected = pairs.motions.velocities;
  ASSERT_GT(pairs.closingAt(0, 0, expected), 1);
  relaxBlock(pairs.block, pairs.motions);
  EXPECT_NEAR(pairs.closingAt(0, 0, pairs.motions.velocities), 0, kAnchorRounding);
  EXPECT_NEAR(pairs.closingAt(1, 0, pairs.motions.velocities), 0.3, kAnchorRounding);
  pushByAll(pairs, expected);
  EXPECT_LT(pairs.difference(pairs.motions.velocities, expected), kAnchorRounding);
  EXPECT_EQ(pairs.block.points[0].total[0], pairs.block.points[0].impulse[0]);
}

// Points of three are rigid as ten of their masses: impulse = max(0, before - 10 m (s + slack)), s the speed after the
// normal impulses. Friction comes after them; without it that is the speed at the end.
TEST(BlockPasses, RelaxingObeysTheLawsOfThreePoints) {
  MeetingPairs<ThreePoints> pairs;
  for (PersistentManifold& manifold : pairs.manifolds) manifold.friction = 0, manifold.forces.fill(100);
  pairs.fill();
  for (auto& point : pairs.block.points) point.slack = same(0.05);
  const double before = 100 * pairs.kSubStep;
  relaxBlock(pairs.block, pairs.motions);
  int pressed = 0;
  for (int lane = 0; lane < kLanes; ++lane)
    for (int i = 0; i < 3; ++i) {
      const auto& point = pairs.block.points[i];
      const double speed = -pairs.closingAt(lane, i, pairs.motions.velocities), mass = point.mass[lane];
      const double asked = before - 10 * mass * (speed + 0.05);
      EXPECT_NEAR(point.impulse[lane], std::max(0.0, asked), 30 * mass * kAnchorRounding) << lane << ' ' << i;
      pressed += point.impulse[lane] > 0;
    }
  EXPECT_GT(pressed, 2);
}

// Coulomb's law for spheres, whose tangential mass is 2/7 of theirs: friction ends the slip s of the surface if that
// takes no more than mu times the normal impulse, else it is mu times that, against the slip.
TEST(BlockPasses, FrictionSticksOrSlidesAsCoulombSays) {
  using OnFixed = ContactBlock<1, false>;
  const double mass = 2, radius = 0.25, mu = 0.5, fall = 3;
  SolverBodies spheres;
  std::vector<PersistentManifold> manifolds;
  SolverMotions motions;
  motions.resize(2);
  OnFixed block{};
  const Vec3 slips[] = {Vec3(1.2, 0, -1.6), Vec3(9, 0, 12)};
  for (std::size_t lane = 0; lane < 2; ++lane) {
    spheres.add(mass, 0.4 * mass * radius * radius * Mat3::Identity(), Vec3(0, radius, 0));
    manifolds.push_back(spheres.manifoldOf(static_cast<int>(lane), kFixed, -Vec3::UnitY(), {Vec3::Zero()}));
    static const ContactMaterial material{0, 0, 0};
    manifolds[lane].material = &material, manifolds[lane].friction = mu;
    motions.velocities[lane] = spheres.motionOf(lane, slips[lane] - fall * Vec3::UnitY(), Vec3::Zero());
    fillLane(manifolds[lane], static_cast<std::int32_t>(lane), spheres.bodies, 1, static_cast<int>(lane), block);
  }
  relaxBlock(block, motions);
  for (std::size_t lane = 0; lane < 2; ++lane) {
    const Vec3 slip = slips[lane],
               expected = lane == 0 ? Vec3(-mass * 2 / 7 * slip) : Vec3(-mu * fall * mass * slip / 15);
    const Vec3 velocity = slip + expected / mass;
    EXPECT_LT((SolverBodies::linearOf(motions.velocities[lane]) - velocity).norm(), 1e-14) << lane;
    const Vec3 surface = spheres.pointVelocity(motions.velocities, static_cast<int>(lane), Vec3::Zero());
    EXPECT_LT((surface - slip - 3.5 * expected / mass).norm(), 1e-14) << lane;
  }
}

// Friction that is strong enough ends the slip of lopsided bodies, whose tangential directions are coupled.
TEST(BlockPasses, FrictionEndsTheSlipOfLopsidedBodies) {
  MeetingPairs<OnePoint> pairs;
  for (PersistentManifold& manifold : pairs.manifolds) manifold.friction = 100;
  pairs.fill();
  relaxBlock(pairs.block, pairs.motions);
  for (int lane = 0; lane < kLanes; ++lane)
    for (int i = 0; i < 2; ++i) {
      const Vec3 slip = pairs.relativeAt(lane, pairs.middle(lane), pairs.motions.velocities);
      EXPECT_NEAR(slip.dot(pairs.tangent(lane, i)), 0, kAnchorRounding);
    }
}

// A block with friction at three points: neither its force in the middle nor its torque is beyond mu times the normal
// impulses, and these times their arms, which it reaches where it is weak; and it takes energy.
TEST(BlockPasses, FrictionOfThreePointsStaysWithinItsLimits) {
  for (const double mu : {0.5, 0.02}) {
    MeetingPairs<ThreeOnFixed> pairs;
    for (PersistentManifold& manifold : pairs.manifolds) manifold.friction = mu;
    pairs.fill();
    auto expected = pairs.motions.velocities;
    const double energy = pairs.energyOf(expected);
    relaxBlock(pairs.block, pairs.motions);
    pushByAll(pairs, expected);
    EXPECT_LT(pairs.difference(pairs.motions.velocities, expected), kAnchorRounding);
    EXPECT_LT(pairs.energyOf(pairs.motions.velocities), energy);
    for (int lane = 0; lane < kLanes; ++lane) {
      double sum = 0, moment = 0;
      for (int i = 0; i < 3; ++i) {
        const double impulse = pairs.block.points[i].impulse[lane];
        sum += impulse;
        moment += impulse * (pairs.points[lane][static_cast<std::size_t>(i)] - pairs.middle(lane)).norm();
      }
      const auto& friction = pairs.block.friction;
      const double force = std::hypot(friction.impulses[0][lane], friction.impulses[1][lane]);
      const double torque = std::abs(pairs.block.twist.impulse[lane]);
      EXPECT_GT(sum, 0);
      EXPECT_LE(force, mu * sum * (1 + 1e-6));
      EXPECT_LE(torque, mu * moment * (1 + 1e-6));
      if (mu < 0.1) {
        EXPECT_NEAR(force, mu * sum, 1e-6 * sum);
        EXPECT_NEAR(torque, mu * moment, 1e-6 * moment);
      }
      EXPECT_EQ(friction.totals[0][lane], friction.impulses[0][lane]);
      EXPECT_EQ(pairs.block.twist.total[lane], pairs.block.twist.impulse[lane]);
    }
  }
}

// What is apart may close within the sub-step; an overlap d yields as a damped spring, implicit in the sub-step: with
// the frequency w, damping c and mass m, impulse = m (w^2 d h - (w^2 h^2 + c w h) s) for the speed s afterwards, though
// the block began with an impulse.
TEST(BlockPasses, SoftContactsCloseGapsAndPushOverlapsApart) {
  const double subStep = MeetingPairs<OnePoint>::kSubStep, turn = 0.8, damping = 4, overlap = 2e-3, gap = 4e-3;
  MeetingPairs<OnePoint> pairs;
  for (PersistentManifold& manifold : pairs.manifolds) manifold.friction = 0;
  pairs.manifolds[0].separations[0] = -overlap, pairs.manifolds[0].forces[0] = 200;
  pairs.manifolds[1].separations[0] = gap / 2;
  for (std::size_t body = 2; body < 4; ++body)  // the other half of the gap has opened since the step began
    pairs.motions.displacements[body] =
        pairs.motionOf(body, (body == 2 ? -1 : 1) * gap / 4 * pairs.manifolds[1].normal, Vec3::Zero());
  pairs.fill();
  softenBlock(pairs.block, {turn, damping, 0, 1e9}, subStep, pairs.motions);
  const double speed = -pairs.closingAt(0, 0, pairs.motions.velocities), mass = pairs.block.points[0].mass[0];
  const double expected = mass * (turn * turn * overlap / subStep - turn * (turn + damping) * speed);
  EXPECT_NEAR(pairs.block.points[0].impulse[0], expected, 10 * mass * kAnchorRounding);
  const double closing = pairs.closingAt(1, 0, pairs.motions.velocities);
  EXPECT_NEAR(closing, std::min(gap / subStep, pairs.closingAt(1, 0, pairs.motions.starts)), kAnchorRounding);
  const double left = pairs.block.points[0].impulse[1] > 0 ? 0 : gap / subStep - closing;
  EXPECT_NEAR(pairs.block.points[0].slack[1], left, kAnchorRounding);
}

// Newton's law of restitution for what was pressed and closed faster than the slowest rebound. The other lane closes
// more slowly than that.
TEST(BlockPasses, ReboundHasTheSpeedOfItsRestitution) {
  MeetingPairs<OnePoint> pairs;
  for (PersistentManifold& manifold : pairs.manifolds) manifold.friction = 0;
  pairs.fill();
  const double fast = pairs.closingAt(0, 0, pairs.motions.starts), slow = pairs.closingAt(1, 0, pairs.motions.starts);
  ASSERT_GT(fast, slow + 0.1);
  for (const double slowest : {(fast + slow) / 2, fast + 1}) {
    pairs.motions.velocities = pairs.motions.starts;
    pairs.fill();
    relaxBlock(pairs.block, pairs.motions);
    reboundBlock(pairs.block, slowest, pairs.motions);
    const double rebound = slowest < fast ? 0.4 * fast : 0;
    EXPECT_NEAR(pairs.closingAt(0, 0, pairs.motions.velocities), -rebound, kAnchorRounding);
    EXPECT_NEAR(pairs.closingAt(1, 0, pairs.motions.velocities), 0, kAnchorRounding);
    EXPECT_EQ(pairs.block.points[0].total[0], pairs.block.points[0].impulse[0]);
  }
  // Nothing has pressed: they passed each other.
  pairs.motions.velocities = pairs.motions.starts;
  pairs.fill();
  reboundBlock(pairs.block, kSlowest, pairs.motions);
  EXPECT_EQ(pairs.difference(pairs.motions.velocities, pairs.motions.starts), 0);
}

// What impulses took is what is missing of the energy: as an impact where bodies met faster than the slowest rebound,
// else the part of friction is told apart.
TEST(BlockPasses, WeighedImpulsesTookWhatIsMissingOfTheEnergy) {
  for (const double slowest : {kSlowest, 100.0}) {
    MeetingPairs<ThreePoints> pairs;
    pairs.fill();
    relaxBlock(pairs.block, pairs.motions);
    reboundBlock(pairs.block, slowest, pairs.motions);
    weighBlock(pairs.block, slowest, pairs.motions);
    const auto& block = pairs.block;
    const double missing = pairs.energyOf(pairs.motions.starts) - pairs.energyOf(pairs.motions.velocities);
    ASSERT_GT(missing, 1);
    EXPECT_NEAR(block.struck[0] + block.struck[1] + block.rubbed[0] + block.rubbed[1], missing, 1e-13 * missing);
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto workOf = [&](const std::vector<BodyMotion>& at) {  // twice that of friction, at these velocities
        const Vec3 slip = pairs.relativeAt(lane, pairs.middle(lane), at);
        const std::size_t a = static_cast<std::size_t>(pairs.manifold(lane).bodyA), b = a + 1;
        const Vec3 spin = pairs.angularOf(at[b], b) - pairs.angularOf(at[a], a);
        const double twist = block.twist.impulse[lane] * pairs.manifold(lane).normal.dot(spin);
        return block.friction.impulses[0][lane] * slip.dot(pairs.tangent(lane, 0)) +
               block.friction.impulses[1][lane] * slip.dot(pairs.tangent(lane, 1)) + twist;
      };
      const double rubbed = -0.5 * (workOf(pairs.motions.starts) + workOf(pairs.motions.velocities));
      EXPECT_GT(std::abs(rubbed), 0.01);
      EXPECT_NEAR(block.rubbed[lane], slowest == kSlowest ? 0 : rubbed, kAnchorRounding);
    }
  }
}

}  // namespace
}  // namespace cradle
