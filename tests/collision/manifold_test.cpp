#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "collision/separation.h"
#include "math/rotation.h"

// What lies or stands on something must be held by contacts that span what it lies on: places, number and curvature of
// the contacts of resting poses, which follow from the sizes.

namespace cradle {
namespace {

struct Placed {
  Collider collider;
  RigidTransform pose;
};

std::vector<Contact> contactsOf(const Placed& a, const Placed& b, double margin = 1e-9) {
  ContactGeometry geometry;
  geometry.colliders = {a.collider, b.collider};
  geometry.pairs = {{0, 1, false, {}}};
  VectorX state = VectorX::Zero(stateSize(2));
  for (int i = 0; i < 2; ++i) {
    geometry.colliders[static_cast<std::size_t>(i)].body = i;
    centerOfMass(state, i) = (i == 0 ? a : b).pose.translation;
    setOrientation(state, i, (i == 0 ? a : b).pose.rotation);
  }
  std::vector<Contact> contacts;
  findContacts(geometry, state, margin, contacts);
  return contacts;
}

/// On the plane y = 0.
std::vector<Contact> contactsOnGround(const Placed& a, double margin = 1e-9) {
  ContactGeometry geometry;
  geometry.colliders = {a.collider};
  geometry.colliders[0].body = 0;
  geometry.planes = {{Vec3::Zero(), Vec3::UnitY()}};
  geometry.pairs = {{0, 0, true, {}}};
  VectorX state = VectorX::Zero(stateSize(1));
  centerOfMass(state, 0) = a.pose.translation;
  setOrientation(state, 0, a.pose.rotation);
  std::vector<Contact> contacts;
  findContacts(geometry, state, margin, contacts);
  return contacts;
}

const RigidTransform kHere{};
const Quat kAlongX = rotationAbout(Vec3::UnitZ(), M_PI / 2);  // turns the axis y to -x
const Quat kAlongZ = rotationAbout(Vec3::UnitX(), M_PI / 2);

RigidTransform at(double x, double y, double z, const Quat& turn = Quat::Identity()) {
  return {turn, Vec3(x, y, z)};
}

Placed floorBox() {
  return {colliderOf(Box{Vec3(4, 1, 4)}, {}), at(0, -0.5, 0)};
}

double extent(const std::vector<Contact>& contacts, const Vec3& direction) {
  double least = INFINITY, most = -INFINITY;
  for (const Contact& contact : contacts) {
    least = std::min(least, direction.dot(contact.point));
    most = std::max(most, direction.dot(contact.point));
  }
  return most - least;
}

/// All touch, with the normal up from the first body, and those radii.
void expectTouching(const std::vector<Contact>& contacts, std::size_t count, const Vec3& normal, double radiusA,
                    double radiusB) {
  const auto isSame = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  EXPECT_EQ(contacts.size(), count);
  for (const Contact& contact : contacts) {
    EXPECT_NEAR(contact.separation, 0, 1e-14);
    EXPECT_LT((contact.normal - normal).norm(), 1e-14);
    EXPECT_NEAR(contact.point.y(), 0, 1e-14);
    EXPECT_TRUE(isSame(contact.radiusA, radiusA)) << contact.radiusA;
    EXPECT_TRUE(isSame(contact.radiusB, radiusB)) << contact.radiusB;
  }
}

TEST(Manifold, OfAStandingCylinderSpansItsRim) {
  const Placed standing{colliderOf(Cylinder{0.5, 2}, {}), at(0.3, 1, 0.2)};
  for (const bool onPlane : {true, false}) {
    const auto contacts = onPlane ? contactsOnGround(standing) : contactsOf(floorBox(), standing);
    if (onPlane)
      expectTouching(contacts, 8, -Vec3::UnitY(), 0, INFINITY);
    else
      expectTouching(contacts, 8, Vec3::UnitY(), INFINITY, 0);
    // Eight points of a circle of diameter 1 are nowhere narrower than cos(pi/8).
    for (int i = 0; i < 16; ++i)
      EXPECT_GT(extent(contacts, Vec3(std::cos(i * M_PI / 16), 0, std::sin(i * M_PI / 16))),
                std::cos(M_PI / 8) - 1e-12);
  }
}

TEST(Manifold, OfACylinderOnItsEdgeIsItsLowestPoint) {
  const double tilt = 0.3, radius = 0.5, half = 1;
  const double height = half * std::cos(tilt) + radius * std::sin(tilt);
  const Placed tilted{colliderOf(Cylinder{radius, 2 * half}, {}), at(0, height, 0, rotationAbout(Vec3::UnitZ(), tilt))};
  for (const bool onPlane : {true, false}) {
    const auto contacts = onPlane ? contactsOnGround(tilted) : contactsOf(tilted, floorBox());
    expectTouching(contacts, 1, -Vec3::UnitY(), NAN, INFINITY);
    EXPECT_NEAR(contacts[0].point.x(), half * std::sin(tilt) - radius * std::cos(tilt), 1e-14);
  }
}

TEST(Manifold, OfWhatLiesIsTheEndsOfItsLine) {
  for (const bool isCapsule : {true, false}) {
    const Collider collider = isCapsule ? colliderOf(Capsule{0.5, 2}, {}) : colliderOf(Cylinder{0.5, 2}, {});
    const Placed lying{collider, at(0.3, 0.5, 0.2, kAlongX)};
    expectTouching(contactsOnGround(lying), 2, -Vec3::UnitY(), 0.5, INFINITY);
    EXPECT_NEAR(extent(contactsOnGround(lying), Vec3::UnitX()), 2, 1e-14);
    expectTouching(contactsOf(lying, floorBox()), 2, -Vec3::UnitY(), 0.5, INFINITY);
    EXPECT_NEAR(extent(contactsOf(lying, floorBox()), Vec3::UnitX()), 2, 1e-14);
    // Half of it over the edge of the box, at x = 2.
    const Placed overhanging{collider, at(2, 0.5, 0, kAlongX)};
    expectTouching(contactsOf(floorBox(), overhanging), 2, Vec3::UnitY(), INFINITY, 0.5);
    EXPECT_NEAR(extent(contactsOf(floorBox(), overhanging), Vec3::UnitX()), 1, 1e-14);
  }
}

TEST(Manifold, OfParallelSidesIsTheEndsOfWhatTheyShare) {
  const Collider log = colliderOf(Cylinder{0.5, 2}, {}), sausage = colliderOf(Capsule{0.5, 2}, {});
  for (const Collider& below : {log, sausage})
    for (const Collider& above : {log, sausage}) {
      const auto contacts = contactsOf({below, at(0, -0.5, 0, kAlongX)}, {above, at(0.7, 0.5, 0, kAlongX)});
      expectTouching(contacts, 2, Vec3::UnitY(), NAN, NAN);
      EXPECT_NEAR(extent(contacts, Vec3::UnitX()), 1.3, 1e-14);
    }
}

TEST(Manifold, OfCrossingSidesIsOnePoint) {
  const Collider log = colliderOf(Cylinder{0.5, 2}, {}), sausage = colliderOf(Capsule{0.5, 2}, {});
  for (const Collider& below : {log, sausage})
    for (const Collider& above : {log, sausage}) {
      const auto contacts = contactsOf({below, at(0, -0.5, 0, kAlongX)}, {above, at(0.3, 0.5, 0.2, kAlongZ)});
      expectTouching(contacts, 1, Vec3::UnitY(), NAN, NAN);
      EXPECT_LT((contacts[0].point - Vec3(0.3, 0, 0)).norm(), 1e-14);
    }
}

// A cylinder that overhangs the edge of a box, at x = 2, and dips there by so little that the box's face carries it:
// the edge is what it touches, and not the face beside that, where there is none.
TEST(Manifold, OfACylinderOverAnEdgeIsWhereItCrossesTheEdge) {
  const Collider log = colliderOf(Cylinder{0.5, 2}, {});
  for (const double dip : {1e-9, 1e-8, 5e-8}) {
    const Quat dipped = rotationAbout(Vec3::UnitZ(), -dip) * kAlongX;
    const Placed overhanging{log, at(2 + 0.5 * std::sin(dip), 0.5 * std::cos(dip), 0, dipped)};
    for (const double margin : {0.0, 1e-12}) {
      const auto contacts = contactsOf(floorBox(), overhanging, margin + 1e-14);
      ASSERT_EQ(contacts.size(), 1u) << dip;
      EXPECT_NEAR(contacts[0].separation, 0, 1e-14) << dip;
      EXPECT_LT((contacts[0].point - Vec3(2, 0, 0)).norm(), 1e-12) << dip;
    }
  }
}

// A cylinder beside the edge of a box, along it: nothing of it is over the face, though that sees hardly less of a gap.
TEST(Manifold, OfACylinderBesideAnEdgeIsItsLineOnTheEdge) {
  const Collider log = colliderOf(Cylinder{0.5, 2}, {});
  for (const double angle : {1e-6, 1e-5, 1e-4}) {
    const Vec3 outward(std::sin(angle), std::cos(angle), 0);
    const Placed beside{log, at(2 + 0.5 * outward.x(), 0.5 * outward.y(), 0, kAlongZ)};
    const auto contacts = contactsOf(floorBox(), beside);
    ASSERT_EQ(contacts.size(), 2u) << angle;
    for (const Contact& contact : contacts) {
      EXPECT_NEAR(contact.separation, 0, 1e-14) << angle;
      EXPECT_LT((contact.normal - outward).norm(), 1e-7) << angle;
      EXPECT_LT((contact.point - Vec3(2, 0, contact.point.z())).norm(), 1e-12) << angle;
    }
    EXPECT_NEAR(extent(contacts, Vec3::UnitZ()), 2, 1e-12);
  }
}

TEST(Manifold, OfStackedCylindersSpansTheSmallerEnd) {
  const Placed below{colliderOf(Cylinder{1, 2}, {}), at(0, -1, 0)};
  const auto contacts = contactsOf(below, {colliderOf(Cylinder{0.4, 2}, {}), at(0.2, 1, 0)});
  expectTouching(contacts, 8, Vec3::UnitY(), INFINITY, 0);
  EXPECT_GT(extent(contacts, Vec3::UnitX()), 0.8 * std::cos(M_PI / 8));
  // Half beside it: what is over the lower end remains.
  const auto beside = contactsOf(below, {colliderOf(Cylinder{0.4, 2}, {}), at(1, 1, 0)});
  EXPECT_GE(beside.size(), 3u);
  for (const Contact& contact : beside) EXPECT_LT(contact.point.norm(), 1.02);
}

TEST(Manifold, OfABoxOnACylinderIsTheLineOrTheEnd) {
  const Collider box = colliderOf(Box{Vec3(1, 1, 1)}, {});
  const auto onSide = contactsOf({colliderOf(Cylinder{0.5, 3}, {}), at(0, -0.5, 0, kAlongX)}, {box, at(0.2, 0.5, 0.1)});
  expectTouching(onSide, 2, Vec3::UnitY(), 0.5, INFINITY);
  EXPECT_NEAR(extent(onSide, Vec3::UnitX()), 1, 1e-14);
  const auto onEnd = contactsOf({colliderOf(Cylinder{2, 3}, {}), at(0, -1.5, 0)}, {box, at(0.2, 0.5, 0.1)});
  expectTouching(onEnd, 4, Vec3::UnitY(), INFINITY, 0);
}

// A can that is partly beyond a table's edge, and a box partly beyond a can's rim: the same places in either order.
TEST(Manifold, OfADiscOnAFaceIsTheSameInEitherOrder) {
  const Placed table{colliderOf(Box{Vec3(2, 1, 2)}, {}), at(0, -0.5, 0)};
  for (const double radius : {0.3, 0.9, 5.0})
    for (const double beyond : {0.0, 0.2}) {
      const Placed can{colliderOf(Cylinder{radius, 1}, {}), at(beyond + std::max(0.0, 1 - radius), 0.5, 0.1)};
      std::vector<Contact> one = contactsOf(table, can), other = contactsOf(can, table);
      ASSERT_EQ(one.size(), other.size()) << radius;
      for (const Contact& contact : one)
        EXPECT_TRUE(std::any_of(other.begin(), other.end(), [&](const Contact& same) {
          return (same.point - contact.point).norm() < 1e-14 && same.normal == -contact.normal &&
                 same.radiusA == contact.radiusB && same.radiusB == contact.radiusA;
        })) << radius;
    }
}

// A tilted cylinder whose lowest point is beyond the edge: its bottom touches the edge where the rim crosses that, at
// z = sqrt(r^2 - d^2), d the distance of the axis from the edge. The plane of the floor sees an overlap beside it.
TEST(Manifold, OfARimAtAnEdgeIsWhereTheyCross) {
  const double radius = 0.5, half = 0.4, distance = 0.3;
  const Vec3 axis = Vec3::UnitY().cross(Vec3(0.8, 0, 0.6));  // the bottom is lowest towards (0.8, 0, 0.6)
  const Vec3 crossing(distance, -half, std::sqrt(radius * radius - distance * distance));
  for (const double tilt : {4e-7, 1e-6, 1e-5}) {
    const Quat turn = rotationAbout(axis, tilt);
    const Vec3 lowest = turn * crossing;  // of what is over the floor
    const Placed can{colliderOf(Cylinder{radius, 2 * half}, {}), {turn, Vec3(2 - lowest.x(), -lowest.y(), 0)}};
    const std::vector<Contact> contacts = contactsOf(floorBox(), can, 1e-10);
    ASSERT_EQ(contacts.size(), 1u) << tilt;
    EXPECT_NEAR(contacts[0].separation, 0, 1e-13) << tilt;
    EXPECT_LT((contacts[0].point - Vec3(2, 0, lowest.z())).norm(), 1e-6) << tilt;
  }
}

TEST(Manifold, OfAHullOnItsFaceIsThatFace) {
  std::vector<Vec3> points;  // a tetrahedron on its base
  for (int i = 0; i < 3; ++i) points.emplace_back(std::cos(i * 2 * M_PI / 3), 0, std::sin(i * 2 * M_PI / 3));
  points.emplace_back(0, 1, 0);
  const Placed stone{colliderOf(convexHullOf(points), {}), kHere};
  expectTouching(contactsOf(floorBox(), stone), 3, Vec3::UnitY(), INFINITY, 0);
  expectTouching(contactsOnGround(stone), 3, -Vec3::UnitY(), 0, INFINITY);
}

TEST(Manifold, OfAFaceWithManyCornersHasNoMoreThanEight) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i)
    for (const double y : {0.0, 1.0}) points.emplace_back(std::cos(i * M_PI / 20), y, std::sin(i * M_PI / 20));
  const Placed drum{colliderOf(convexHullOf(points), {}), kHere};
  for (const auto& contacts : {contactsOnGround(drum), contactsOf(drum, floorBox())}) {
    EXPECT_EQ(contacts.size(), 8u);
    for (int i = 0; i < 16; ++i)
      EXPECT_GT(extent(contacts, Vec3(std::cos(i * M_PI / 16), 0, std::sin(i * M_PI / 16))), 1.7);
  }
}

