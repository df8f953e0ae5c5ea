#include "constraints/contact_groups.h"

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/bodies_on_ground.h"

namespace cradle {
namespace {

using testing::ElementsAre;

// Bodies 0-1-2 and 4 touch the ground or each other, 2-3 are tied, 5-6 are tied without a contact. A fixed body joins
// nothing, and a contact of two fixed bodies is in no group.
TEST(ContactGroups, AreOfBodiesThatContactsAndConstraintsJoin) {
  const auto touch = [](int a, int b) {
    return sphereOnSphere({a, Vec3::Zero()}, 0.1, {b, Vec3::Zero()}, 0.1, kFrictionless);
  };
  const auto rod = [](int a, int b) { return Constraint{{a, Vec3::Zero()}, {b, Vec3::Zero()}, RodConstraint{1}}; };
  const std::vector<ContactConstraint> contacts = {touch(4, kFixed), touch(1, 2), touch(0, 1)};
  const Constraints constraints = {rod(5, 6), rod(3, 2)};
  std::vector<char> fixed(7, 0);
  std::vector<ContactGroup> groups = findContactGroups(contacts, constraints, fixed);
  ASSERT_EQ(groups.size(), 2);
  EXPECT_THAT(groups[0].bodies, ElementsAre(4));
  EXPECT_THAT(groups[0].contacts, ElementsAre(0));
  EXPECT_FALSE(groups[0].hasConstraints);
  EXPECT_THAT(groups[1].bodies, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(groups[1].contacts, ElementsAre(1, 2));
  EXPECT_TRUE(groups[1].hasConstraints);

  fixed[1] = fixed[4] = 1;
  groups = findContactGroups(contacts, constraints, fixed);
  ASSERT_EQ(groups.size(), 2);
  EXPECT_THAT(groups[0].bodies, ElementsAre(2, 3));
  EXPECT_THAT(groups[0].contacts, ElementsAre(1));
  EXPECT_TRUE(groups[0].hasConstraints);
  EXPECT_THAT(groups[1].bodies, ElementsAre(0));
  EXPECT_FALSE(groups[1].hasConstraints);
}

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
  equations.evaluate(0, row.state, rate);
  free.evaluate(0, row.state, freeRate);
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
  onGround.evaluate(0, row.state, rate);
  onRod.evaluate(0, row.state, expected);
  EXPECT_LT(largestDifference(rate, expected), 1e-6);  // 1e-7 of velocities' squares, and 1e-16 far^2 of rounding
  EXPECT_NEAR(onGround.multipliers()[0], onRod.multipliers()[0], 1e-6);
  EXPECT_NEAR(onGround.contactForces()[0].normal, onRod.multipliers()[1] * far, 1e-6);
}

// The joining of three contacts with the ground reads like that of two and a rod to the world.
TEST(ContactGroups, AreFoundAnewWhenATieTakesAContactsPlace) {
  Row row(1);
  EquationsOfMotion equations(row.mechanism);
  VectorX rate;
  equations.evaluate(0, row.state, rate);
  row.mechanism.contacts.pop_back();
  row.mechanism.constraints = {{{0, Vec3(0.1, 0.2, 0)}, {kFixed, Vec3(0, 1, -0.1)}, RodConstraint{0.7}}};
  equations.evaluate(0, row.state, rate);
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
  equations.evaluate(0, state, rate);
  onFixed.evaluate(0, state, expected);
  EXPECT_EQ(rate, expected);
  EXPECT_EQ(rate.segment<kVelocitySize>(velocityOffset(state, 1)), VectorX::Zero(kVelocitySize));
  EXPECT_NE(equations.contactForces()[0].normal, 0);
  EXPECT_EQ(equations.contactForces()[5].normal, 0);  // nothing is solved under a body at rest
  const VectorX before = state;
  centerOfMass(state, 0).y() += 1e-3;
  EXPECT_NEAR(equations.project(state), 1e-3, 1e-5);
  EXPECT_EQ(state.segment<kPoseSize>(kPoseSize), before.segment<kPoseSize>(kPoseSize));
  equations.setResting(1, false);
  equations.evaluate(0, state, rate);
  EXPECT_GT(std::abs(equations.contactForces()[5].normal), 1e-3);
}

// As many contacts and rows as before, but of other bodies, with another motion, or with one more rod.
TEST(ContactGroups, AreFoundAnewWhenAContactOrARodChanges) {
  Row row(3);
  EquationsOfMotion equations(row.mechanism);
  VectorX rate;
  const auto expectFresh = [&] {
    equations.evaluate(0, row.state, rate);
    EXPECT_EQ(rate, rateOf(row.mechanism, row.state));
  };
  expectFresh();
  row.mechanism.contacts[0].motion = kSticking;
  expectFresh();
  row.mechanism.contacts[0] = corner(2, Vec3(0, -0.2, 0.3), kSticking);
  expectFresh();
  row.mechanism.constraints = {{{0, Vec3(0.1, 0.2, 0)}, {kFixed, Vec3(0, 1, -0.1)}, RodConstraint{0.7}}};
  expectFresh();
  row.mechanism.constraints[0].anchorB = {1, Vec3(0, 0.2, 0)};
  expectFresh();
}

// A ball on a ball on the ground: the lower contact carries both weights. The ground may be the A of a contact as well,
// as where a face lies on a fixed ball.
TEST(ContactGroups, BodiesThatTouchAreSolvedTogether) {
  Mechanism mechanism = onEarth({solidSphere(2, 0.1), solidSphere(3, 0.1), lopsided(4)});
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.1, {}, Vec3::UnitY(), kSticking),
                        sphereOnSphere({1, Vec3::Zero()}, 0.1, {0, Vec3::Zero()}, 0.1, kSticking),
                        ballOnFace({kFixed, Vec3(5, 0.1, 0)}, 0.1, {2, Vec3::Zero()}, -Vec3::UnitY(), kFrictionless)};
  VectorX state = restingState(3), rate;
  centerOfMass(state, 0).y() = 0.1, centerOfMass(state, 1).y() = 0.3, centerOfMass(state, 2) = Vec3(5, 0.2, 0);
  EquationsOfMotion equations(mechanism);
  equations.evaluate(0, state, rate);
  EXPECT_NEAR(equations.contactForces()[0].normal, 5 * kGravity, 1e-12);
  EXPECT_NEAR(equations.contactForces()[1].normal, 3 * kGravity, 1e-12);
  EXPECT_NEAR(equations.contactForces()[2].normal, 4 * kGravity, 1e-12);
}

