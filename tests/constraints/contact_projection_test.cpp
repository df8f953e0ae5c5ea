#include <gtest/gtest.h>

#include <cmath>

#include "constraints/bodies_on_ground.h"

// Newton's method on gaps and constraints: ContactSolver::project.

namespace cradle {
namespace {

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

// Bodies without a contact are moved too, where their rods ask for it; the error is the largest of all.
TEST(ContactProjection, RestoresRodsOfBodiesWithoutContacts) {
  Mechanism mechanism = onEarth({solidSphere(1, 0.2), solidSphere(2, 0.3)});
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.2, {}, Vec3::UnitY(), kFrictionless)};
  mechanism.constraints = {{{1, Vec3::Zero()}, {kFixed, Vec3(5, 3, 0)}, RodConstraint{1}}};
  VectorX state = restingState(2);
  centerOfMass(state, 0).y() = 0.2 + 1e-4, centerOfMass(state, 1) = Vec3(5, 4.01, 0);
  linearVelocity(state, 1) = Vec3(1, 2, 0);
  EquationsOfMotion equations(mechanism);
  EXPECT_NEAR(equations.project(state), 0.01 + 0.01 * 0.01 / 2, 1e-14);  // C / scale of the rod
  EXPECT_NEAR(centerOfMass(state, 0).y(), 0.2, 1e-16);
  EXPECT_NEAR(centerOfMass(state, 1).y(), 4, 1e-15);
  EXPECT_LT((Vec3(linearVelocity(state, 1)) - Vec3(1, 0, 0)).norm(), 1e-15);
}

// Two rods of different lengths between the same points contradict each other: the body stays finite, and what a step
// of Newton's made worse is undone, so that projecting again changes nothing.
TEST(ContactProjection, LeavesContradictionsAsTheyAre) {
  for (const double longer : {1e-6, 1e-2}) {
    Mechanism mechanism = onEarth({lopsided(1)});
    mechanism.contacts = {corner(0, Vec3(0.1, -0.2, 0.1), kFrictionless)};
    for (const double length : {1.0, 1 + longer})
      mechanism.constraints.push_back({{0, Vec3(0, 0.2, 0.1)}, {kFixed, Vec3(0.6, 0.9, 0.5)}, RodConstraint{length}});
    VectorX state = restingState(1);
    centerOfMass(state, 0) = Vec3(0, 0.21, 0.02);
    EquationsOfMotion equations(mechanism);
    const double found = equations.project(state);
    ASSERT_TRUE(state.allFinite());
    const VectorX once = state;
    const double left = equations.project(state);
    EXPECT_LE(left, found);
    EXPECT_GT(left, longer / 4);
    EXPECT_LT(largestDifference(state, once), 1e-2 * longer) << longer;
  }
}

}  // namespace
}  // namespace cradle
