#include "impact/contact_impulse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/invariants.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kUnitRounding = 1e-13;  // of numbers up to some tens, after a dozen operations

/// Two lopsided bodies that move in all ways, and a contact between them off both centres, askew.
struct StruckBodies {
  std::vector<RigidBody> bodies;
  VectorX state = VectorX::Zero(stateSize(2));
  Contact contact{0, 0, 1, Vec3(0.3, 0.1, -0.2), Vec3(2, -1, 2) / 3, 0};

  StruckBodies() {
    for (const int body : {0, 1}) {
      const Mat3 turn = rotationAbout(Vec3(1, body, 2), 0.4 + body).toRotationMatrix();
      bodies.push_back(makeRigidBody(
          {2.0 + body, Vec3::Zero(), turn * Vec3(0.1, 0.2, 0.25 + 0.03 * body).asDiagonal() * turn.transpose()}));
    }
    centerOfMass(state, 0) = Vec3(-0.2, 0.3, 0.1), centerOfMass(state, 1) = Vec3(0.7, -0.2, -0.4);
    setOrientation(state, 0, rotationAbout(Vec3(3, 1, -2), 0.8));
    setOrientation(state, 1, rotationAbout(Vec3(-1, 1, 1), 2.1));
    linearVelocity(state, 0) = Vec3(1, -0.4, 0.3), linearVelocity(state, 1) = Vec3(-0.5, 0.6, 0.1);
    angularVelocity(state, 0) = Vec3(0.3, 2, -1), angularVelocity(state, 1) = Vec3(-1, 0.2, 0.7);
  }
  Mat3 inverseInertiaOf(int body) const {  // world
    const Mat3 turn = orientation(state, body).toRotationMatrix();
    return (turn * bodies[static_cast<std::size_t>(body)].inertiaTensor * turn.transpose()).inverse();
  }
  /// What an impulse at the contact adds to the velocity of a body's point there, by Newton and Euler: p / m + (I^-1 (r
  /// x p)) x r.
  Vec3 pointResponse(int body, const Vec3& impulse) const {
    const Vec3 arm = contact.point - centerOfMass(state, body);
    return impulse / bodies[static_cast<std::size_t>(body)].mass +
           Vec3(inverseInertiaOf(body) * arm.cross(impulse)).cross(arm);
  }
};

TEST(ContactImpulse, DelassusOperatorIsWhatAnImpulseAddsToTheRelativeVelocity) {
  StruckBodies at;
  const Mat3 both = delassusAt(at.contact, at.bodies, at.state);
  for (int i = 0; i < 3; ++i) {
    const Vec3 impulse = Vec3::Unit(i);
    EXPECT_LT((both.col(i) - at.pointResponse(0, impulse) - at.pointResponse(1, impulse)).norm(), kUnitRounding);
  }
  for (const int moving : {0, 1}) {
    Contact onWall = at.contact;
    (moving == 0 ? onWall.bodyB : onWall.bodyA) = kFixed;
    const Mat3 one = delassusAt(onWall, at.bodies, at.state);
    for (int i = 0; i < 3; ++i)
      EXPECT_LT((one.col(i) - at.pointResponse(moving, Vec3::Unit(i))).norm(), kUnitRounding) << moving;
  }
}

TEST(ContactImpulse, RowsAreOfTheVelocityOfBRelativeToA) {
  const StruckBodies at;
  const auto velocityOf = [&](int body) -> Vec3 {
    return Vec3(linearVelocity(at.state, body)) +
           Vec3(angularVelocity(at.state, body)).cross(Vec3(at.contact.point - centerOfMass(at.state, body)));
  };
  const Mat3 directions = rotationAbout(Vec3(1, 1, 3), 0.5).toRotationMatrix();
  const ConstraintBlock three = rowsAlong(directions, at.contact, at.state);
  ASSERT_EQ(three.rows, 3);
  for (int row = 0; row < 3; ++row)
    EXPECT_NEAR(rateOf(three, row, at.state), directions.col(row).dot(velocityOf(1) - velocityOf(0)), kUnitRounding);
  Contact onWall = at.contact;
  onWall.bodyA = kFixed;
  const ConstraintBlock one = rowsAlong(onWall.normal, onWall, at.state);
  ASSERT_EQ(one.rows, 1);
  EXPECT_NEAR(rateOf(one, 0, at.state), onWall.normal.dot(velocityOf(1)), kUnitRounding);
}

