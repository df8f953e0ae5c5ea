// Bodies that slide, roll and stand on each other, against closed forms.

#include "dynamics/contact_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dynamics/invariants.h"

namespace cradle {
namespace {

constexpr auto kFrictionless = ContactMotion::frictionless;
constexpr auto kSliding = ContactMotion::sliding;
constexpr auto kSticking = ContactMotion::sticking;

// Sums of a few accelerations of about 10, by forces a few times larger.
constexpr double kRounding = 1e-13;

Mechanism onEarth(std::vector<RigidBody> bodies) {
  Mechanism mechanism;
  mechanism.gravity = Vec3(0, -kGravity, 0);
  mechanism.bodies = std::move(bodies);
  return mechanism;
}

/// Adds the four lower corners of a box of body 0, half as wide as `x` and `z`, `height` below its centre of mass and
/// off it by `offset`, on the ground or on a face of body B.
void standOn(Mechanism& mechanism, const Attachment& face, ContactMotion motion, double friction,
             const Vec3& offset = Vec3(0.03, -0.2, -0.05), double x = 0.3, double z = 0.2) {
  for (const double signX : {-1.0, 1.0})
    for (const double signZ : {-1.0, 1.0})
      mechanism.contacts.push_back(ballOnFace({0, offset + Vec3(signX * x, 0, signZ * z)}, 0, face, Vec3::UnitY(),
                                              motion, friction, Vec3::UnitX()));
}

/// A slope down along x: gravity tilted against level ground.
constexpr double kSlope = std::numbers::pi / 6;
Vec3 tiltedGravity() {
  return kGravity * Vec3(std::sin(kSlope), -std::cos(kSlope), 0);
}

TEST(Block, SlidesDownASlopeAtGravityTimesSineLessFrictionTimesCosine) {
  Mechanism mechanism = onEarth({lopsided(2.5)});
  mechanism.gravity = tiltedGravity();
  standOn(mechanism, {}, kSliding, 0.2);
  EquationsOfMotion equations(mechanism);
  VectorX state = restingState(1), rate;
  centerOfMass(state, 0).y() = 0.2;
  const double expected = kGravity * (std::sin(kSlope) - 0.2 * std::cos(kSlope));
  for (const double speed : {0.0, 1e-9, 1e-6, 0.3, 3.0}) {
    linearVelocity(state, 0).x() = speed;
    equations.evaluate(state, rate);
    EXPECT_LT((linearVelocity(rate, 0) - Vec3(expected, 0, 0)).norm(), kRounding) << speed;
    EXPECT_LT(angularVelocity(rate, 0).norm(), 10 * kRounding) << speed;  // inverse inertias of up to 20
  }
  double normal = 0;
  for (const ContactForce& force : equations.contactForces()) {
    normal += force.normal;
    EXPECT_LT((force.tangential + 0.2 * force.normal * Vec3::UnitX()).norm(), kRounding);
  }
  EXPECT_NEAR(normal, 2.5 * kGravity * std::cos(kSlope), 2 * kRounding);
}

// A trial step that goes past the stop goes on as before: one right-hand side on both sides of it.
TEST(Block, DeceleratesThroughZeroWithoutAJump) {
  Mechanism mechanism = onEarth({lopsided(2.5)});
  standOn(mechanism, {}, kSliding, 0.3);
  VectorX state = restingState(1);
  centerOfMass(state, 0).y() = 0.2;
  for (const double speed : {1e-3, 1e-7, 1e-18, 0.0, -1e-18, -1e-7, -1e-3, -1.0}) {
    linearVelocity(state, 0).x() = speed;
    const VectorX rate = rateOf(mechanism, state);
    EXPECT_LT((linearVelocity(rate, 0) - Vec3(-0.3 * kGravity, 0, 0)).norm(), kRounding) << speed;
    EXPECT_NEAR(dissipatedEnergy(rate), 2.5 * 0.3 * kGravity * speed, 10 * kRounding) << speed;
  }
  linearVelocity(state, 0).x() = 1;
  const VectorX end = integrated(mechanism, state, 1, 1e-10);  // x = v t - mu g t^2 / 2, polynomials: to rounding
  EXPECT_NEAR(centerOfMass(end, 0).x(), 1 - 0.15 * kGravity, 1e-12);
}

TEST(Sphere, RollsDownASlopeAtFiveSeventhsOfGravity) {
  Mechanism mechanism = onEarth({solidSphere(0.7, 0.15)});
  mechanism.gravity = tiltedGravity();
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.15, {}, Vec3::UnitY(), kSticking)};
  VectorX state = restingState(1);
  centerOfMass(state, 0).y() = 0.15;
  const VectorX rate = rateOf(mechanism, state), end = integrated(mechanism, state, 1, 1e-10);
  const double expected = 5.0 / 7 * kGravity * std::sin(kSlope);
  EXPECT_LT((linearVelocity(rate, 0) - Vec3(expected, 0, 0)).norm(), kRounding);
  EXPECT_LT((angularVelocity(rate, 0) - Vec3(0, 0, -expected / 0.15)).norm(), 10 * kRounding);
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
    EXPECT_NEAR(linearVelocity(rate, 0).x(), -0.3 * kGravity, kRounding);
    EXPECT_NEAR(angularVelocity(rate, 0).z(), -2.5 * 0.3 * kGravity / 0.1, 10 * kRounding);
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
  mechanism.constraints.hinges = {{{1, Vec3::Zero()}, {kFixed, Vec3::Zero()}, axis, {Vec3::UnitZ(), Vec3::UnitX()}}};
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
  mechanism.contacts = {ballOnBall({0, Vec3::Zero()}, radius, {kFixed, bottom}, ground, kSticking)};
  VectorX state = restingState(1);
  centerOfMass(state, 0) = bottom + reach * Vec3(std::sin(start), std::cos(start), 0);
  const VectorX startRate = rateOf(mechanism, state);
  EXPECT_NEAR(linearVelocity(startRate, 0).norm(), 5.0 / 7 * kGravity * std::sin(start), kRounding);
  const VectorX end = integrated(mechanism, state, 0.6, 1e-10);
  const Vec3 place = centerOfMass(end, 0) - bottom;
  const double square = linearVelocity(end, 0).squaredNorm(), cosine = place.y() / reach;
  EXPECT_LT(cosine, 0.8);  // it has come far
  EXPECT_NEAR(square, 10.0 / 7 * kGravity * reach * (std::cos(start) - cosine), 1e-9);
  EXPECT_NEAR(place.norm(), reach, 1e-10);
  EquationsOfMotion equations(mechanism);
  VectorX rate;
  equations.evaluate(end, rate);
  EXPECT_NEAR(equations.contactForces()[0].normal, mass * (kGravity * cosine - square / reach), 1e-9);
  EXPECT_NEAR(equations.contactForces()[0].tangential.norm(),
              2.0 / 7 * mass * kGravity * std::sqrt(1 - cosine * cosine), 1e-9);
}

