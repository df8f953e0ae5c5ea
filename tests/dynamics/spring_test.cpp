#include "dynamics/spring.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kSpringRounding = 1e-13;  // of some tens of operations on numbers below 100

/// Two bodies without symmetry that move in all ways, and a spring between points off their centres.
struct SprungBodies {
  SprungBodies() : state(VectorX::Zero(stateSize(2))) {
    Mat3 one, other;
    one << 0.3, 0.02, -0.01, 0.02, 0.2, 0.03, -0.01, 0.03, 0.4;
    other << 0.1, 0, 0.02, 0, 0.25, 0, 0.02, 0, 0.2;
    bodies = {makeRigidBody({3, Vec3::Zero(), one}), makeRigidBody({2, Vec3::Zero(), other})};
    centerOfMass(state, 0) = Vec3(1, 2, 3), centerOfMass(state, 1) = Vec3(-1, 0.5, 2);
    setOrientation(state, 0, rotationAbout(Vec3(1, 2, 3), 0.9));
    setOrientation(state, 1, rotationAbout(Vec3(-2, 1, 0.5), 2.1));
    linearVelocity(state, 0) = Vec3(0.4, -1, 0.3), linearVelocity(state, 1) = Vec3(-0.2, 0.7, 1);
    angularVelocity(state, 0) = Vec3(2, -1, 0.5), angularVelocity(state, 1) = Vec3(0.3, 3, -1);
  }
  /// m: where an anchor is, and in how much time from now (s) at the velocities of now.
  Vec3 placeOf(const Attachment& anchor, double time) const {
    if (anchor.body == kFixed) return anchor.point;
    const Vec3 turn = time * Vec3(angularVelocity(state, anchor.body));
    const Quat turned = turn.norm() > 0 ? rotationAbout(turn.normalized(), turn.norm()) : Quat::Identity();
    return Vec3(centerOfMass(state, anchor.body)) + time * Vec3(linearVelocity(state, anchor.body)) +
           turned * (orientation(state, anchor.body) * anchor.point);
  }
  double lengthIn(double time) const { return (placeOf(spring.anchorA, time) - placeOf(spring.anchorB, time)).norm(); }

  std::vector<RigidBody> bodies;
  VectorX state;
  SpringForce spring{{0, Vec3(0.3, -0.2, 0.1)}, {1, Vec3(0.1, 0.4, -0.2)}, 40, 6, 1.5};
};

// -k (L - L0) - c dL/dt along the line of its ends, with dL/dt a difference quotient, good to the square of 1e-5 s.
TEST(Spring, PullsByItsLengthAndItsLengthening) {
  for (const bool isFixed : {false, true}) {
    SprungBodies at;
    if (isFixed) at.spring.anchorB = {kFixed, Vec3(0.5, -1, 2)};
    const double length = at.lengthIn(0), lengthening = (at.lengthIn(1e-5) - at.lengthIn(-1e-5)) / 2e-5;
    const Vec3 along = (at.placeOf(at.spring.anchorA, 0) - at.placeOf(at.spring.anchorB, 0)) / length;
    const SpringAction action = actionOf(at.spring, at.state);
    EXPECT_LT((action.forceOnA + (40 * (length - 1.5) + 6 * lengthening) * along).norm(), 1e-7);
    EXPECT_NEAR(action.potential, 20 * std::pow(length - 1.5, 2), kSpringRounding);
    EXPECT_NEAR(action.dissipation, 6 * lengthening * lengthening, 1e-7);
    EXPECT_LT((action.a.arm - orientation(at.state, 0) * at.spring.anchorA.point).norm(), kSpringRounding);
    EXPECT_NEAR(action.b.arm.norm(), isFixed ? 0 : at.spring.anchorB.point.norm(), kSpringRounding);
  }
}

// The work of its forces at both ends is what its potential and its damper take.
TEST(Spring, TakesThePowerOfItsForces) {
  SprungBodies at;
  const SpringAction action = actionOf(at.spring, at.state);
  const double power = action.forceOnA.dot(action.a.velocity - action.b.velocity);
  const double length = at.lengthIn(0), lengthening = (at.lengthIn(1e-5) - at.lengthIn(-1e-5)) / 2e-5;
  EXPECT_NEAR(power, -40 * (length - 1.5) * lengthening - action.dissipation, 1e-7);
  EXPECT_GT(action.dissipation, 0);
}

TEST(Spring, DoesNothingAtLengthZero) {
  const AttachmentMotion here{Vec3::Zero(), Vec3(1, 2, 3), Vec3(1, 0, 0)};
  const SpringPull pull = pullOf(SpringForce{{}, {}, 40, 6, 1.5}, here, here);
  EXPECT_EQ(pull.forceOnA, Vec3(0, 0, 0));
  EXPECT_EQ(pull.dissipation, 0);
}

// w^2 = k (1/m_A + 1/m_B) at centres of mass; off them the turning adds |r x n|^2 / I.
TEST(Spring, HasTheFrequencyOfTheMassesAtItsEnds) {
  SprungBodies at;
  at.spring.anchorA.point = at.spring.anchorB.point = Vec3::Zero();
  EXPECT_NEAR(naturalFrequency(at.spring, at.bodies, at.state), std::sqrt(40 * (1 / 3.0 + 1 / 2.0)), kSpringRounding);
  at.spring.anchorB = {kFixed, Vec3(9, 9, 9)};
  EXPECT_NEAR(naturalFrequency(at.spring, at.bodies, at.state), std::sqrt(40 / 3.0), kSpringRounding);

  SprungBodies rod;  // a spring along y at 0.5 m beside the centre, and I = 0.2 about z
  rod.bodies[0] = makeRigidBody({3, Vec3::Zero(), Vec3(0.1, 0.15, 0.2).asDiagonal()});
  setOrientation(rod.state, 0, Quat::Identity());
  rod.spring.anchorA.point = Vec3(0.5, 0, 0);
  rod.spring.anchorB = {kFixed, Vec3(1.5, 7, 3)};
  EXPECT_NEAR(naturalFrequency(rod.spring, rod.bodies, rod.state), std::sqrt(40 * (1 / 3.0 + 0.25 / 0.2)),
              kSpringRounding);
}

}  // namespace
}  // namespace cradle