// Momentum and angular momentum stay, and B gains the impulse.
TEST(ImpulseResponse, AppliesOppositeImpulsesAtOnePoint) {
  const StruckBodies at;
  const ImpulseResponse response(at.bodies);
  EXPECT_FALSE(response.areConstrained());
  const Vec3 impulse(0.4, -0.7, 1.1);
  VectorX after = at.state;
  response.apply(at.contact, impulse, after);
  Mechanism mechanism;
  mechanism.bodies = at.bodies;
  const Invariants then = invariantsOf(mechanism, at.state), now = invariantsOf(mechanism, after);
  EXPECT_LT((now.momentum - then.momentum).norm(), kUnitRounding);
  EXPECT_LT((now.angularMomentum - then.angularMomentum).norm(), kUnitRounding);
  EXPECT_LT((at.bodies[1].mass * (linearVelocity(after, 1) - linearVelocity(at.state, 1)) - impulse).norm(),
            kUnitRounding);
  const VectorX alone = response.responseTo(at.contact, impulse, at.state);
  const Eigen::Index poses = poseComponents(at.state), speeds = motionComponents(at.state) - poses;
  EXPECT_EQ(alone.head(poses), at.state.head(poses));
  EXPECT_LT((alone.segment(poses, speeds) - (after - at.state).segment(poses, speeds)).norm(), kUnitRounding);
}

// A body on a ball joint to the world turns about that with I_0 = I + m (d^2 - d d^T): an impulse at r from it turns it
// by I_0^-1 (r x p), and nothing else.
TEST(ImpulseResponse, OfABodyOnAPivotIsThatOfItsInertiaAboutIt) {
  StruckBodies at;
  const Vec3 anchor(0.2, -0.3, 0.1);
  const Vec3 way = orientation(at.state, 1) * anchor, pivot = centerOfMass(at.state, 1) + way;
  const Constraints pins = {{{1, anchor}, {kFixed, pivot}, BallJointConstraint()}};
  ConstraintSolver solver(pins, at.bodies);
  solver.factorize(at.state);
  const ImpulseResponse response(at.bodies, solver);
  EXPECT_TRUE(response.areConstrained());
  Contact onWall = at.contact;
  onWall.bodyA = kFixed;
  const Mat3 inertia = at.inverseInertiaOf(1).inverse() +
                       at.bodies[1].mass * (way.squaredNorm() * Mat3::Identity() - way * way.transpose());
  const Vec3 arm = onWall.point - pivot;
  const Mat3 expected = -skew(arm) * inertia.inverse() * skew(arm);
  EXPECT_LT((response.delassusAt(onWall, at.state) - expected).norm(), kUnitRounding);
  EXPECT_LT((response.unconstrainedDelassusAt(onWall, at.state) - delassusAt(onWall, at.bodies, at.state)).norm(),
            kUnitRounding);
  const Mat3 directions = rotationAbout(Vec3(1, 1, 3), 0.5).toRotationMatrix();
  const DenseDelassus rows = response.delassusOf({rowsAlong(directions, onWall, at.state)}, at.state);
  EXPECT_LT((rows.matrix() - directions.transpose() * expected * directions).norm(), kUnitRounding);
}

// A ball of 2 kg and I = 0.05 kg m^2 hangs 0.5 m from its joint. An impulse at its middle has 1 / m without the joint,
// and with it x^2 / (I + m L^2), x the distance of its line from the joint: a moment arm of x sqrt(m / (I + m L^2)).
TEST(ImpulseResponse, KnowsLinesThatPassAJointClosely) {
  const std::vector<RigidBody> bodies = {makeRigidBody({2, Vec3::Zero(), 0.05 * Mat3::Identity()})};
  VectorX state = VectorX::Zero(stateSize(1));
  setOrientation(state, 0, Quat::Identity());
  const Constraints pins = {{{0, Vec3(0, 0.5, 0)}, {kFixed, Vec3(0, 0.5, 0)}, BallJointConstraint()}};
  ConstraintSolver solver(pins, bodies);
  solver.factorize(state);
  const ImpulseResponse free(bodies), pinned(bodies, solver);
  const auto contactBeside = [](double distance) {  // its normal passes the joint by that
    const double sine = distance / 0.5;
    return Contact{0, 0, kFixed, Vec3::Zero(), Vec3(sine, std::sqrt(1 - sine * sine), 0), 0};
  };
  const double arm = 1e-2, distance = arm * std::sqrt((0.05 + 2 * 0.25) / 2);
  for (const double part : {0.99, 1.01}) {
    const Contact contact = contactBeside(part * distance);
    EXPECT_EQ(hasShortMomentArm(contact, pinned, state, arm), part < 1);
    EXPECT_FALSE(hasShortMomentArm(contact, free, state, arm));
  }
  const std::vector<Contact> all = {contactBeside(distance), contactBeside(0), contactBeside(-distance)};
  std::vector<Contact> contacts = all;
  eraseImmobile(free, state, contacts);
  ASSERT_EQ(contacts.size(), 3u);
  EXPECT_TRUE(isImmobile(all[1], pinned, state));
  EXPECT_FALSE(isImmobile(all[1], free, state));
  EXPECT_FALSE(isImmobile(all[0], pinned, state));
  eraseImmobile(pinned, state, contacts);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(contacts[0].normal, all[0].normal);
  EXPECT_EQ(contacts[1].normal, all[2].normal);
}

}  // namespace
}  // namespace cradle
