#include "collision/mesh_contact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "collision/expected_contacts.h"
#include "collision/mesh_gap.h"
#include "collision/random_poses.h"
#include "mesh/load_mesh.h"
#include "mesh/sample_meshes.h"

namespace cradle {
namespace {

std::vector<ContactPoint> contactsOf(const MeshSurface& a, const MeshSurface& b, const RigidTransform& aFromB,
                                     double margin) {
  std::vector<ContactPoint> contacts;
  FeatureNeighbourList none;
  appendContacts(MeshPair(a, b, aFromB), none, margin, contacts);
  return contacts;
}

RigidTransform shifted(double x, double y, double z) {
  return {Quat::Identity(), Vec3(x, y, z)};
}

TEST(MeshContact, CubesStackedExactlyTouchAtTheirFourCorners) {
  const MeshSurface cube = surfaceOf(boxMesh(Vec3::Ones()));
  for (const double gap : {0.0, 1e-13, -1e-13, 1e-10, -1e-10, 1e-4, -1e-4}) {
    const auto contacts = contactsOf(cube, cube, shifted(0, 1 + gap, 0), 1e-3);
    EXPECT_EQ(contacts.size(), 4u) << gap;
    expectAllAlong(contacts, Vec3::UnitY(), gap);
    for (const double x : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5}) EXPECT_TRUE(holdsPoint(contacts, Vec3(x, 0.5 + gap / 2, z), kContactRounding));
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
    EXPECT_NEAR(contact.separation, 0, kContactRounding);
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
    FeatureNeighbourList near;
    for (int k = 0; k < 200; ++k)
      pose.translation += (gapBetween(MeshPair(prism, box, pose), near, 10).separation - 1e-10) * way;
    const MeshGap gap = gapBetween(MeshPair(prism, box, pose), near, 10);
    const auto contacts = contactsOf(prism, box, pose, 1e-6);
    ASSERT_EQ(contacts.size(), 1u) << i;
    EXPECT_NEAR(contacts[0].separation, gap.separation, kContactRounding);
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

}  // namespace
}  // namespace cradle
