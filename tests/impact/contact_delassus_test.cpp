#include "impact/contact_delassus.h"

#include <gtest/gtest.h>

#include "impact/row_of_balls.h"
#include "math/rotation.h"

namespace cradle {
namespace {

/// Two bodies without symmetry, turned and moving, that touch at two places, and one of them the floor.
struct TouchingPair {
  std::vector<RigidBody> bodies;
  std::vector<Contact> contacts;
  VectorX state = statesAtRest(2);

  TouchingPair() {
    for (const double mass : {2.0, 0.3})
      bodies.push_back(makeRigidBody({mass, Vec3::Zero(), Mat3(mass * Vec3(0.02, 0.05, 0.06).asDiagonal())}));
    for (int body = 0; body < 2; ++body) {
      centerOfMass(state, body) = Vec3(0.1, 0.4 * body, -0.2);
      setOrientation(state, body, rotationAbout(Vec3(1, 2, 3), 0.8 - body));
      linearVelocity(state, body) = Vec3(1, -2, 0.3 + body), angularVelocity(state, body) = Vec3(0.3, 1 - body, -2);
    }
    contacts = {{0, 0, 1, Vec3(0.15, 0.2, -0.1), Vec3(0.1, 0.9, 0.3).normalized(), 0},
                {0, 0, 1, Vec3(-0.1, 0.21, -0.25), Vec3(0.1, 0.9, 0.3).normalized(), 0},
                {1, 0, kFixed, Vec3(0.2, -0.3, -0.1), -Vec3::UnitY(), 0}};
  }
  /// The velocity of a body's point, by its definition. What is fixed has none.
  static Vec3 pointVelocity(int body, const Vec3& point, const VectorX& at) {
    if (body == kFixed) return Vec3::Zero();
    return linearVelocity(at, body) + angularVelocity(at, body).cross(point - centerOfMass(at, body));
  }
  Vec3 relativeTo(std::size_t contact, const VectorX& at) const {
    const Contact& one = contacts[contact];
    return pointVelocity(one.bodyB, one.point, at) - pointVelocity(one.bodyA, one.point, at);
  }
  /// Newton's and Euler's laws for an impulse at a body's point.
  void push(int body, const Vec3& point, const Vec3& impulse, VectorX& at) const {
    if (body == kFixed) return;
    const RigidBody& inertia = bodies[static_cast<std::size_t>(body)];
    linearVelocity(at, body) += inertia.inverseMass * impulse;
    angularVelocity(at, body) +=
        worldInverseInertia(inertia, orientation(at, body)) * (point - centerOfMass(at, body)).cross(impulse);
  }
};

TEST(ContactAxes, AreARotationOntoTheNormal) {
  for (const Vec3& normal : {Vec3(0, 1, 0), Vec3(0, 0, -1), Vec3(1, 2, 3), Vec3(-3, 0.1, 0.2), Vec3(1, 1, 1)}) {
    const Mat3 axes = contactAxes(normal.normalized());
    EXPECT_EQ(axes.col(2), normal.normalized());
    EXPECT_LT((axes.transpose() * axes - Mat3::Identity()).norm(), 1e-15);
    EXPECT_NEAR(axes.determinant(), 1, 1e-15);
  }
}

// Column by column: a unit impulse on B and its opposite on A, by Newton's and Euler's laws.
TEST(ContactDelassus, AnswersAsNewtonAndEulerSay) {
  const TouchingPair pair;
  const ContactDelassus delassus(pair.contacts, pair.bodies, pair.state);
  ASSERT_EQ(delassus.matrix().rows(), 9);
  VectorX state = pair.state;
  state.tail(stateSize(2) - 14).setZero();  // at rest
  const VectorX velocities = delassus.velocitiesIn(pair.state);
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Index row = 3 * static_cast<Eigen::Index>(i);
    const Mat3 axes = contactAxes(pair.contacts[i].normal);
    EXPECT_LT((velocities.segment<3>(row) - axes.transpose() * pair.relativeTo(i, pair.state)).norm(), 1e-14);
    for (int axis = 0; axis < 3; ++axis) {
      const VectorX impulses = VectorX::Unit(9, row + axis);
      EXPECT_EQ(delassus.worldImpulse(i, impulses), axes.col(axis));
      VectorX expected = pair.state, pushed = pair.state;
      pair.push(pair.contacts[i].bodyB, pair.contacts[i].point, axes.col(axis), expected);
      pair.push(pair.contacts[i].bodyA, pair.contacts[i].point, -axes.col(axis), expected);
      delassus.apply(impulses, pushed);
      EXPECT_LT((pushed - expected).norm(), 1e-13);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 change = pair.relativeTo(k, expected) - pair.relativeTo(k, pair.state);
        const Vec3 answer = delassus.matrix().col(row + axis).segment<3>(3 * static_cast<Eigen::Index>(k));
        EXPECT_LT((contactAxes(pair.contacts[k].normal) * answer - change).norm(), 1e-13);
      }
    }
  }
}

// A ball of mass m on a ball joint at a distance d from its centre, beside whose axis the contact passes by a: inverse
// mass a^2 / (I + m d^2), and 1/m + b^2 / I without the joint, where b is how far the normal passes the centre. A rod
// along the normal leaves it none.
TEST(ContactDelassus, KnowsWhatJointsLeaveOfAContact) {
  const double mass = 2, inertia = 0.4 * mass * 0.01, d = 0.3, a = 0.02, b = 0.05;
  const std::vector<RigidBody> bodies{ball(mass)};
  const VectorX state = statesAtRest(1);
  const std::vector<Contact> contacts = {{0, 0, kFixed, Vec3(d - a, -0.1, 0), -Vec3::UnitY(), 0},
                                         {0, 0, kFixed, Vec3(b, -0.1, 0), -Vec3::UnitY(), 0}};
  const Constraints joint = {{{0, Vec3(d, 0, 0)}, {kFixed, Vec3(d, 0, 0)}, BallJointConstraint{}}};
  ConstraintSolver solver(joint, bodies);
  solver.factorize(state);
  const ContactDelassus onJoint(contacts, ImpulseResponse(bodies, solver), state);
  const double turned = inertia + mass * d * d;
  EXPECT_NEAR(onJoint.mobility(0), a * a / turned / (1 / mass + (d - a) * (d - a) / inertia), 1e-14);
  EXPECT_NEAR(onJoint.mobility(1), (d - b) * (d - b) / turned / (1 / mass + b * b / inertia), 1e-14);
  EXPECT_FALSE(onJoint.isImmobile(0));

  const Constraints rod = {{{0, Vec3::Zero()}, {kFixed, Vec3(0, 1, 0)}, RodConstraint{1}}};
  ConstraintSolver held(rod, bodies);
  held.factorize(state);
  const ContactDelassus onRod(
      {{0, 0, kFixed, Vec3(0.1, 0, 0), -Vec3::UnitX(), 0}, {0, 0, kFixed, Vec3(0, -0.1, 0), -Vec3::UnitY(), 0}},
      ImpulseResponse(bodies, held), state);
  EXPECT_FALSE(onRod.isImmobile(0));
  EXPECT_TRUE(onRod.isImmobile(1));
  EXPECT_NEAR(onRod.mobility(0), 1, 1e-15);
}

}  // namespace
}  // namespace cradle
