// Bodies that slide and stand on faces and corners, against closed forms.

#include "constraints/contact_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/invariants.h"

namespace cradle {
namespace {

/// Adds the four lower corners of a box of body 0, half as wide as `x` and `z`, `height` below its centre of mass and
/// off it by `offset`, on the ground or on a face of body B.
void standOn(Mechanism& mechanism, const Attachment& face, ContactMotion motion, double friction,
             const Vec3& offset = Vec3(0.03, -0.2, -0.05), double x = 0.3, double z = 0.2) {
  for (const double signX : {-1.0, 1.0})
    for (const double signZ : {-1.0, 1.0})
      mechanism.contacts.push_back(ballOnFace({0, offset + Vec3(signX * x, 0, signZ * z)}, 0, face, Vec3::UnitY(),
                                              motion, friction, Vec3::UnitX()));
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
    equations.evaluate(0, state, rate);
    EXPECT_LT((linearVelocity(rate, 0) - Vec3(expected, 0, 0)).norm(), kMotionRounding) << speed;
    EXPECT_LT(angularVelocity(rate, 0).norm(), 10 * kMotionRounding) << speed;  // inverse inertias of up to 20
  }
  double normal = 0;
  for (const ContactForce& force : equations.contactForces()) {
    normal += force.normal;
    EXPECT_LT((force.tangential + 0.2 * force.normal * Vec3::UnitX()).norm(), kMotionRounding);
  }
  EXPECT_NEAR(normal, 2.5 * kGravity * std::cos(kSlope), 2 * kMotionRounding);
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
    EXPECT_LT((linearVelocity(rate, 0) - Vec3(-0.3 * kGravity, 0, 0)).norm(), kMotionRounding) << speed;
    EXPECT_NEAR(dissipatedEnergy(rate), 2.5 * 0.3 * kGravity * speed, 10 * kMotionRounding) << speed;
  }
  linearVelocity(state, 0).x() = 1;
  const VectorX end = integrated(mechanism, state, 1, 1e-10);  // x = v t - mu g t^2 / 2, polynomials: to rounding
  EXPECT_NEAR(centerOfMass(end, 0).x(), 1 - 0.15 * kGravity, 1e-12);
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
  equations.evaluate(0, state, rate);
  const Vec3 expected = Vec3(3, 0, -1.5) / 7;
  for (const Eigen::Index body : {0, 1}) {
    EXPECT_LT((linearVelocity(rate, body) - expected).norm(), kMotionRounding);
    EXPECT_LT(angularVelocity(rate, body).norm(), 10 * kMotionRounding);
  }
  Vec3 friction = Vec3::Zero();
  double onBox = 0, onGround = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    (i < 4 ? onBox : onGround) += equations.contactForces()[i].normal;
    friction += equations.contactForces()[i].tangential;
  }
  EXPECT_LT((friction - 2 * expected).norm(), kMotionRounding);
  EXPECT_NEAR(onBox, 2 * kGravity, 10 * kMotionRounding);
  EXPECT_NEAR(onGround, 7 * kGravity, 10 * kMotionRounding);
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
    equations.evaluate(0, end, rate);
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
  joint.constraints = {{{0, tip}, {kFixed, Vec3::Zero()}, BallJointConstraint()}};
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
  EXPECT_NEAR(angularVelocity(rate, 0).y(), -deceleration, 10 * kMotionRounding);
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
  const Attachment onBox{0, Vec3(0.1, -0.15, 0.1)}, onWorld{kFixed, Vec3(0.1, 0.3, 1)};
  const double length = (motionOf(onBox, state).position - onWorld.point).norm();
  mechanism.constraints = {{onBox, onWorld, RodConstraint{length}}};
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
  EXPECT_NEAR((motionOf(onBox, state).position - onWorld.point).norm(), length, 1e-10);
}

