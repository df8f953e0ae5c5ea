#include "collision/mesh_contact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "collision/mesh_gap.h"
#include "collision/random_poses.h"
#include "collision/round_on_mesh.h"
#include "mesh/load_mesh.h"
#include "mesh/sample_meshes.h"

namespace cradle {
namespace {

constexpr double kRounding = 1e-14;  // m: some sums and products of lengths of about 1 m

std::vector<ContactPoint> contactsOf(const MeshSurface& a, const MeshSurface& b, const RigidTransform& aFromB,
                                     double margin) {
  std::vector<ContactPoint> contacts;
  appendContacts(MeshPair(a, b, aFromB), margin, contacts);
  return contacts;
}

std::vector<ContactPoint> contactsOf(const RoundSolid& round, const MeshSurface& mesh, double margin) {
  std::vector<ContactPoint> contacts;
  appendContacts(round, mesh, margin, contacts);
  return contacts;
}

RigidTransform shifted(double x, double y, double z) {
  return {Quat::Identity(), Vec3(x, y, z)};
}

bool holdsPoint(const std::vector<ContactPoint>& contacts, const Vec3& point, double tolerance) {
  return std::any_of(contacts.begin(), contacts.end(),
                     [&](const ContactPoint& contact) { return (contact.point - point).norm() < tolerance; });
}

void expectAllAlong(const std::vector<ContactPoint>& contacts, const Vec3& normal, double separation,
                    double tolerance = kRounding) {
  for (const ContactPoint& contact : contacts) {
    EXPECT_LT((contact.normal - normal).norm(), 10 * tolerance);
    EXPECT_NEAR(contact.separation, separation, tolerance);
  }
}

TEST(MeshContact, CubesStackedExactlyTouchAtTheirFourCorners) {
  const MeshSurface cube = surfaceOf(boxMesh(Vec3::Ones()));
  for (const double gap : {0.0, 1e-13, -1e-13, 1e-10, -1e-10, 1e-4, -1e-4}) {
    const auto contacts = contactsOf(cube, cube, shifted(0, 1 + gap, 0), 1e-3);
    EXPECT_EQ(contacts.size(), 4u) << gap;
    expectAllAlong(contacts, Vec3::UnitY(), gap);
    for (const double x : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5}) EXPECT_TRUE(holdsPoint(contacts, Vec3(x, 0.5 + gap / 2, z), kRounding));
  }
}

TEST(MeshContact, CubeOverTheRimOfAnotherTouchesAtTheRimToo) {
  const MeshSurface cube = surfaceOf(boxMesh(Vec3::Ones()));
  for (const double gap : {0.0, 1e-10, -1e-10}) {
    const auto contacts = contactsOf(cube, cube, shifted(0.3, 1 + gap, 0.1), 1e-9);
    EXPECT_EQ(contacts.size(), 4u) << gap;
    expectAllAlong(contacts, Vec3::UnitY(), gap);
    for (const double x : {-0.2, 0.5})
      for (const double z : {-0.4, 0.5}) EXPECT_TRUE(holdsPoint(contacts, Vec3(x, 0.5, z), 1e-9)) << x << " " << z;
  }
}

// An eighth of a turn: the common face is an octagon, of whose blunt corners some may be left out; what is left holds
// the cube's middle from all sides.
TEST(MeshContact, CubeTurnedOnAnotherIsHeldFromAllSides) {
  const MeshSurface cube = surfaceOf(boxMesh(Vec3::Ones()));
  for (double turn = 0.05; turn < 1.6; turn += 0.1) {
    const auto contacts = contactsOf(cube, cube, {rotationAbout(Vec3::UnitY(), turn), Vec3(0, 1, 0)}, 1e-9);
    EXPECT_GE(contacts.size(), 4u);
    EXPECT_LE(contacts.size(), 6u);
    expectAllAlong(contacts, Vec3::UnitY(), 0);
    for (double angle = 0; angle < 6.28; angle += 0.1) {
      double farthest = -1;
      for (const ContactPoint& contact : contacts)
        farthest = std::max(farthest, contact.point.dot(Vec3(std::cos(angle), 0, std::sin(angle))));
      EXPECT_GT(farthest, 0.35) << turn;
    }
  }
}

TEST(MeshContact, ConcaveSolidStandsOnItsFeet) {
  // An L upside down on a table: its two feet are at different heights, unless the table has a step.
  const MeshSurface prism = surfaceOf(lPrismMesh()), table = surfaceOf(boxMesh(Vec3(10, 1, 10)));
  const Quat over = rotationAbout(Vec3::UnitZ(), M_PI);
  const auto contacts = contactsOf(table, prism, {over, Vec3(0, 2.5, 0)}, 1e-9);
  EXPECT_EQ(contacts.size(), 4u);  // the upper square of the L: 1 x 1
  expectAllAlong(contacts, Vec3::UnitY(), 0, 1e-13);
  for (const ContactPoint& contact : contacts) {
    EXPECT_EQ(contact.radiusA, kFlat);
    EXPECT_EQ(contact.radiusB, 0);
  }
}

// In the corner of the L two faces are touched at once.
TEST(MeshContact, CubeInAnInnerCornerTouchesBothWalls) {
  const MeshSurface prism = surfaceOf(lPrismMesh()), cube = surfaceOf(boxMesh(Vec3::Constant(0.5)));
  const auto contacts = contactsOf(prism, cube, shifted(1.25, 1.25, 0.5), 1e-9);
  int up = 0, right = 0;
  for (const ContactPoint& contact : contacts) {
    up += (contact.normal - Vec3::UnitY()).norm() < 1e-12;
    right += (contact.normal - Vec3::UnitX()).norm() < 1e-12;
    EXPECT_NEAR(contact.separation, 0, kRounding);
  }
  EXPECT_EQ(up, 4);
  EXPECT_EQ(right, 4);
  EXPECT_EQ(contacts.size(), 8u);
}

TEST(MeshContact, GearOnATableIsHeldAtItsRim) {
  const MeshSurface gear =
      surfaceOf(loadObjects(CRADLE_SOURCE_DIR "/assets/gear.3ds", 1, ModelParts::solidAlone)[0].model.solid);
  const MeshSurface table = surfaceOf(boxMesh(Vec3(1, 0.1, 1)));
  const double top = -gear.tree.nodes[0].center.y() + gear.tree.nodes[0].halfSize.y();
  for (const double turn : {0.0, 0.01, 0.7}) {
    const auto contacts = contactsOf(table, gear, {rotationAbout(Vec3::UnitY(), turn), Vec3(0, 0.05 + top, 0)}, 1e-9);
    EXPECT_GE(contacts.size(), 6u);
    EXPECT_LE(contacts.size(), 7u);
    expectAllAlong(contacts, Vec3::UnitY(), 0, 1e-10);
    for (const ContactPoint& contact : contacts) EXPECT_GT(contact.point.norm(), 0.12);
  }
}

// Randomly posed solids that just touch: the deepest contact is the gap.
TEST(MeshContact, DeepestContactIsTheGap) {
  RandomPoses random(1);
  const MeshSurface prism = surfaceOf(lPrismMesh()), box = surfaceOf(boxMesh(Vec3(0.5, 1.2, 0.8)));
  for (int i = 0; i < 60; ++i) {
    RigidTransform pose{random.turn(), 5 * random.direction()};
    const Vec3 way = (Vec3(1, 0.5, 0.5) - pose.translation).normalized();
    for (int k = 0; k < 200; ++k)
      pose.translation += (gapBetween(MeshPair(prism, box, pose), 10).separation - 1e-10) * way;
    const MeshGap gap = gapBetween(MeshPair(prism, box, pose), 10);
    const auto contacts = contactsOf(prism, box, pose, 1e-6);
    ASSERT_EQ(contacts.size(), 1u) << i;
    EXPECT_NEAR(contacts[0].separation, gap.separation, kRounding);
    EXPECT_LT((contacts[0].normal - gap.normal).norm(), 1e-12);
    EXPECT_LT((contacts[0].point - (gap.pointA + gap.pointB) / 2).norm(), 1e-9);
  }
}

TEST(MeshContact, SwappedSolidsHaveTheSameContactsTurnedAround) {
  const MeshSurface prism = surfaceOf(lPrismMesh()), box = surfaceOf(boxMesh(Vec3(0.5, 1.2, 0.8)));
  const RigidTransform pose{rotationAbout(Vec3::UnitY(), 0.3), Vec3(2, 1.6, 0.5)};
  const auto contacts = contactsOf(prism, box, pose, 1e-9), swapped = contactsOf(box, prism, pose.inverse(), 1e-9);
  ASSERT_EQ(contacts.size(), swapped.size());
  ASSERT_GE(contacts.size(), 3u);
  for (const ContactPoint& contact : contacts) EXPECT_TRUE(holdsPoint(swapped, pose.inverse() * contact.point, 1e-12));
  for (const ContactPoint& contact : swapped) EXPECT_LT((pose.rotation * contact.normal + Vec3::UnitY()).norm(), 1e-12);
}

TEST(RoundOnMesh, BallRollingOverADividedSquareSeesNothing) {
  const MeshSurface table = surfaceOf(boxMesh(Vec3(2, 0.5, 2)));
  for (double x = -0.9; x < 0.9; x += 0.01)
    for (const double z : {0.3, x, -x, x + 1e-13, -x - 1e-10}) {
      const RoundSolid ball{{Vec3(x, 0.25 + 0.1 + 1e-4, z), Vec3::Zero()}, 0.1};
      const auto contacts = contactsOf(ball, table, 1e-3);
      ASSERT_EQ(contacts.size(), 1u) << x << " " << z;
      EXPECT_NEAR(contacts[0].separation, 1e-4, kRounding);
      EXPECT_LT((contacts[0].normal + Vec3::UnitY()).norm(), kRounding);
      EXPECT_EQ(contacts[0].radiusA, 0.1);
      EXPECT_EQ(contacts[0].radiusB, kFlat);
    }
}

TEST(RoundOnMesh, BallInAGrooveTouchesBothSidesAndOverARidgeItsEdge) {
  const MeshSurface prism = surfaceOf(lPrismMesh());
  const RoundSolid inCorner{{Vec3(1.3, 1.3, 0.5), Vec3::Zero()}, 0.3};
  const auto both = contactsOf(inCorner, prism, 1e-9);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_TRUE(holdsPoint(both, Vec3(1, 1.3, 0.5), kRounding));
  EXPECT_TRUE(holdsPoint(both, Vec3(1.3, 1, 0.5), kRounding));

  const Vec3 out = Vec3(1, 1, 0).normalized();
  const RoundSolid overEdge{{Vec3(3, 1, 0.4) + 0.3 * out, Vec3::Zero()}, 0.3};
  const auto edge = contactsOf(overEdge, prism, 1e-9);
  ASSERT_EQ(edge.size(), 1u);
  EXPECT_LT((edge[0].point - Vec3(3, 1, 0.4)).norm(), kRounding);
  EXPECT_LT((edge[0].normal + out).norm(), kRounding);
  EXPECT_TRUE(std::isnan(edge[0].radiusB));

  const Vec3 diagonal = Vec3(1, 1, -1).normalized();
  const auto corner = contactsOf({{Vec3(3, 1, 0) + 0.2 * diagonal, Vec3::Zero()}, 0.3}, prism, 1e-9);
  ASSERT_EQ(corner.size(), 1u);
  EXPECT_NEAR(corner[0].separation, -0.1, kRounding);
  EXPECT_EQ(corner[0].radiusB, 0);
}

TEST(RoundOnMesh, CapsuleThatLiesTouchesAtBothEnds) {
  const MeshSurface table = surfaceOf(boxMesh(Vec3(2, 0.5, 2)));
  const auto contacts = contactsOf({{Vec3(-0.4, 0.35, 0.1), Vec3(0.7, 0, 0.3)}, 0.1}, table, 1e-9);
  ASSERT_EQ(contacts.size(), 2u);
  expectAllAlong(contacts, -Vec3::UnitY(), 0);
  EXPECT_TRUE(holdsPoint(contacts, Vec3(-0.4, 0.25, 0.1), kRounding));
  EXPECT_TRUE(holdsPoint(contacts, Vec3(0.3, 0.25, 0.4), kRounding));
  // Beyond the rim it is the rim that touches.
  const auto over = contactsOf({{Vec3(0.4, 0.35, 0.1), Vec3(2, 0, 0)}, 0.1}, table, 1e-9);
  ASSERT_EQ(over.size(), 2u);
  EXPECT_TRUE(holdsPoint(over, Vec3(1, 0.25, 0.1), kRounding));
}

// Both ends outside, 1 cm beneath an edge in between: that is what it takes to bring it out.
TEST(RoundOnMesh, CoreThatPassesBeneathAnEdgeIsAsDeepAsThat) {
  const MeshSurface cube = surfaceOf(boxMesh(Vec3::Ones()));
  const Vec3 out = Vec3(1, 1, 0).normalized(), along(1, -1, 0.3);
  const RoundSolid capsule{{Vec3(0.5, 0.5, 0.1) - 0.01 * out - along / 2, along}, 0.002};
  EXPECT_NEAR(separationOf(capsule, cube, INFINITY), -0.012, kRounding);
  const auto contacts = contactsOf(capsule, cube, 0);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].separation, -0.012, kRounding);
  EXPECT_LT((contacts[0].normal + out).norm(), 10 * kRounding);
}

// The distance of a segment by that of many points on it.
TEST(RoundOnMesh, SeparationIsTheDistanceOfTheCoreLessTheRadius) {
  RandomPoses random(2);
  const MeshSurface prism = surfaceOf(lPrismMesh());
  for (int i = 0; i < 100; ++i) {
    const RoundSolid capsule{{random.vector(3), random.vector(2)}, 0.2};
    double least = INFINITY;
    const int samples = 2000;
    for (int k = 0; k <= samples; ++k)
      least = std::min(least, heightOver(prism, capsule.core.at(k / double(samples))).height);
    const double found = separationOf(capsule, prism, INFINITY);
    if (least > 0) {
      EXPECT_NEAR(found, least - 0.2, 1e-3);  // half of the samples' distance
      EXPECT_LE(found, least - 0.2 + kRounding);
      const auto contacts = contactsOf(capsule, prism, found + 1e-9);
      ASSERT_GE(contacts.size(), 1u);
      double nearest = INFINITY;
      for (const ContactPoint& contact : contacts) nearest = std::min(nearest, contact.separation);
      EXPECT_NEAR(nearest, found, 1e-12);
    } else {
      EXPECT_LE(found, -0.2);
    }
  }
}

}  // namespace
}  // namespace cradle
