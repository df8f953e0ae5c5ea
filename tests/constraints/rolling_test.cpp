// Balls that slide and roll on planes, turntables and each other, against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "constraints/contact_motion.h"
#include "constraints/invariants.h"

namespace cradle {
namespace {

TEST(Sphere, RollsDownASlopeAtFiveSeventhsOfGravity) {
  Mechanism mechanism = onEarth({solidSphere(0.7, 0.15)});
  mechanism.gravity = tiltedGravity();
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.15, {}, Vec3::UnitY(), kSticking)};
  VectorX state = restingState(1);
  centerOfMass(state, 0).y() = 0.15;
  const VectorX rate = rateOf(mechanism, state), end = integrated(mechanism, state, 1, 1e-10);
  const double expected = 5.0 / 7 * kGravity * std::sin(kSlope);
  EXPECT_LT((linearVelocity(rate, 0) - Vec3(expected, 0, 0)).norm(), kMotionRounding);
  EXPECT_LT((angularVelocity(rate, 0) - Vec3(0, 0, -expected / 0.15)).norm(), 10 * kMotionRounding);
  EXPECT_NEAR(centerOfMass(end, 0).x(), expected / 2, 1e-12);  // uniform acceleration: no error but rounding
  EXPECT_NEAR(centerOfMass(end, 0).y(), 0.15, 1e-13);
}

/// R8d, R8e: a sphere thrown along x with a spin, that slides until it rolls.
struct ThrownSphere {
  double radius = 0.1, friction = 0.3, speed = 5, spin;
  double timeOfRolling() const { return 2 * (speed - radius * spin) / (7 * friction * kGravity); }
};
TEST(Sphere, ThrownSlidesUntilItRolls) {
  for (const ThrownSphere& ball : {ThrownSphere{.spin = 0}, ThrownSphere{.spin = -30}}) {
    Mechanism mechanism = onEarth({solidSphere(1, ball.radius)});
    mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, ball.radius, {}, Vec3::UnitY(), kSliding, ball.friction)};
    VectorX state = restingState(1);
    centerOfMass(state, 0).y() = ball.radius;
    linearVelocity(state, 0).x() = ball.speed;
    angularVelocity(state, 0) = Vec3(0.4, 7, -ball.spin);  // and some spin that sliding along x does not touch
    angularVelocity(state, 0).x() = 0;
    const VectorX rate = rateOf(mechanism, state);
    EXPECT_NEAR(linearVelocity(rate, 0).x(), -0.3 * kGravity, kMotionRounding);
    EXPECT_NEAR(angularVelocity(rate, 0).z(), -2.5 * 0.3 * kGravity / 0.1, 10 * kMotionRounding);
    const VectorX end = integrated(mechanism, state, ball.timeOfRolling(), 1e-10);
    const double rolling = (5 * ball.speed + 2 * ball.radius * ball.spin) / 7;
    EXPECT_NEAR(linearVelocity(end, 0).x(), rolling, 1e-12);
    EXPECT_NEAR(angularVelocity(end, 0).z(), -rolling / ball.radius, 1e-11);
    EXPECT_LT(tangentialVelocity(placeIn(mechanism, 0, end)).norm(), 1e-12);
    EXPECT_NEAR(energyConstant(mechanism, end), energyConstant(mechanism, state), 1e-10);
  }
}

// Sliding across its spin, a ball runs along a parabola: the direction of slip stays, u' = -(7/2) mu g u / |u|.
TEST(Sphere, WithSideSpinRunsAlongAParabola) {
  Mechanism mechanism = onEarth({solidSphere(1.3, 0.1)});
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.1, {}, Vec3::UnitY(), kSliding, 0.2)};
  VectorX state = restingState(1);
  centerOfMass(state, 0).y() = 0.1;
  linearVelocity(state, 0) = Vec3(3, 0, 1);
  angularVelocity(state, 0) = Vec3(40, 5, 10);
  const Vec3 slip = tangentialVelocity(placeIn(mechanism, 0, state)), direction = slip.normalized();
  const double time = 0.9 * slip.norm() / (3.5 * 0.2 * kGravity);
  const VectorX end = integrated(mechanism, state, time, 1e-10);
  const Vec3 expected = Vec3(0, 0.1, 0) + Vec3(3, 0, 1) * time - 0.1 * kGravity * time * time * direction;
  EXPECT_LT((centerOfMass(end, 0) - expected).norm(), 1e-11);
  EXPECT_LT((tangentialVelocity(placeIn(mechanism, 0, end)) - 0.1 * slip).norm(), 1e-11);
}