// Friction makes a group's matrix one without symmetry: corners that slide keep their height all the same.
TEST(ContactGroups, SlidingCornersKeepTheirHeight) {
  Row row(1);
  angularVelocity(row.state, 0).setZero();
  row.mechanism.gravity = Vec3(0, -kGravity, 0);
  const VectorX rate = rateOf(row.mechanism, row.state);
  for (const ContactConstraint& contact : row.mechanism.contacts) {
    const Vec3 point = Vec3(centerOfMass(row.state, 0)) + contact.centerA.point;
    EXPECT_NEAR(pointAcceleration(0, point, row.state, rate).y(), 0, kMotionRounding);
  }
  EXPECT_NEAR(Vec3(linearVelocity(rate, 0)).norm(), 0.3 * kGravity, 1e-12);  // the coefficient of corner()
}

// A box on a box on the ground hangs together without a loop; a plank on two boxes, or a box between two driven ones,
// does not. Constraints may close a loop wherever there is more than one pair.
TEST(ContactGroups, JoinBodiesWithoutALoop) {
  const std::vector<char> free(4, 0), twoDriven{0, 1, 1, 0};
  const std::vector<std::pair<int, int>> box{{0, kFixed}, {0, kFixed}}, stack{{0, kFixed}, {1, 0}, {0, 1}};
  EXPECT_TRUE(joinWithoutLoop(box, free, false));
  EXPECT_TRUE(joinWithoutLoop(box, free, true));
  EXPECT_TRUE(joinWithoutLoop(stack, free, false));
  EXPECT_FALSE(joinWithoutLoop(stack, free, true));
  EXPECT_FALSE(joinWithoutLoop({{0, kFixed}, {1, kFixed}, {2, 0}, {2, 1}}, free, false));
  EXPECT_TRUE(joinWithoutLoop({{0, 1}, {0, 2}}, free, false));
  EXPECT_FALSE(joinWithoutLoop({{0, 1}, {0, 2}}, twoDriven, false));
  EXPECT_FALSE(joinWithoutLoop(std::vector<std::pair<int, int>>(13, {0, kFixed}), free, false));
}

// A leaning box on a lying one: the normals of the two faces differ, those of each do not. In a corner of one body, or
// turned by more than 1e-9, they do.
TEST(ContactGroups, AreOfFacesWhereNormalsOfEachPairAreParallel) {
  const Vec3 up = Vec3::UnitY(), leaning = Vec3(0.6, 0.8, 0);
  const auto areFaces = [](const std::vector<std::pair<int, int>>& pairs, const std::vector<Vec3>& normals) {
    return areOfFaces(
        pairs.size(), [&](std::size_t i) { return pairs[i]; }, [&](std::size_t i) { return normals[i]; });
  };
  const std::vector<std::pair<int, int>> stack{{-1, 0}, {0, 1}, {-1, 0}, {0, 1}};
  EXPECT_TRUE(areFaces(stack, {up, leaning, up, leaning}));
  EXPECT_TRUE(areFaces(stack, {up, leaning, -up, leaning}));
  EXPECT_FALSE(areFaces(stack, {up, leaning, leaning, leaning}));
  EXPECT_FALSE(areFaces(stack, {up, up, up, Vec3(2e-9, 1, 0)}));
}

}  // namespace
}  // namespace cradle