TEST(Manifold, KnowsTheCurvatureOfBalls) {
  const Placed ball{colliderOf(Sphere{0.5}, {}), at(0, 0.5, 0)};
  expectTouching(contactsOnGround(ball), 1, -Vec3::UnitY(), 0.5, INFINITY);
  expectTouching(contactsOf(ball, floorBox()), 1, -Vec3::UnitY(), 0.5, INFINITY);
  expectTouching(contactsOf({colliderOf(Sphere{2}, {}), at(0, -2, 0)}, ball), 1, Vec3::UnitY(), 2, 0.5);
  expectTouching(contactsOf({colliderOf(Cylinder{1, 2}, {}), at(0, -1, 0)}, ball), 1, Vec3::UnitY(), INFINITY, 0.5);
  expectTouching(contactsOf({colliderOf(Capsule{1, 2}, {}), at(0, -2, 0)}, ball), 1, Vec3::UnitY(), 1, 0.5);
  expectTouching(contactsOf({colliderOf(Capsule{1, 2}, {}), at(0, -1, 0, kAlongX)}, ball), 1, Vec3::UnitY(), NAN, 0.5);
  // On the box's edge.
  expectTouching(contactsOf({floorBox().collider, at(-2, -0.5, 0)}, {ball.collider, at(0, 0.5, 0)}), 1, Vec3::UnitY(),
                 INFINITY, 0.5);
}

}  // namespace
}  // namespace cradle