// Two balls in space that roll on each other: all sums stay.
TEST(Sphere, RollingOnAFreeBallKeepsMomentaAndEnergy) {
  Mechanism mechanism;
  mechanism.bodies = {lopsided(0.8), lopsided(1.7, rotationAbout(Vec3(3, -1, 0.4), 1.1))};
  const Vec3 a(0.05, -0.02, 0.04), b(-0.03, 0.06, 0.01);  // balls off the centres of mass
  mechanism.contacts = {ballOnBall({0, a}, 0.2, {1, b}, 0.3, kSticking)};
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
  const ContactPlace place = placeIn(mechanism, 0, end);
  EXPECT_NEAR(place.gap, 0, 1e-9);
  EXPECT_LT(place.velocity.norm(), 1e-9);
  EXPECT_GT((placeIn(mechanism, 0, state).point - place.point).norm(), 0.1);
}

// m and M go together, and friction on the box is its mass times that.
TEST(Box, StandsOnAPlatformThatIsPushed) {
  Mechanism mechanism = onEarth({lopsided(2), lopsided(5, Quat::Identity())});
  mechanism.pushes = {{{1, Vec3(0.1, -0.3, 0.2)}, Vec3(3, 0, -1.5)}};
  standOn(mechanism, {1, Vec3(0.2, 0.1, 0)}, kSticking, 0);
  for (const double x : {-1.0, 1.0})  // the platform glides on the ground
    for (const double z : {-1.0, 1.0})
      mechanism.contacts.push_back(
          ballOnFace({1, Vec3(x, -0.1, z)}, 0, {kFixed, Vec3(0, -0.1, 0)}, Vec3::UnitY(), kFrictionless));
  VectorX state = restingState(2), rate;
  centerOfMass(state, 0) = Vec3(-0.03, 0.3, 0.05);
  mechanism.pushes[0].point.point = Vec3::Zero();  // then there is a torque from the box alone
  mechanism.pushes[0].point.point.x() = -0.03 * 2 / 7;
  mechanism.pushes[0].point.point.z() = 0.05 * 2 / 7;
  EquationsOfMotion equations(mechanism);
  equations.evaluate(state, rate);
  const Vec3 expected = Vec3(3, 0, -1.5) / 7;
  for (const Eigen::Index body : {0, 1}) {
    EXPECT_LT((linearVelocity(rate, body) - expected).norm(), kRounding);
    EXPECT_LT(angularVelocity(rate, body).norm(), 10 * kRounding);
  }
  Vec3 friction = Vec3::Zero();
  double onBox = 0, onGround = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    (i < 4 ? onBox : onGround) += equations.contactForces()[i].normal;
    friction += equations.contactForces()[i].tangential;
  }
  EXPECT_LT((friction - 2 * expected).norm(), kRounding);
  EXPECT_NEAR(onBox, 2 * kGravity, 10 * kRounding);
  EXPECT_NEAR(onGround, 7 * kGravity, 10 * kRounding);
}

