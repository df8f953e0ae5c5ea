#include "impact/overlap.h"

#include <gtest/gtest.h>

namespace cradle {
namespace {

RigidBody cube(double mass, double edge) {
  return makeRigidBody({mass, Vec3::Zero(), mass * edge * edge / 6 * Mat3::Identity()});
}

// Two balls that overlap by 0.03 move apart along their line by 0.03 m2/(m1+m2) and 0.03 m1/(m1+m2).
TEST(Overlap, IsResolvedInTheRatioOfInverseMasses) {
  ContactGeometry geometry;
  geometry.colliders = {{0, {Vec3::Zero()}, 0.1, 0.1, {}}, {1, {Vec3::Zero()}, 0.2, 0.2, {}}};
  geometry.pairs = {{0, 1, false, {}}};
  const std::vector<RigidBody> bodies = {cube(1, 0.1), cube(5, 0.1)};
  VectorX state = VectorX::Zero(stateSize(2));
  setOrientation(state, 0, Quat::Identity());
  setOrientation(state, 1, Quat::Identity());
  centerOfMass(state, 1) = 0.27 * Vec3(2, 1, 2) / 3;
  std::vector<Contact> contacts;
  findContacts(geometry, state, 0, contacts);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].separation, -0.03, 1e-15);
  resolveOverlaps(geometry, contacts, bodies, state);
  EXPECT_LT((centerOfMass(state, 0) + 0.03 * 5 / 6 * Vec3(2, 1, 2) / 3).norm(), 1e-15);
  EXPECT_LT((centerOfMass(state, 1) - (0.27 + 0.03 / 6) * Vec3(2, 1, 2) / 3).norm(), 1e-15);
}

TEST(Overlap, WithAPlaneMovesTheBodyAlone) {
  ContactGeometry geometry;
  geometry.colliders = {{0, {Vec3::Zero()}, 0.1, 0.1, {}}};
  geometry.planes = {{Vec3(0, 1, 0), Vec3(0, 1, 0)}};
  geometry.pairs = {{0, 0, true, {}}};
  VectorX state = VectorX::Zero(stateSize(1));
  setOrientation(state, 0, Quat::Identity());
  centerOfMass(state, 0) = Vec3(3, 1.04, 2);
  std::vector<Contact> contacts;
  findContacts(geometry, state, 0, contacts);
  resolveOverlaps(geometry, contacts, std::vector{cube(1, 0.1)}, state);
  EXPECT_LT((centerOfMass(state, 0) - Vec3(3, 1.1, 2)).norm(), 1e-15);
}

// A cube 0.03 m deep in the ground has four corners there, all as deep: one that does not turn comes up by 0.03, not by
// four times as much.
TEST(Overlap, IsTakenOutOnceWhereManyPointsShareIt) {
  ContactGeometry geometry;
  geometry.colliders = {colliderOf(Box{Vec3::Constant(0.2)}, {})};
  geometry.colliders[0].body = 0;
  geometry.planes = {{Vec3::Zero(), Vec3(0, 1, 0)}};
  geometry.pairs = {{0, 0, true, {}}};
  VectorX state = VectorX::Zero(stateSize(1));
  setOrientation(state, 0, Quat::Identity());
  centerOfMass(state, 0) = Vec3(0.5, 0.07, 0.25);
  std::vector<Contact> contacts;
  findContacts(geometry, state, 0, contacts);
  EXPECT_EQ(contacts.size(), 4u);
  RigidBody upright = cube(1, 0.2);
  upright.inverseInertia.setZero();
  resolveOverlaps(geometry, contacts, std::vector{upright}, state);
  EXPECT_LT((centerOfMass(state, 0) - Vec3(0.5, 0.1, 0.25)).norm(), 1e-15);
  EXPECT_LT(orientation(state, 0).vec().norm(), 1e-15);
}

}  // namespace
}  // namespace cradle
