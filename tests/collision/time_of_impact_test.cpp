#include <gtest/gtest.h>

#include <cmath>

#include "collision/time_of_impact.h"
#include "constraints/equations_of_motion.h"
#include "dynamics/integrators/rk4.h"

namespace cradle {
namespace {

constexpr double kTouchTolerance = 1e-12;  // m

/// One RK4 step of free bodies under gravity: exact for balls without spin.
Step stepOf(Mechanism mechanism, const VectorX& start, double timeStep) {
  EquationsOfMotion equations(mechanism);
  const RightHandSide rightHandSide = equations.rightHandSide();
  Step step;
  rk4(rightHandSide, start, 0, timeStep, step);
  prepareInterpolant(rightHandSide, step);
  return step;
}

Mechanism balls(int count) {
  Mechanism mechanism;
  mechanism.gravity = Vec3(0, -9.81, 0);
  for (int i = 0; i < count; ++i)
    mechanism.bodies.push_back(makeRigidBody({1, Vec3::Zero(), 0.004 * Mat3::Identity()}));
  return mechanism;
}

VectorX stateOf(const std::vector<std::pair<Vec3, Vec3>>& positionsAndVelocities) {
  VectorX state = VectorX::Zero(stateSize(std::ssize(positionsAndVelocities)));
  for (Eigen::Index i = 0; i < bodyCount(state); ++i) {
    setOrientation(state, i, Quat::Identity());
    centerOfMass(state, i) = positionsAndVelocities[static_cast<std::size_t>(i)].first;
    linearVelocity(state, i) = positionsAndVelocities[static_cast<std::size_t>(i)].second;
  }
  return state;
}

ContactGeometry floorAndBall(double radius) {
  ContactGeometry geometry;
  geometry.colliders = {{0, {Vec3::Zero()}, radius, radius, {}}};
  geometry.planes = {{Vec3::Zero(), Vec3::UnitY()}};
  geometry.pairs = {{0, 0, true, {}}};
  return geometry;
}

ContactGeometry twoBalls(double radius) {
  ContactGeometry geometry;
  geometry.colliders = {{0, {Vec3::Zero()}, radius, radius, {}}, {1, {Vec3::Zero()}, radius, radius, {}}};
  geometry.pairs = {{0, 1, false, {}}};
  return geometry;
}

// A ball falls 1 m: t = sqrt(2 h / g). The fraction is found to 1e-12.
TEST(TimeOfImpact, OfAFallingBallIsTheClosedForm) {
  const Step step = stepOf(balls(1), stateOf({{Vec3(0, 1.1, 0), Vec3::Zero()}}), 1);
  const auto impact = ImpactSearch(floorAndBall(0.1)).first(step, {kTouchTolerance});
  ASSERT_TRUE(impact);
  EXPECT_NEAR(impact->fraction, std::sqrt(2 / 9.81), 2e-12);
}

TEST(TimeOfImpact, IsNoneForABallThatTurnsBackBeforeTheFloor) {
  // Thrown down from 1.1 m it would reach the floor; thrown up within the step it does not.
  const Step step = stepOf(balls(1), stateOf({{Vec3(0, 1.1, 0), Vec3(0, 4, 0)}}), 0.8);
  EXPECT_FALSE(ImpactSearch(floorAndBall(0.1)).first(step, {kTouchTolerance}));
}

TEST(TimeOfImpact, IgnoresWhatTouchesAtTheStart) {
  const Step step = stepOf(balls(1), stateOf({{Vec3(0, 0.1, 0), Vec3(0, 1, 0)}}), 0.01);
  EXPECT_FALSE(ImpactSearch(floorAndBall(0.1)).first(step, {kTouchTolerance}));
}

// Two balls of radius 1 cm meet at 600 m/s within a step in which they pass each other by a metre.
TEST(TimeOfImpact, FastBallsDoNotPassThroughEachOther) {
  const Step step =
      stepOf(balls(2), stateOf({{Vec3(-0.5, 0, 0), Vec3(300, 0, 0)}, {Vec3(0.5, 0, 0), Vec3(-300, 0, 0)}}), 1.0 / 300);
  const auto impact = ImpactSearch(twoBalls(0.01)).first(step, {kTouchTolerance});
  ASSERT_TRUE(impact);
  EXPECT_NEAR(impact->fraction * step.timeStep, 0.98 / 600, 1e-14);
}

// Lines that pass at a distance of d: a hit for d < 2 r, a miss for d > 2 r. At 0.999 x 2 r the balls overlap for
// 0.09 r of way only.
TEST(TimeOfImpact, GlancingHitsAndMissesAreToldApart) {
  const double radius = 0.05;
  for (const double part : {0.9, 0.999, 1.001, 1.1}) {
    const double offset = part * 2 * radius;
    const Step step =
        stepOf(balls(2), stateOf({{Vec3(-0.5, offset, 0), Vec3(1, 0, 0)}, {Vec3(0.5, 0, 0), Vec3(-1, 0, 0)}}), 1);
    const auto impact = ImpactSearch(twoBalls(radius)).first(step, {kTouchTolerance});
    EXPECT_EQ(impact.has_value(), part < 1) << part;
    if (impact) {
      const double meeting = (1 - std::sqrt(4 * radius * radius - offset * offset)) / 2;
      EXPECT_NEAR(impact->fraction, meeting, 1e-10) << part;
    }
  }
}

// A ball that starts and ends its step at rest, but moves by 1 m in between (x = 3 s^2 - 2 s^3): slow ends do not hide
// the ball on its way. They meet where 3 s^2 - 2 s^3 = 0.4.
TEST(TimeOfImpact, CountsTheWayBetweenSlowEnds) {
  Step step;
  step.timeStep = 1;
  step.startState = stateOf({{Vec3::Zero(), Vec3::Zero()}, {Vec3(0.5, 0, 0), Vec3::Zero()}});
  step.state = stateOf({{Vec3(1, 0, 0), Vec3::Zero()}, {Vec3(0.5, 0, 0), Vec3::Zero()}});
  step.startDerivative = step.endDerivative = VectorX::Zero(step.state.size());
  step.hasEndDerivative = true;
  const auto impact = ImpactSearch(twoBalls(0.05)).first(step, {kTouchTolerance});
  ASSERT_TRUE(impact);
  const double s = impact->fraction;
  EXPECT_NEAR(3 * s * s - 2 * s * s * s, 0.4, 1e-11);
}

TEST(TimeOfImpact, TakesTheEarliestOfSeveralPairs) {
  ContactGeometry geometry = twoBalls(0.1);
  geometry.planes = {{Vec3::Zero(), Vec3::UnitY()}};
  geometry.pairs = {{0, 0, true, {}}, {1, 0, true, {}}, {0, 1, false, {}}};
  const Step step = stepOf(balls(2), stateOf({{Vec3(0, 1.1, 0), Vec3::Zero()}, {Vec3(2, 0.6, 0), Vec3::Zero()}}), 1);
  const auto impact = ImpactSearch(geometry).first(step, {kTouchTolerance});
  ASSERT_TRUE(impact);
  EXPECT_EQ(impact->pair, 1u);
  EXPECT_NEAR(impact->fraction, std::sqrt(2 * 0.5 / 9.81), 2e-12);
}

// A stick that only turns, tip at radius 0.5 above a floor 0.3 below its centre: the tip arrives at asin(0.6). The
// interpolant of the orientation has an error of order (w h)^4 / 384: 2e-5 rad here at most, so h w = 0.3.
TEST(TimeOfImpact, OfASpinningTipIsWhenItReachesTheFloor) {
  Mechanism mechanism;
  mechanism.bodies = {makeRigidBody({1, Vec3::Zero(), 0.1 * Mat3::Identity()})};
  ContactGeometry geometry;
  geometry.colliders = {{0, {Vec3(0.5, 0, 0), Vec3(-0.5, 0, 0)}, 0, 0.5, {}}};
  geometry.planes = {{Vec3(0, -0.3, 0), Vec3::UnitY()}};
  geometry.pairs = {{0, 0, true, {}}};
  VectorX state = stateOf({{Vec3::Zero(), Vec3::Zero()}});
  const double start = -0.5;  // rad: already on its way down
  setOrientation(state, 0, Quat(std::cos(start / 2), 0, 0, std::sin(start / 2)));
  angularVelocity(state, 0) = Vec3(0, 0, -3);
  const Step step = stepOf(mechanism, state, 0.1);
  const auto impact = ImpactSearch(geometry).first(step, {kTouchTolerance});
  ASSERT_TRUE(impact);
  EXPECT_EQ(impact->feature, 0u);
  EXPECT_NEAR(impact->fraction * 0.1, (std::asin(0.6) - 0.5) / 3, 2e-5 / 3);
}

}  // namespace
}  // namespace cradle