// A box that stands on a swinging platform with four corners, twelve rows of which six depend on the others, moves as
// one body with it: a physical pendulum.
TEST(Box, StandingOnASwingIsOneBodyWithIt) {
  const RigidBody box = lopsided(2), swing = lopsided(3, rotationAbout(Vec3(0.3, -1, 2), 0.4));
  const Vec3 pivot(0.1, 0.9, 0), onSwing(0.1, 0.35, -0.2);  // from the swing's centre of mass: hinge and box
  const auto hingeAt = [](int body, const Vec3& point) {
    return Constraint{{body, point}, {}, HingeConstraint{Vec3::UnitZ(), {Vec3::UnitX(), Vec3::UnitY()}}};
  };
  Mechanism two = onEarth({box, swing});
  two.constraints = {hingeAt(1, pivot)};
  standOn(two, {1, onSwing + Vec3(0, -0.2, 0)}, kSticking, 0);
  VectorX state = restingState(2);
  centerOfMass(state, 1) = -pivot;
  centerOfMass(state, 0) = onSwing - pivot;
  // The two as one: parallel axes.
  const Vec3 center = 0.4 * onSwing, toBox = onSwing - center;
  const auto parallel = [](double mass, const Vec3& d) {
    return Mat3(mass * (d.squaredNorm() * Mat3::Identity() - d * d.transpose()));
  };
  Mechanism one =
      onEarth({bodyOf(5, box.inertiaTensor + swing.inertiaTensor + parallel(2, toBox) + parallel(3, center))});
  one.constraints = {hingeAt(0, pivot - center)};
  VectorX whole = restingState(1);
  centerOfMass(whole, 0) = center - pivot;
  const VectorX end = integrated(two, state, 1, 1e-10), expected = integrated(one, whole, 1, 1e-10);
  EXPECT_GT(std::abs(orientation(expected, 0).z()), 0.05);  // it swings
  for (const Eigen::Index body : {0, 1}) {
    EXPECT_LT((orientation(end, body).coeffs() - orientation(expected, 0).coeffs()).norm(), 1e-8);
    EXPECT_LT((angularVelocity(end, body) - angularVelocity(expected, 0)).norm(), 1e-8);
  }
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(placeIn(two, i, end).gap, 0, 1e-9);
}

// P. Painleve's rod: pushed along on its tip, friction turns it into the ground. Normal force m (g - l w^2 sin a) / (1
// + 3 cos a (cos a - mu sin a)), l half its length, a its angle to the ground: beyond 4/3 of friction it has no bound.
TEST(Rod, PushedAlongOnItsTipJams) {
  const double mass = 1.5, half = 0.6, spin = 0.8, inertia = mass * half * half / 3;
  Mechanism mechanism = onEarth({bodyOf(mass, Vec3(0.001, inertia, inertia).asDiagonal())});
  mechanism.contacts = {ballOnFace({0, Vec3(-half, 0, 0)}, 0, {}, Vec3::UnitY(), kSliding, 0, -Vec3::UnitX())};
  EquationsOfMotion equations(mechanism);
  VectorX state = restingState(1), rate;
  for (const double angle : {0.4, 1.0, 1.2}) {
    const double cosine = std::cos(angle), sine = std::sin(angle);
    setOrientation(state, 0, rotationAbout(Vec3::UnitZ(), angle));
    centerOfMass(state, 0).y() = half * sine;
    angularVelocity(state, 0).z() = spin;
    linearVelocity(state, 0) = Vec3(-3, half * cosine * spin, 0);
    for (const double friction : {0.0, 0.5, 1.2, 1.7}) {
      mechanism.contacts[0].friction = friction;
      equations.evaluate(0, state, rate);
      const double response = 1 + 3 * cosine * (cosine - friction * sine);
      EXPECT_NEAR(equations.contactForces()[0].normal * response, mass * (kGravity - half * spin * spin * sine), 1e-12)
          << angle << " " << friction;
    }
    mechanism.contacts[0].friction = (cosine + 1 / (3 * cosine)) / sine;  // no response left, or rounding
    equations.evaluate(0, state, rate);
    EXPECT_TRUE(rate.allFinite());
  }
}

}  // namespace
}  // namespace cradle
