#include <gtest/gtest.h>

#include <cmath>

#include "constraints/invariants.h"
#include "impact/contact_impulse.h"
#include "impact/pairwise.h"
#include "impact/row_of_balls.h"
#include "math/rotation.h"

namespace cradle {
namespace {

// Momentum and Newton's law of restitution: v1' = v1 - (1 + e) m2 / (m1 + m2) (v1 - v2), and the mirror of it.
TEST(PairImpact, MatchesTheClosedFormForAnyMassesAndRestitution) {
  for (const double m1 : {0.5, 1.0, 700.0})
    for (const double m2 : {0.03, 1.0, 20.0})
      for (const double e : {0.0, 0.37, 1.0}) {
        RowOfBalls row({m1, m2}, e);
        linearVelocity(row.state, 0).x() = 3;
        linearVelocity(row.state, 1).x() = -1.5;
        resolvePairwise(row.impacts, row.bodies, row.state);
        const double exchange = (1 + e) * 4.5 / (m1 + m2);
        // Velocities up to 10 m/s after a handful of operations on them.
        EXPECT_NEAR(row.speed(0), 3 - exchange * m2, 1e-14) << m1 << ' ' << m2 << ' ' << e;
        EXPECT_NEAR(row.speed(1), -1.5 + exchange * m1, 1e-14) << m1 << ' ' << m2 << ' ' << e;
        EXPECT_NEAR(row.impacts[0].impulse.x(), exchange * m1 * m2, 1e-13 * m1 * m2 * exchange);
      }
}

TEST(PairImpact, WithSomethingFixedReflectsExactly) {
  for (const double e : {0.0, 0.5, 1.0}) {
    RowOfBalls row({2.0}, e);
    const Contact wall{0, 0, kFixed, Vec3(0.1, 0, 0), Vec3::UnitX(), 0};
    row.impacts = {{wall, {e, 0, 0}, 0, Vec3::Zero()}};
    linearVelocity(row.state, 0) = Vec3(3, 1, 0);
    resolvePairwise(row.impacts, row.bodies, row.state);
    EXPECT_NEAR(row.speed(0), -3 * e, 1e-15);
    EXPECT_EQ(linearVelocity(row.state, 0).y(), 1);
  }
}

TEST(PairImpact, OfSeparatingBodiesDoesNothing) {
  RowOfBalls row({1, 1}, 1);
  linearVelocity(row.state, 0).x() = -1;
  const VectorX before = row.state;
  resolvePairwise(row.impacts, row.bodies, row.state);
  EXPECT_EQ(row.state, before);
}

TEST(PairImpact, SlowerThanTheRestSpeedDoesNotRebound) {
  RowOfBalls row({1, 1}, 1);
  row.impacts[0].restSpeed = 0.01;
  linearVelocity(row.state, 0).x() = 0.009;
  resolvePairwise(row.impacts, row.bodies, row.state);
  EXPECT_NEAR(row.speed(0), 0.0045, 1e-17);
  EXPECT_NEAR(row.speed(1), 0.0045, 1e-17);
}

TEST(PairwiseImpacts, PassOneBallsMotionThroughARowOfEqualBalls) {
  RowOfBalls row({1, 1, 1, 1, 1}, 1);
  linearVelocity(row.state, 0).x() = 1;
  resolvePairwise(row.impacts, row.bodies, row.state);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(row.speed(i), 0, 1e-15) << i;
  EXPECT_NEAR(row.speed(4), 1, 1e-15);
}

// The inertia of a lopsided body hitting a fixed plane at a point off its centre, worked out in the body's frame and by
// components instead of matrices: for a frictionless impulse j n the centre gains j n / m and the body-frame spin
// I^-1 (r x j n); j from the point's normal velocity reversed by e.
TEST(PairImpact, OfALopsidedBodyMatchesAnIndependentComputation) {
  const Quat turn = rotationAbout(Vec3(1, 2, -1), 0.9);
  const RigidBody body = makeRigidBody({1.3, Vec3::Zero(), Vec3(0.02, 0.05, 0.06).asDiagonal()});
  VectorX state = statesAtRest(1);
  setOrientation(state, 0, turn);
  linearVelocity(state, 0) = Vec3(0.3, -2, 0.1);
  angularVelocity(state, 0) = Vec3(1, -2, 0.5);
  const Vec3 arm(0.2, -0.3, 0.1), up = Vec3::UnitY();
  const double e = 0.6;
  std::vector<ImpactContact> impacts{{{0, 0, kFixed, arm, -up, 0}, {e, 0, 0}, 0, Vec3::Zero()}};

  const Vec3 spinBody = turn.conjugate() * (arm.cross(up)), perUnit = spinBody.cwiseQuotient(Vec3(0.02, 0.05, 0.06));
  const double response = 1 / 1.3 + perUnit.dot(spinBody);
  const Vec3 pointVelocity = Vec3(0.3, -2, 0.1) + Vec3(1, -2, 0.5).cross(arm);
  const double impulse = -(1 + e) * pointVelocity.y() / response;
  ASSERT_GT(impulse, 0);

  resolvePairwise(impacts, std::vector{body}, state);
  EXPECT_NEAR(-impacts[0].impulse.y(), impulse, 1e-13);
  EXPECT_LT((linearVelocity(state, 0) - Vec3(0.3, -2 + impulse / 1.3, 0.1)).norm(), 1e-13);
  EXPECT_LT((angularVelocity(state, 0) - (Vec3(1, -2, 0.5) + turn * (impulse * perUnit))).norm(), 1e-12);
}

// A solid ball thrown on a floor: friction that holds leaves it rolling: v' = (5 v + 2 R w) / 7 (angular momentum about
// the point of contact is kept); friction that slides takes mu (1 + e) vn from v.
TEST(PairImpact, FrictionMakesABallRollOrSlide) {
  const double radius = 0.1, v = 2, down = 1, e = 0.5;
  const Contact floor{0, 0, kFixed, Vec3(0, -radius, 0), -Vec3::UnitY(), 0};
  const auto thrown = [&](double friction) {
    VectorX state = statesAtRest(1);
    linearVelocity(state, 0) = Vec3(v, -down, 0);
    std::vector<ImpactContact> impacts{{floor, {e, friction, friction}, 0, Vec3::Zero()}};
    resolvePairwise(impacts, std::vector{ball(1.7)}, state);
    return state;
  };
  const VectorX rolls = thrown(1.0), slides = thrown(0.1);
  EXPECT_NEAR(linearVelocity(rolls, 0).x(), 5 * v / 7, 1e-14);
  EXPECT_NEAR(angularVelocity(rolls, 0).z(), -5 * v / 7 / radius, 1e-12);
  EXPECT_NEAR(linearVelocity(slides, 0).x(), v - 0.1 * (1 + e) * down, 1e-14);
  EXPECT_NEAR(linearVelocity(slides, 0).y(), e * down, 1e-14);
}

// Many random impacts of lopsided bodies, with friction: momentum and angular momentum are kept to rounding, energy
// never grows.
TEST(PairImpact, KeepsMomentaAndNeverAddsEnergy) {
  Mechanism mechanism;
  mechanism.bodies = {makeRigidBody({1.3, Vec3::Zero(), Vec3(0.02, 0.05, 0.06).asDiagonal()}),
                      makeRigidBody({0.4, Vec3::Zero(), Vec3(0.03, 0.01, 0.035).asDiagonal()})};
  std::srand(7);
  for (int trial = 0; trial < 1000; ++trial) {
    VectorX state = VectorX::Random(stateSize(2));
    state.tail<kLedgerSize>().setZero();
    normalizeOrientations(state);
    const Vec3 normal = Vec3::Random().normalized(), point = Vec3::Random();
    const double friction = 1.5 * std::abs(normal.x()), e = std::abs(normal.y());
    std::vector<ImpactContact> impacts{{{0, 0, 1, point, normal, 0}, {e, friction, friction}, 0, Vec3::Zero()}};
    const Invariants before = invariantsOf(mechanism, state);
    resolvePairwise(impacts, mechanism.bodies, state);
    const Invariants after = invariantsOf(mechanism, state);
    EXPECT_LT((after.momentum - before.momentum).norm(), 1e-14);
    EXPECT_LT((after.angularMomentum - before.angularMomentum).norm(), 1e-13);
    EXPECT_LE(after.kinetic, before.kinetic * (1 + 1e-12));
  }
}

}  // namespace
}  // namespace cradle