// Rolling on a turntable a solid ball goes round at 2/7 of its angular velocity, wherever and however fast it starts
// (J. A. Burns, "Ball rolling on a turntable: analog for charged particle dynamics", Am. J. Physics 49, 1981).
TEST(Sphere, OnATurntableGoesRoundAtTwoSeventhsOfItsSpeed) {
  Mechanism mechanism = onEarth({solidSphere(1, 0.1), lopsided(1e9, Quat::Identity())});
  const double turning = 7;
  const Vec3 axis = Vec3::UnitY();
  mechanism.constraints = {
      {{1, Vec3::Zero()}, {kFixed, Vec3::Zero()}, HingeConstraint{axis, {Vec3::UnitZ(), Vec3::UnitX()}}}};
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.1, {1, Vec3(0.3, 0.05, 0.2)}, axis, kSticking)};
  VectorX state = restingState(2);
  centerOfMass(state, 0) = Vec3(0.4, 0.15, 0.1);
  linearVelocity(state, 0) = Vec3(0.2, 0, -0.3);
  angularVelocity(state, 1) = turning * axis;
  // v + w x (-r n) = W x (x - 0): w across n is n x (v - W x x) / r
  const Vec3 table = turning * axis.cross(Vec3(centerOfMass(state, 0)));
  angularVelocity(state, 0) = axis.cross(Vec3(linearVelocity(state, 0)) - table) / 0.1 + 2 * axis;
  ASSERT_LT(tangentialVelocity(placeIn(mechanism, 0, state)).norm(), 1e-15);
  const double period = 2 * std::numbers::pi / (2.0 / 7 * turning);
  const VectorX half = integrated(mechanism, state, period / 2, 1e-10);
  // Opposite on the circle about x + v x n / (2/7 W), after half a turn; the table gives by 1e-9 at most.
  const Vec3 center = Vec3(centerOfMass(state, 0)) - Vec3(linearVelocity(state, 0)).cross(axis) / (2.0 / 7 * turning);
  EXPECT_LT((centerOfMass(half, 0) + centerOfMass(state, 0) - 2 * center).norm(), 1e-8);
  EXPECT_LT((linearVelocity(half, 0) + linearVelocity(state, 0)).norm(), 1e-8);
  EXPECT_LT(std::abs(placeIn(mechanism, 0, half).gap), 1e-9);
}

// Rolling down a fixed sphere without slip: v^2 = 10/7 g (R + r)(cos a0 - cos a), N = m (g cos a - v^2 / (R + r)).
TEST(Sphere, RollsDownASphere) {
  const double mass = 0.6, radius = 0.1, ground = 0.5, reach = radius + ground, start = 0.3;
  Mechanism mechanism = onEarth({solidSphere(mass, radius)});
  const Vec3 bottom(0.2, -0.4, 0.1);
  mechanism.contacts = {sphereOnSphere({0, Vec3::Zero()}, radius, {kFixed, bottom}, ground, kSticking)};
  VectorX state = restingState(1);
  centerOfMass(state, 0) = bottom + reach * Vec3(std::sin(start), std::cos(start), 0);
  const VectorX startDerivative = rateOf(mechanism, state);
  EXPECT_NEAR(linearVelocity(startDerivative, 0).norm(), 5.0 / 7 * kGravity * std::sin(start), kMotionRounding);
  const VectorX end = integrated(mechanism, state, 0.6, 1e-10);
  const Vec3 place = centerOfMass(end, 0) - bottom;
  const double square = linearVelocity(end, 0).squaredNorm(), cosine = place.y() / reach;
  EXPECT_LT(cosine, 0.8);  // it has come far
  EXPECT_NEAR(square, 10.0 / 7 * kGravity * reach * (std::cos(start) - cosine), 1e-9);
  EXPECT_NEAR(place.norm(), reach, 1e-10);
  EquationsOfMotion equations(mechanism);
  VectorX rate;
  equations.evaluate(0, end, rate);
  EXPECT_NEAR(equations.contactForces()[0].normal, mass * (kGravity * cosine - square / reach), 1e-9);
  EXPECT_NEAR(equations.contactForces()[0].tangential.norm(),
              2.0 / 7 * mass * kGravity * std::sqrt(1 - cosine * cosine), 1e-9);
}

// Two balls in space that roll on each other: all sums stay.
TEST(Sphere, RollingOnAFreeBallKeepsMomentaAndEnergy) {
  Mechanism mechanism;
  mechanism.bodies = {lopsided(0.8), lopsided(1.7, rotationAbout(Vec3(3, -1, 0.4), 1.1))};
  const Vec3 a(0.05, -0.02, 0.04), b(-0.03, 0.06, 0.01);  // balls off the centres of mass
  mechanism.contacts = {sphereOnSphere({0, a}, 0.2, {1, b}, 0.3, kSticking)};
  VectorX state = restingState(2);
  centerOfMass(state, 0) = b - a + 0.5 * Vec3(2, -1, 2) / 3;
  linearVelocity(state, 0) = Vec3(0.3, 0.5, -0.2);
  angularVelocity(state, 0) = Vec3(2, -1, 3);
  angularVelocity(state, 1) = Vec3(-1, 2, 1.5);
  EquationsOfMotion equations(mechanism);
  equations.project(state);
  const VectorX end = integrated(mechanism, state, 1, 1e-11);
  const Invariants before = invariantsOf(mechanism, state), after = invariantsOf(mechanism, end);
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12);
  EXPECT_LT((after.angularMomentum - before.angularMomentum).norm(), 1e-9);
  EXPECT_NEAR(after.kinetic, before.kinetic, 1e-9);
  const ContactKinematics place = placeIn(mechanism, 0, end);
  EXPECT_NEAR(place.gap, 0, 1e-9);
  EXPECT_LT(place.velocity.norm(), 1e-9);
  EXPECT_GT((placeIn(mechanism, 0, state).point - place.point).norm(), 0.1);
}

}  // namespace
}  // namespace cradle
