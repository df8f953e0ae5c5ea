#include <gtest/gtest.h>

#include <cmath>

#include "impact/contact_impulse.h"
#include "impact/lasting_contact.h"

namespace cradle {
namespace {

RigidBody cube(double mass, double edge) {
  return makeRigidBody({mass, Vec3::Zero(), mass * edge * edge / 6 * Mat3::Identity()});
}

/// A cube of edge 1 on a floor at y = 0, with a contact at each lower corner.
std::vector<LastingContact> cornersOf(double friction) {
  std::vector<LastingContact> contacts;
  for (const double x : {-0.5, 0.5})
    for (const double z : {-0.5, 0.5})
      contacts.push_back({{0, 0, kFixed, Vec3(x, 0, z), -Vec3::UnitY(), 0}, friction, Vec3::Zero()});
  return contacts;
}

VectorX cubeState(const Vec3& velocity) {
  VectorX state = VectorX::Zero(stateSize(1));
  setOrientation(state, 0, Quat::Identity());
  centerOfMass(state, 0).y() = 0.5;
  linearVelocity(state, 0) = velocity;
  return state;
}

// Gauss-Seidel ends when a sweep changes less than 1e-12 of the largest change; corners that trade load converge
// slowly, so that the error left is up to some hundred times that: 1e-10 of the speeds of 0.01 m/s here, and of 1 m/s
// below.
constexpr double kSweepError = 1e-9;

TEST(LastingContact, HoldsACubeThatGravityPulledForAStep) {
  VectorX state = cubeState(Vec3(0, -0.01, 0));
  auto contacts = cornersOf(0.5);
  solveLastingContacts(contacts, std::vector{cube(3, 1)}, state);
  EXPECT_LT(linearVelocity(state, 0).norm(), 0.01 * kSweepError);
  EXPECT_LT(angularVelocity(state, 0).norm(), 0.01 * kSweepError);
  double held = 0;
  for (const LastingContact& contact : contacts) held -= contact.impulse.y();
  EXPECT_NEAR(held, 3 * 0.01, 0.03 * kSweepError);
}

// Coulomb: below mu g h the cube stops, above it loses mu g h, whatever corner carries how much.
TEST(LastingContact, FrictionStopsOrSlowsByItsLimit) {
  const double fall = 0.01, friction = 0.5;
  for (const double speed : {0.004, 0.0051, 1.0}) {
    VectorX state = cubeState(Vec3(speed, -fall, 0));
    auto contacts = cornersOf(friction);
    solveLastingContacts(contacts, std::vector{cube(3, 1)}, state);
    EXPECT_NEAR(linearVelocity(state, 0).x(), std::max(0.0, speed - friction * fall), kSweepError) << speed;
    EXPECT_NEAR(linearVelocity(state, 0).y(), 0, kSweepError);
  }
}

TEST(LastingContact, LetsGoWhatSeparates) {
  VectorX state = cubeState(Vec3(0.3, 0.1, 0));
  const VectorX before = state;
  auto contacts = cornersOf(1);
  solveLastingContacts(contacts, std::vector{cube(3, 1)}, state);
  EXPECT_EQ(state, before);
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

}  // namespace
}  // namespace cradle