// A thin rod of length L against a smooth wall and floor, leaning by a: a'^2 = 3 g / L (cos a0 - cos a), and the wall
// pushes with 9/4 m g sin a (cos a - 2/3 cos a0).
TEST(Ladder, SlidesDownASmoothWallAndLeavesItAtTwoThirdsOfItsHeight) {
  const double mass = 3, length = 2, start = 0.4;
  const double inertia = mass * length * length / 12;
  Mechanism mechanism = onEarth({bodyOf(mass, Vec3(inertia, 0.001, inertia).asDiagonal())});
  mechanism.contacts = {ballOnFace({0, Vec3(0, -length / 2, 0)}, 0, {}, Vec3::UnitY(), kFrictionless),
                        ballOnFace({0, Vec3(0, length / 2, 0)}, 0, {}, Vec3::UnitX(), kFrictionless)};
  VectorX state = restingState(1), rate;
  setOrientation(state, 0, rotationAbout(Vec3::UnitZ(), start));
  centerOfMass(state, 0) = length / 2 * Vec3(std::sin(start), std::cos(start), 0);
  EquationsOfMotion equations(mechanism);
  for (const double duration : {0.0, 0.3, 0.7}) {
    const VectorX end = duration > 0 ? integrated(mechanism, state, duration, 1e-11) : state;
    equations.evaluate(end, rate);
    const double cosine = 2 * centerOfMass(end, 0).y() / length, sine = 2 * centerOfMass(end, 0).x() / length;
    EXPECT_NEAR(cosine * cosine + sine * sine, 1, 1e-10);
    EXPECT_NEAR(std::pow(angularVelocity(end, 0).z(), 2), 3 * kGravity / length * (std::cos(start) - cosine), 1e-9);
    EXPECT_NEAR(angularVelocity(rate, 0).z(), 1.5 * kGravity / length * sine, 1e-9);
    EXPECT_NEAR(equations.contactForces()[1].normal,
                2.25 * mass * kGravity * sine * (cosine - 2.0 / 3 * std::cos(start)), 1e-8);
  }
  EXPECT_LT(equations.contactForces()[1].normal, 0);  // it would have left
}

