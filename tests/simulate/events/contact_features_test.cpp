#include "simulate/events/contact_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/rotation.h"

namespace cradle {
namespace {

using testing::SizeIs;

constexpr double kFace = std::numeric_limits<double>::infinity(), kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding = 1e-15;  // of places and directions of about 1

/// A fixed box of 2 m, its top y = 0, its edge of x = 0 along z; another collider moves.
struct OverEdge {
  ContactGeometry geometry;
  VectorX state = VectorX::Zero(stateSize(1));

  OverEdge(Collider moving, const Vec3& position, const Quat& turn) {
    moving.body = 0;
    Collider table = colliderOf(Box{Vec3(2, 2, 2)}, RigidTransform{Quat::Identity(), Vec3(-1, -1, 0)});
    geometry.colliders = {moving, table};
    geometry.pairs = {{0, 1, false, {}}};
    centerOfMass(state, 0) = position;
    setOrientation(state, 0, turn);
  }

  std::vector<Contact> told(const Vec3& point, const Vec3& normal, double radiusA, double radiusB) const {
    std::vector<Contact> contacts(1);
    contacts[0].bodyA = 0, contacts[0].point = point, contacts[0].normal = normal;
    contacts[0].radiusA = radiusA, contacts[0].radiusB = radiusB;
    findFeatures(geometry, state, 1e-12, contacts);
    return contacts;
  }
};

const Quat kAlongX = rotationAbout(Vec3::UnitZ(), -M_PI / 2), kAlongZ = rotationAbout(Vec3::UnitX(), M_PI / 2);
Collider capsule(double radius, double length) {
  return colliderOf(Capsule{radius, length}, RigidTransform{});
}
Collider cylinder(double radius, double length) {
  return colliderOf(Cylinder{radius, length}, RigidTransform{});
}

// A ball 1 nm from the edge, 30 degrees out from upright: the edge has no radius, and the normal points to it.
TEST(ContactFeatures, OfABallOnAnEdgeAreASphereAndALine) {
  const Vec3 out(0.5, std::sqrt(0.75), 0);
  const OverEdge at(colliderOf(Sphere{0.3}, RigidTransform{}), (0.3 + 1e-9) * out + Vec3(0, 0, 0.4), Quat::Identity());
  const std::vector<Contact> found = at.told(5e-10 * out + Vec3(0, 0, 0.4), -out, 0.3, kUnknown);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].radiusA, 0.3);
  EXPECT_EQ(found[0].radiusB, 0);
  EXPECT_TRUE(found[0].lineA.isZero(0));
  EXPECT_LT(found[0].lineB.cross(Vec3::UnitZ()).norm(), kRounding);
  EXPECT_NEAR(found[0].separation, 1e-9, kRounding);
  EXPECT_LT((found[0].normal + out).norm(), kRounding);
}

// A capsule and a cylinder across the edge, level: both lines, and the place where they cross though the contact was
// found 1e-9 m aside. Edges of the box that rise from there are none of it.
TEST(ContactFeatures, OfASideAcrossAnEdgeAreTwoLines) {
  for (const Collider& bar : {capsule(0.05, 1), cylinder(0.05, 1)}) {
    const OverEdge at(bar, Vec3(0.1, 0.05, 0.2), kAlongX);
    const std::vector<Contact> found = at.told(Vec3(1e-9, 0, 0.2), -Vec3::UnitY(), kUnknown, kFace);
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_EQ(found[0].radiusA, 0.05);
    EXPECT_EQ(found[0].radiusB, 0);
    EXPECT_LT(found[0].lineA.cross(Vec3::UnitX()).norm(), kRounding);
    EXPECT_LT(found[0].lineB.cross(Vec3::UnitZ()).norm(), kRounding);
    EXPECT_LT((found[0].point - Vec3(0, 0, 0.2)).norm(), kRounding);
    EXPECT_NEAR(found[0].separation, 0, kRounding);
  }
}

