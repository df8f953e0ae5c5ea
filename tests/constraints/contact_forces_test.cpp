#include "constraints/contact_forces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/contact_motion.h"

namespace cradle {
namespace {

double largestDifference(const VectorX& a, const VectorX& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

Mechanism manyOnEarth(std::size_t bodies) {
  Mechanism mechanism;
  mechanism.gravity = Vec3(1, -kGravity, -0.5);
  mechanism.bodies.assign(bodies, lopsided(2));
  return mechanism;
}

/// A corner of body `body` on level ground.
ContactConstraint corner(int body, const Vec3& point, ContactMotion motion) {
  return ballOnFace({body, point}, 0, {}, Vec3::UnitY(), motion, 0.3, Vec3(1, 0, 0.2));
}

/// `bodies` bodies one metre apart, with some velocities, each on three corners.
struct Row {
  Mechanism mechanism;
  VectorX state;

  explicit Row(int bodies)
      : mechanism(manyOnEarth(static_cast<std::size_t>(bodies))), state(restingState(mechanism.bodies.size())) {
    for (int body = 0; body < bodies; ++body) {
      centerOfMass(state, body) = Vec3(body, 0.2, 0);
      linearVelocity(state, body) = Vec3(0.3 + body, 0, 0.1);
      angularVelocity(state, body).y() = 0.2 * body;
      const ContactMotion motion = body % 2 == 0 ? kSliding : kFrictionless;
      for (const Vec3& point : {Vec3(0.2, -0.2, 0.1), Vec3(-0.2, -0.2, 0.1), Vec3(0.1, -0.2, -0.3)})
        mechanism.contacts.push_back(corner(body, point, motion));
    }
  }
};

TEST(ContactGroups, BodiesApartMoveAsIfAloneToTheBit) {
  const Row three(3), one(1);
  const VectorX rate = rateOf(three.mechanism, three.state), alone = rateOf(one.mechanism, one.state);
  EXPECT_EQ(Vec3(linearVelocity(rate, 0)), Vec3(linearVelocity(alone, 0)));
  EXPECT_EQ(Vec3(angularVelocity(rate, 0)), Vec3(angularVelocity(alone, 0)));
}

// Rods of other bodies go the way that they go without any contact, and multipliers keep their places.
TEST(ContactGroups, TiesOfOtherBodiesAreSolvedAsWithoutContactsToTheBit) {
  Row row(4);
  row.mechanism.contacts.resize(3);  // of body 0 alone
  const auto rod = [](int a, int b, double length) {
    return Constraint{{a, Vec3(0.1, 0.2, 0)}, {b, Vec3(0, 0.1, -0.1)}, RodConstraint{length}};
  };
  row.mechanism.constraints = {rod(1, 2, 1), rod(0, kFixed, 0.5), rod(2, 3, 1.1)};
  Mechanism without = row.mechanism;
  without.contacts.clear();
  without.constraints = {rod(1, 2, 1), rod(2, 3, 1.1)};
  EquationsOfMotion equations(row.mechanism), free(without);
  VectorX rate, freeRate;
  equations.evaluate(row.state, rate);
  free.evaluate(row.state, freeRate);
  for (const Eigen::Index body : {1, 2, 3}) {
    EXPECT_EQ(Vec3(linearVelocity(rate, body)), Vec3(linearVelocity(freeRate, body)));
    EXPECT_EQ(Vec3(angularVelocity(rate, body)), Vec3(angularVelocity(freeRate, body)));
  }
  ASSERT_EQ(equations.multipliers().size(), 3);
  EXPECT_EQ(equations.multipliers()[0], free.multipliers()[0]);
  EXPECT_EQ(equations.multipliers()[2], free.multipliers()[1]);
  EXPECT_NE(equations.multipliers()[1], 0);
}

// A rod in a group with a contact: the multiplier has the same unit as without one.
TEST(ContactGroups, RodsHaveTheMultipliersThatConstraintSolverGives) {
  Row row(2);
  row.mechanism.constraints = {{{0, Vec3(0, 0.3, 0)}, {1, Vec3(0.1, 0, 0.1)}, RodConstraint{1.1}}};
  row.mechanism.contacts.resize(1);
  row.mechanism.contacts[0] = corner(1, Vec3(0.1, -0.2, 0.3), kFrictionless);
  Mechanism rods = row.mechanism;  // a rod straight down to a point far away does what the ground does, nearly
  rods.contacts.clear();
  const double far = 1e7;
  rods.constraints.push_back({{1, Vec3(0.1, -0.2, 0.3)}, {kFixed, Vec3(1.1, -far, 0.3)}, RodConstraint{far}});
  EquationsOfMotion onGround(row.mechanism), onRod(rods);
  VectorX rate, expected;
  onGround.evaluate(row.state, rate);
  onRod.evaluate(row.state, expected);
  EXPECT_LT(largestDifference(rate, expected), 1e-6);  // 1e-7 of velocities' squares, and 1e-16 far^2 of rounding
  EXPECT_NEAR(onGround.multipliers()[0], onRod.multipliers()[0], 1e-6);
  EXPECT_NEAR(onGround.contactForces()[0].normal, onRod.multipliers()[1] * far, 1e-6);
}

// The joining of three contacts with the ground reads like that of two and a rod to the world.
TEST(ContactGroups, AreFoundAnewWhenATieTakesAContactsPlace) {
  Row row(1);
  EquationsOfMotion equations(row.mechanism);
  VectorX rate;
  equations.evaluate(row.state, rate);
  row.mechanism.contacts.pop_back();
  row.mechanism.constraints = {{{0, Vec3(0.1, 0.2, 0)}, {kFixed, Vec3(0, 1, -0.1)}, RodConstraint{0.7}}};
  equations.evaluate(row.state, rate);
  EXPECT_EQ(rate, rateOf(row.mechanism, row.state));
  ASSERT_EQ(equations.multipliers().size(), 1);
  EXPECT_NE(equations.multipliers()[0], 0);
}

TEST(ContactGroups, RestingBodiesActAsFixed) {
  Mechanism stack = manyOnEarth(2), onGround = manyOnEarth(2);
  const Vec3 points[] = {Vec3(0.2, -0.2, 0.1), Vec3(-0.2, -0.2, 0.1), Vec3(0.1, -0.2, -0.3)};
  for (const Vec3& point : points) {
    stack.contacts.push_back(ballOnFace({0, point}, 0, {1, Vec3(0, 0.3, 0)}, Vec3::UnitY(), kSliding, 0.3));
    onGround.contacts.push_back(ballOnFace({0, point}, 0, {kFixed, Vec3(0, 0.3, 0)}, Vec3::UnitY(), kSliding, 0.3));
  }
  for (const Vec3& point : points) stack.contacts.push_back(corner(1, point, kSticking));
  stack.constraints = {{{1, Vec3(0, 0.1, 0.1)}, {0, Vec3(0, 0.1, 0)}, RodConstraint{std::sqrt(0.26)}}};
  onGround.constraints = {{{kFixed, Vec3(0, 0.1, 0.1)}, {0, Vec3(0, 0.1, 0)}, RodConstraint{std::sqrt(0.26)}}};
  VectorX state = restingState(2), rate, expected;
  centerOfMass(state, 0).y() = 0.5;
  linearVelocity(state, 0) = Vec3(0.4, 0, 0.7);
  EquationsOfMotion equations(stack), onFixed(onGround);
  for (EquationsOfMotion* each : {&equations, &onFixed}) each->setResting(1, true);
  equations.evaluate(state, rate);
  onFixed.evaluate(state, expected);
  EXPECT_EQ(rate, expected);
  EXPECT_EQ(rate.segment<kVelocitySize>(velocityOffset(state, 1)), VectorX::Zero(kVelocitySize));
  EXPECT_NE(equations.contactForces()[0].normal, 0);
  EXPECT_EQ(equations.contactForces()[5].normal, 0);  // nothing is solved under a body at rest
  const VectorX before = state;
  centerOfMass(state, 0).y() += 1e-3;
  EXPECT_NEAR(equations.project(state), 1e-3, 1e-5);
  EXPECT_EQ(state.segment<kPoseSize>(kPoseSize), before.segment<kPoseSize>(kPoseSize));
  equations.setResting(1, false);
  equations.evaluate(state, rate);
  EXPECT_GT(std::abs(equations.contactForces()[5].normal), 1e-3);
}

// The same contact twice, four corners for three, a rod twice: the motion stays.
TEST(RedundantContacts, DoWhatIndependentOnesDo) {
  for (const ContactMotion motion : {kFrictionless, kSliding, kSticking}) {
    Row row(1);
    for (ContactConstraint& contact : row.mechanism.contacts) contact.motion = motion;
    const Attachment onBody{0, Vec3(0, 0.3, 0.1)}, onWorld{kFixed, Vec3(0.3, 1, 0)};
    const double length = (motionOf(onBody, row.state).position - onWorld.point).norm();
    const Constraint rod{onBody, onWorld, RodConstraint{length}};
    row.mechanism.constraints = {rod};
    linearVelocity(row.state, 0).setZero();  // so that all corners slide the same way: friction is determined then
    EquationsOfMotion equations(row.mechanism);
    VectorX expected, got;
    equations.evaluate(row.state, expected);
    row.mechanism.contacts.push_back(row.mechanism.contacts[1]);
    row.mechanism.contacts.push_back(corner(0, Vec3(-0.1, -0.2, -0.3), motion));
    row.mechanism.constraints.push_back(rod);
    equations.evaluate(row.state, got);
    EXPECT_LT(largestDifference(got, expected), 1e-12 * (1 + expected.cwiseAbs().maxCoeff()));
    EXPECT_NEAR(equations.contactForces()[1].normal, equations.contactForces()[3].normal, 1e-11);
  }
}

// Four equal corners about the centre of mass share the weight: the shortest of all multipliers.
TEST(RedundantContacts, ShareTheWeightEqually) {
  Mechanism mechanism = manyOnEarth(1);
  mechanism.gravity = Vec3(0, -kGravity, 0);
  for (const double x : {-0.3, 0.3})
    for (const double z : {-0.2, 0.2}) mechanism.contacts.push_back(corner(0, Vec3(x, -0.2, z), kSticking));
  VectorX state = restingState(1), rate;
  centerOfMass(state, 0).y() = 0.2;
  EquationsOfMotion equations(mechanism);
  equations.evaluate(state, rate);
  for (const ContactForce& force : equations.contactForces()) {
    EXPECT_NEAR(force.normal, 2 * kGravity / 4, 1e-13);
    EXPECT_LT(force.tangential.norm(), 1e-13);
  }
}

// Three boxes of 1 kg under one of 1000: the light ones are in balance between 1e4 N above and below, rounded by 1e-12
// N; what decides about these forces is a thousandth of the matrix.
TEST(RedundantContacts, CarryAHeavyBodyOnLightOnes) {
  Mechanism mechanism = manyOnEarth(4);
  mechanism.gravity = Vec3(0, -kGravity, 0);
  VectorX state = restingState(4), rate;
  for (int body = 0; body < 4; ++body) {
    mechanism.bodies[static_cast<std::size_t>(body)] = lopsided(body < 3 ? 1 : 1000);
    centerOfMass(state, body) = Vec3(0.01 * body, 0.2 + 0.4 * body, 0);
    for (const double x : {-0.3, 0.3})
      for (const double z : {-0.2, 0.2})
        mechanism.contacts.push_back(ballOnFace({body, Vec3(x, -0.2, z)}, 0, {body - 1, Vec3(0, body > 0 ? 0.2 : 0, 0)},
                                                Vec3::UnitY(), kSticking));
  }
  EquationsOfMotion equations(mechanism);
  equations.evaluate(state, rate);
  EXPECT_LT(rate.segment(poseComponents(state), 4 * kVelocitySize).cwiseAbs().maxCoeff(),
            1e-10);  // arms / inertia: up to 10/kg
  for (std::size_t body = 0; body < 4; ++body) {
    double weight = 0;
    for (std::size_t i = 4 * body; i < 4 * body + 4; ++i) weight += equations.contactForces()[i].normal;
    EXPECT_NEAR(weight, kGravity * (1003 - static_cast<double>(body)), 1e-8);
  }
}

// Feet that stick to two plates which move apart: no motion keeps both; the box goes with their mean.
TEST(RedundantContacts, ThatContradictEachOtherAreHeldInTheMean) {
  Mechanism mechanism = manyOnEarth(3);
  mechanism.gravity.setZero();
  for (const int plate : {1, 2}) {
    mechanism.bodies[static_cast<std::size_t>(plate)] = lopsided(1e9, Quat::Identity());
    mechanism.pushes.push_back({{plate, Vec3::Zero()}, Vec3(plate == 1 ? -1e9 : 3e9, 0, 0)});
    const double x = plate == 1 ? -0.3 : 0.3;
    for (const double z : {-0.2, 0.2})
      mechanism.contacts.push_back(ballOnFace({0, Vec3(x, 0, z)}, 0, {plate, Vec3(0, 0, 0)}, Vec3::UnitY(), kSticking));
  }
  const VectorX rate = rateOf(mechanism, restingState(3));
  EXPECT_TRUE(rate.allFinite());
  EXPECT_LT(rate.cwiseAbs().maxCoeff(), 10);
}

TEST(ContactProjection, ClosesGapsAndTiesAtOnceToRounding) {
  Row row(2);
  row.mechanism.contacts.push_back(corner(1, Vec3(-0.1, -0.2, -0.3), kFrictionless));  // redundant
  row.mechanism.contacts[0].motion = kSticking;
  row.mechanism.constraints = {{{0, Vec3(0.5, 0.1, 0)}, {1, Vec3(-0.5, 0.1, 0)}, BallJointConstraint()}};
  const VectorX sound = row.state;
  centerOfMass(row.state, 0) += Vec3(1e-4, 3e-4, -2e-4);
  turnBody(row.state, 1, Vec3(2e-4, 1e-4, -3e-4));
  EquationsOfMotion equations(row.mechanism);
  EXPECT_GT(equations.project(row.state), 2e-4);
  std::vector<BodyFrame> frames;
  findBodyFrames(row.mechanism.bodies, row.state, frames);
  std::vector<ConstraintRow> rows;
  findRows(row.mechanism.constraints, row.state, frames, rows);
  for (const ConstraintRow& tie : rows) {
    EXPECT_NEAR(tie.value, 0, 3e-15);
    EXPECT_NEAR(rateOf(tie, row.state), 0, 1e-14);
  }
  for (std::size_t i = 0; i < row.mechanism.contacts.size(); ++i) {
    const ContactKinematics place = placeIn(row.mechanism, i, row.state);
    EXPECT_NEAR(place.gap, 0, 2e-15) << i;
    EXPECT_NEAR(place.velocity.dot(place.normal), 0, 1e-14) << i;
    EXPECT_TRUE(i > 0 || place.velocity.norm() < 1e-14);  // the first one sticks
  }
  EXPECT_LT(largestDifference(row.state.head(2 * kPoseSize), sound.head(2 * kPoseSize)), 1e-3);
}

// The shortest way, by mass: a free ball and one twice as heavy, 1 mm into each other, part 2:1.
TEST(ContactProjection, MovesBodiesByTheInverseOfTheirMasses) {
  Mechanism mechanism;
  mechanism.bodies = {solidSphere(1, 0.2), solidSphere(2, 0.3)};
  mechanism.contacts = {sphereOnSphere({0, Vec3::Zero()}, 0.2, {1, Vec3::Zero()}, 0.3, kFrictionless)};
  VectorX state = restingState(2);
  centerOfMass(state, 0).x() = 0.499;
  linearVelocity(state, 0) = Vec3(-3, 1, 0);
  EquationsOfMotion equations(mechanism);
  EXPECT_NEAR(equations.project(state), 1e-3, 1e-15);
  EXPECT_NEAR(centerOfMass(state, 0).x(), 0.499 + 2e-3 / 3, 1e-15);
  EXPECT_NEAR(centerOfMass(state, 1).x(), -1e-3 / 3, 1e-15);
  EXPECT_LT((Vec3(linearVelocity(state, 0)) - Vec3(-1, 1, 0)).norm(), 1e-14);  // as after an impact without rebound
  EXPECT_LT((Vec3(linearVelocity(state, 1)) - Vec3(-1, 0, 0)).norm(), 1e-14);
}

}  // namespace
}  // namespace cradle