// A corner that sticks to the ground is a ball joint there.
TEST(Top, WhoseTipSticksMovesAsOnABallJoint) {
  Mechanism mechanism = onEarth({lopsided(1.2)}), joint = mechanism;
  const Vec3 tip(0.05, -0.3, 0.1);
  mechanism.contacts = {ballOnFace({0, tip}, 0, {kFixed, Vec3(5, 0, 2)}, Vec3::UnitY(), kSticking)};
  joint.constraints.ballJoints = {{{0, tip}, {kFixed, Vec3::Zero()}}};
  VectorX state = restingState(1);
  setOrientation(state, 0, rotationAbout(Vec3(1, 0.2, 0.5), 0.6));
  centerOfMass(state, 0) = -(orientation(state, 0) * tip);
  angularVelocity(state, 0) = Vec3(1, 20, -2);
  linearVelocity(state, 0) = Vec3(angularVelocity(state, 0)).cross(Vec3(centerOfMass(state, 0)));
  const VectorX expected = rateOf(joint, state), got = rateOf(mechanism, state);
  EXPECT_LT((got - expected).cwiseAbs().maxCoeff(), 1e-11);  // of accelerations of up to 400
  const VectorX end = integrated(mechanism, state, 1, 1e-11);
  EXPECT_LT((end - integrated(joint, state, 1, 1e-11)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(placeIn(mechanism, 0, end).point.norm(), 1e-9);
  EXPECT_NEAR(energyConstant(mechanism, end), energyConstant(mechanism, state), 1e-9);
}

// R8g: each corner carries a quarter and slides across its arm. Angular deceleration 6 mu g / sqrt(a^2 + b^2).
TEST(Box, SpinningOnFourCornersSlowsDown) {
  const double a = 0.4, b = 0.2, friction = 0.3, mass = 2;
  Mechanism mechanism = onEarth({bodyOf(mass, Vec3(0.03, mass * (a * a + b * b) / 12, 0.05).asDiagonal())});
  standOn(mechanism, {}, kSliding, friction, Vec3(0, -0.1, 0), a / 2, b / 2);
  VectorX state = restingState(1);
  centerOfMass(state, 0).y() = 0.1;
  angularVelocity(state, 0).y() = 10;
  for (ContactConstraint& contact : mechanism.contacts)
    setSlidingDirection(contact, Vec3::UnitY().cross(contact.centerA.point), state);
  const double deceleration = 6 * friction * kGravity / std::sqrt(a * a + b * b);
  const VectorX rate = rateOf(mechanism, state);
  EXPECT_NEAR(angularVelocity(rate, 0).y(), -deceleration, 10 * kRounding);
  const double time = 0.25;  // s, just before it stops: it turns by 1.27 rad, further than the directions given reach
  VectorX end = state;
  for (int i = 1; i <= 10; ++i) {
    end = integrated(mechanism, end, time / 10, 1e-11);
    for (std::size_t k = 0; k < 4; ++k)
      setSlidingDirection(mechanism.contacts[k], placeIn(mechanism, k, end).velocity, end);
  }
  EXPECT_NEAR(angularVelocity(end, 0).y(), 10 - deceleration * time, 1e-8);
  const Quat turn = rotationAbout(Vec3::UnitY(), 10 * time - deceleration * time * time / 2);
  EXPECT_LT((orientation(end, 0).coeffs() - turn.coeffs()).norm(), 1e-9);
  EXPECT_LT(centerOfMass(end, 0).head<1>().norm(), 1e-9);
  EXPECT_NEAR(energyConstant(mechanism, end), energyConstant(mechanism, state), 1e-9);
}

// What a box loses as it slides, turns and is bent from its way by a rod and a spring, friction dissipates.
TEST(Box, SlidingOnARodLosesWhatFrictionTakes) {
  Mechanism mechanism = onEarth({lopsided(2.5)});
  standOn(mechanism, {}, kSliding, 0.1);
  VectorX state = restingState(1);
  centerOfMass(state, 0).y() = 0.2;
  mechanism.constraints.rods = {{{0, Vec3(0.1, -0.15, 0.1)}, {kFixed, Vec3(0.1, 0.3, 1)}, 0}};
  RodConstraint& rod = mechanism.constraints.rods[0];
  rod.length = (motionOf(rod.anchorA, state).position - motionOf(rod.anchorB, state).position).norm();
  mechanism.springs = {{{0, Vec3(0.2, 0.1, 0)}, {kFixed, Vec3(1, 0.5, 0.2)}, 8, 0.3, 0.5}};
  linearVelocity(state, 0).x() = 3;
  EquationsOfMotion equations(mechanism);
  equations.project(state);
  const auto redirect = [&] {
    for (std::size_t k = 0; k < 4; ++k)
      setSlidingDirection(mechanism.contacts[k], placeIn(mechanism, k, state).velocity, state);
  };
  const double before = energyConstant(mechanism, state);
  for (int i = 0; i < 10; ++i) {
    redirect();
    state = integrated(mechanism, state, 0.05, 1e-11);
  }
  EXPECT_NEAR(energyConstant(mechanism, state), before, 1e-9);
  EXPECT_GT(dissipatedEnergy(state), 1);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(placeIn(mechanism, k, state).gap, 0, 1e-10);
  EXPECT_NEAR((motionOf(rod.anchorA, state).position - rod.anchorB.point).norm(), rod.length, 1e-10);
}

}  // namespace
}  // namespace cradle