// Along the edge a bar of 1 m touches by its own ends, one of 4 m by those of the edge, which are corners.
TEST(ContactFeatures, OfASideAlongAnEdgeAreTheEndsOfWhatTheyShare) {
  for (const double length : {1.0, 4.0})
    for (const Collider& bar : {capsule(0.05, length), cylinder(0.05, length)}) {
      const OverEdge at(bar, Vec3(0.03, 0.04, 0), kAlongZ);
      const std::vector<Contact> found = at.told(Vec3(0, 0, 0.1), Vec3(-0.6, -0.8, 0), kUnknown, kUnknown);
      ASSERT_THAT(found, SizeIs(2));
      double sum = 0;
      for (const Contact& contact : found) {
        EXPECT_EQ(contact.radiusA, 0.05);
        EXPECT_EQ(contact.radiusB, 0);
        EXPECT_EQ(contact.lineA.isZero(0), length < 2);
        EXPECT_EQ(contact.lineB.isZero(0), length > 2);
        EXPECT_NEAR(std::abs(contact.point.z()), std::min(length, 2.0) / 2, kRounding);
        EXPECT_NEAR(contact.separation, 0, kRounding);
        sum += contact.point.z();
      }
      EXPECT_NEAR(sum, 0, kRounding);
    }
}

// A square of 0.2 m, turned by 45 degrees, lies flat with a corner over the edge: a corner short of it is on the face;
// beyond it by more than a touch, its two edges cross the table's, and one that is 1e-9 m away from the corner is
// still told from it. Edges that run along the table's are no corner of what touches.
TEST(ContactFeatures, OfFlatFacesAreCornersOnFacesAndEdgesThatCross) {
  const Collider box = colliderOf(Box{Vec3(0.2, 0.1, 0.2)}, RigidTransform{});
  const double reach = 0.1 * std::sqrt(2);
  const Quat turn = rotationAbout(Vec3::UnitY(), M_PI / 4);
  const OverEdge before(box, Vec3(-reach - 1e-6, 0.05, 0), turn);
  const std::vector<Contact> corner = before.told(Vec3(-1e-6, 0, 0), -Vec3::UnitY(), 0, kFace);
  ASSERT_THAT(corner, SizeIs(1));
  EXPECT_TRUE(corner[0].radiusA == 0 && std::isinf(corner[0].radiusB) && corner[0].lineA.isZero(0));
  const OverEdge after(box, Vec3(-reach + 1e-9, 0.05, 0), turn);
  for (const double side : {-1, 1}) {
    const std::vector<Contact> crossing = after.told(Vec3(0, 0, side * 1e-9), -Vec3::UnitY(), 0, kFace);
    ASSERT_THAT(crossing, SizeIs(1));
    EXPECT_LT((crossing[0].lineA.cross(crossing[0].lineB).cwiseAbs() - std::sqrt(0.5) * Vec3::UnitY()).norm(), 1e-15);
    EXPECT_LT((crossing[0].point - Vec3(0, 0, side * 1e-9)).norm(), kRounding);
  }
  const OverEdge along(box, Vec3(-0.1, 0.05, 0), Quat::Identity());
  EXPECT_THAT(along.told(Vec3(0, 0, 0.03), -Vec3::UnitY(), 0, kFace), SizeIs(0));
}

// A corner of a tilted box on the edge itself is on no face: the edges that meet there are what crosses it, if they lie
// in the plane of contact; here they rise by 45 degrees, and nothing lasts.
TEST(ContactFeatures, OfACornerOnAnEdgeAreNone) {
  const Collider box = colliderOf(Box{Vec3(0.2, 0.2, 0.2)}, RigidTransform{});
  const Quat onCorner = Quat::FromTwoVectors(Vec3(1, 1, 1), Vec3::UnitY());
  const OverEdge at(box, Vec3(0, 0.1 * std::sqrt(3), 0), onCorner);
  const std::vector<Contact> found = at.told(Vec3::Zero(), Vec3(-0.6, -0.8, 0).normalized(), 0, kUnknown);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_TRUE(found[0].lineA.isZero(0) && found[0].lineB.isZero(0));
}

}  // namespace
}  // namespace cradle
