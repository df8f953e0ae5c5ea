#include "collision/round_on_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/expected_contacts.h"
#include "collision/random_poses.h"
#include "mesh/sample_meshes.h"

namespace cradle {
namespace {

std::vector<ContactPoint> contactsOf(const RoundSolid& round, const MeshSurface& mesh, double margin) {
  std::vector<ContactPoint> contacts;
  appendContacts(round, mesh, margin, contacts);
  return contacts;
}

TEST(RoundOnMesh, BallRollingOverADividedSquareSeesNothing) {
  const MeshSurface table = surfaceOf(boxMesh(Vec3(2, 0.5, 2)));
  for (double x = -0.9; x < 0.9; x += 0.01)
    for (const double z : {0.3, x, -x, x + 1e-13, -x - 1e-10}) {
      const RoundSolid ball{{Vec3(x, 0.25 + 0.1 + 1e-4, z), Vec3::Zero()}, 0.1};
      const auto contacts = contactsOf(ball, table, 1e-3);
      ASSERT_EQ(contacts.size(), 1u) << x << " " << z;
      EXPECT_NEAR(contacts[0].separation, 1e-4, kContactRounding);
      EXPECT_LT((contacts[0].normal + Vec3::UnitY()).norm(), kContactRounding);
      EXPECT_EQ(contacts[0].radiusA, 0.1);
      EXPECT_EQ(contacts[0].radiusB, kFlat);
    }
}

TEST(RoundOnMesh, BallInAGrooveTouchesBothSidesAndOverARidgeItsEdge) {
  const MeshSurface prism = surfaceOf(lPrismMesh());
  const RoundSolid inCorner{{Vec3(1.3, 1.3, 0.5), Vec3::Zero()}, 0.3};
  const auto both = contactsOf(inCorner, prism, 1e-9);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_TRUE(holdsPoint(both, Vec3(1, 1.3, 0.5), kContactRounding));
  EXPECT_TRUE(holdsPoint(both, Vec3(1.3, 1, 0.5), kContactRounding));

  const Vec3 out = Vec3(1, 1, 0).normalized();
  const RoundSolid overEdge{{Vec3(3, 1, 0.4) + 0.3 * out, Vec3::Zero()}, 0.3};
  const auto edge = contactsOf(overEdge, prism, 1e-9);
  ASSERT_EQ(edge.size(), 1u);
  EXPECT_LT((edge[0].point - Vec3(3, 1, 0.4)).norm(), kContactRounding);
  EXPECT_LT((edge[0].normal + out).norm(), kContactRounding);
  EXPECT_TRUE(std::isnan(edge[0].radiusB));

  const Vec3 diagonal = Vec3(1, 1, -1).normalized();
  const auto corner = contactsOf({{Vec3(3, 1, 0) + 0.2 * diagonal, Vec3::Zero()}, 0.3}, prism, 1e-9);
  ASSERT_EQ(corner.size(), 1u);
  EXPECT_NEAR(corner[0].separation, -0.1, kContactRounding);
  EXPECT_EQ(corner[0].radiusB, 0);
}

TEST(RoundOnMesh, CapsuleThatLiesTouchesAtBothEnds) {
  const MeshSurface table = surfaceOf(boxMesh(Vec3(2, 0.5, 2)));
  const auto contacts = contactsOf({{Vec3(-0.4, 0.35, 0.1), Vec3(0.7, 0, 0.3)}, 0.1}, table, 1e-9);
  ASSERT_EQ(contacts.size(), 2u);
  expectAllAlong(contacts, -Vec3::UnitY(), 0);
  EXPECT_TRUE(holdsPoint(contacts, Vec3(-0.4, 0.25, 0.1), kContactRounding));
  EXPECT_TRUE(holdsPoint(contacts, Vec3(0.3, 0.25, 0.4), kContactRounding));
  // Beyond the rim it is the rim that touches.
  const auto over = contactsOf({{Vec3(0.4, 0.35, 0.1), Vec3(2, 0, 0)}, 0.1}, table, 1e-9);
  ASSERT_EQ(over.size(), 2u);
  EXPECT_TRUE(holdsPoint(over, Vec3(1, 0.25, 0.1), kContactRounding));
}

// Both ends outside, 1 cm beneath an edge in between: that is what it takes to bring it out.
TEST(RoundOnMesh, CoreThatPassesBeneathAnEdgeIsAsDeepAsThat) {
  const MeshSurface cube = surfaceOf(boxMesh(Vec3::Ones()));
  const Vec3 out = Vec3(1, 1, 0).normalized(), along(1, -1, 0.3);
  const RoundSolid capsule{{Vec3(0.5, 0.5, 0.1) - 0.01 * out - along / 2, along}, 0.002};
  EXPECT_NEAR(separationOf(capsule, cube, INFINITY), -0.012, kContactRounding);
  const auto contacts = contactsOf(capsule, cube, 0);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].separation, -0.012, kContactRounding);
  EXPECT_LT((contacts[0].normal + out).norm(), 10 * kContactRounding);
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
      EXPECT_LE(found, least - 0.2 + kContactRounding);
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
