#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "collision/separation.h"
#include "math/rotation.h"

namespace cradle {
namespace {

Polytope boxOf(const Vec3& size) {
  return polytopeOf(Box{size}, {});
}

Collider colliderOfSize(const Vec3& size) {
  return colliderOf(Box{size}, {});
}

/// Two moving colliders in their poses.
struct Pair {
  ContactGeometry geometry;
  VectorX state = VectorX::Zero(stateSize(2));

  Pair(const Collider& a, const Collider& b, const RigidTransform& poseA, const RigidTransform& poseB) {
    geometry.colliders = {a, b};
    geometry.pairs = {{0, 1, false, {}}};
    int body = 0;
    for (const RigidTransform& pose : {poseA, poseB}) {
      geometry.colliders[static_cast<std::size_t>(body)].body = body;
      centerOfMass(state, body) = pose.translation;
      setOrientation(state, body, pose.rotation);
      ++body;
    }
  }
};

double separationOf(const Collider& a, const Collider& b, const RigidTransform& poseA, const RigidTransform& poseB) {
  const Pair pair(a, b, poseA, poseB);
  return separation(pair.geometry, pair.geometry.pairs[0], 0, pair.state);
}

std::vector<Contact> contactsOf(const Collider& a, const Collider& b, const RigidTransform& poseA,
                                const RigidTransform& poseB, double margin) {
  const Pair pair(a, b, poseA, poseB);
  std::vector<Contact> contacts;
  findContacts(pair.geometry, pair.state, margin, contacts);
  return contacts;
}

class Random {
 public:
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  Vec3 vector(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }
  RigidTransform pose(double reach) { return {rotationAbout(vector(1), number(0, 6)), vector(reach)}; }

 private:
  std::mt19937 engine_{5};
};

// The signed distance of a point to a box in closed form: q = |p| - size / 2; outside |max(q, 0)|, inside max(q).
TEST(NearestSurfacePoint, OfABoxIsItsClosedForm) {
  Random random;
  const Vec3 size(1, 0.6, 1.7);
  const RigidTransform place = random.pose(2);
  const Polytope box = polytopeOf(Box{size}, place);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 local = random.vector(1.5), point = place * local;
    const Vec3 q = local.cwiseAbs() - size / 2;
    const double expected = q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
    const SurfacePoint surface = nearestSurfacePoint(box, point);
    EXPECT_NEAR(surface.distance, expected, 1e-14);
    EXPECT_NEAR((surface.nearest - point).norm(), std::abs(expected), 1e-14);
    EXPECT_LT((surface.nearest + surface.distance * surface.normal - point).norm(), 1e-13);
  }
}

TEST(Polytope, OfABoxIsClosedAndWoundOutwards) {
  const Polytope box = boxOf(Vec3(1, 2, 3));
  EXPECT_EQ(box.edges.size(), 12u);
  double volume = 0;
  for (const Polytope::Face& face : box.faces) {
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(face.normal.dot(box.vertices[face.loop[i]]), face.offset, 1e-15);
      const Vec3 along = box.vertices[face.loop[(i + 1) % 4]] - box.vertices[face.loop[i]];
      const Vec3 next = box.vertices[face.loop[(i + 2) % 4]] - box.vertices[face.loop[(i + 1) % 4]];
      EXPECT_GT(along.cross(next).dot(face.normal), 0);
    }
    const Vec3 a = box.vertices[face.loop[1]] - box.vertices[face.loop[0]];
    const Vec3 b = box.vertices[face.loop[3]] - box.vertices[face.loop[0]];
    volume += face.offset * a.cross(b).norm() / 3;
  }
  EXPECT_NEAR(volume, 6, 1e-14);
}

/// Distance of two boxes by alternating projections (von Neumann), which shares nothing with separating axes: each
/// point goes to the nearest point of the other solid until they stop. Slow, and right for convex bodies.
double distanceByProjection(const Vec3& sizeA, const Vec3& sizeB, const RigidTransform& aPose,
                            const RigidTransform& bPose) {
  Vec3 onA = aPose.translation, onB = bPose.translation;
  const auto project = [](const Vec3& point, const Vec3& size, const RigidTransform& pose) {
    const Vec3 local = pose.inverse() * point;
    return Vec3(pose * Vec3(local.cwiseMin(size / 2).cwiseMax(-size / 2)));
  };
  for (int i = 0; i < 20000; ++i) {
    onB = project(onA, sizeB, bPose);
    onA = project(onB, sizeA, aPose);
  }
  return (onA - onB).norm();
}

// The sign is that of the distance, and the separation at most the distance; where a face is nearest they are equal.
TEST(SeparationOfPolytopes, HasTheSignOfTheDistance) {
  Random random;
  const Vec3 sizeA(1, 0.6, 1.4), sizeB(0.5, 1.1, 0.8);
  const Collider a = colliderOfSize(sizeA), b = colliderOfSize(sizeB);
  int apart = 0, overlapping = 0, equal = 0;
  for (int i = 0; i < 300; ++i) {
    const RigidTransform poseA = random.pose(0.6), poseB = random.pose(0.9);
    const double separation = separationOf(a, b, poseA, poseB);
    const double distance = distanceByProjection(sizeA, sizeB, poseA, poseB);
    if (std::abs(separation) < 1e-3) continue;  // projections converge slowly near touching
    EXPECT_EQ(separation > 0, distance > 1e-6) << i << ' ' << separation << ' ' << distance;
    EXPECT_LE(separation, distance + 1e-9);
    separation > 0 ? ++apart : ++overlapping;
    if (separation > 0 && distance - separation < 1e-6) ++equal;
  }
  EXPECT_GT(apart, 50);
  EXPECT_GT(overlapping, 50);
  EXPECT_GT(equal, 20);
}

// Moving B along the normal by the overlap brings the separation to zero, and no smaller move along any axis does.
TEST(SeparationOfPolytopes, IsTheLeastTranslationThatSeparates) {
  Random random;
  const Collider a = colliderOfSize(Vec3(1, 0.6, 1.4)), b = colliderOfSize(Vec3(0.5, 1.1, 0.8));
  int overlapping = 0;
  for (int i = 0; i < 200; ++i) {
    const RigidTransform poseA = random.pose(0.4);
    RigidTransform poseB = random.pose(0.4);
    const double separation = separationOf(a, b, poseA, poseB);
    if (separation >= 0) continue;
    ++overlapping;
    const auto contacts = contactsOf(a, b, poseA, poseB, 0);
    ASSERT_FALSE(contacts.empty()) << i;
    const Vec3 normal = contacts[0].normal;
    EXPECT_NEAR(normal.norm(), 1, 1e-14);
    for (int trial = 0; trial < 20; ++trial) {
      RigidTransform moved = poseB;
      moved.translation += 0.999 * std::abs(separation) * random.vector(1).normalized();
      EXPECT_LT(separationOf(a, b, poseA, moved), 0);
    }
    poseB.translation -= separation * normal;
    EXPECT_NEAR(separationOf(a, b, poseA, poseB), 0, 1e-12);
  }
  EXPECT_GT(overlapping, 50);
}

TEST(BoxContacts, OfAFaceOnAFaceAreTheCornersOfTheSharedArea) {
  const Collider floor = colliderOfSize(Vec3(4, 1, 4)), box = colliderOfSize(Vec3(1, 1, 1));
  for (const double gap : {0.0, 1e-9, -1e-6}) {
    // Half over the floor's edge at x = 2.
    const auto contacts = contactsOf(floor, box, {}, {Quat::Identity(), Vec3(2, 1 + gap, 0.3)}, 1e-8);
    ASSERT_EQ(contacts.size(), 4u);
    for (const Contact& contact : contacts) {
      EXPECT_LT((contact.normal - Vec3::UnitY()).norm(), 1e-15);
      EXPECT_NEAR(contact.separation, gap, 1e-15);
      EXPECT_NEAR(contact.point.y(), 0.5 + gap / 2, 1e-15);
      EXPECT_NEAR(std::abs(contact.point.x() - 1.75), 0.25, 1e-12);
      EXPECT_NEAR(std::abs(contact.point.z() - 0.3), 0.5, 1e-12);
    }
    const auto swapped = contactsOf(box, floor, {Quat::Identity(), Vec3(2, 1 + gap, 0.3)}, {}, 1e-8);
    ASSERT_EQ(swapped.size(), 4u);
    EXPECT_LT((swapped[0].normal + Vec3::UnitY()).norm(), 1e-15);
  }
}

TEST(BoxContacts, OfACornerAndOfAnEdgeOnAFace) {
  const Collider floor = colliderOfSize(Vec3(4, 1, 4)), box = colliderOfSize(Vec3(1, 1, 1));
  const auto contactsWhen = [&](const Quat& turn) {
    double lowest = 0;
    for (const Vec3& vertex : box.points) lowest = std::min(lowest, (turn * vertex).y());
    return contactsOf(floor, box, {}, {turn, Vec3(0.2, 0.5 - lowest, 0.1)}, 1e-8);
  };
  const auto corner = contactsWhen(Quat::FromTwoVectors(Vec3(1, 1, 1), Vec3(0, -1, 0)));
  ASSERT_EQ(corner.size(), 1u);
  EXPECT_LT((corner[0].point - Vec3(0.2, 0.5, 0.1)).norm(), 1e-12);
  EXPECT_LT((corner[0].normal - Vec3::UnitY()).norm(), 1e-12);
  const auto edge = contactsWhen(rotationAbout(Vec3::UnitZ(), M_PI / 4));
  ASSERT_EQ(edge.size(), 2u);
  EXPECT_NEAR(std::abs(edge[0].point.z() - 0.1), 0.5, 1e-12);
  EXPECT_NEAR(edge[0].point.z() + edge[1].point.z(), 0.2, 1e-12);
}

// Two edges that cross at right angles: a box on its edge along z above one with its edge along x.
TEST(BoxContacts, OfCrossingEdgesIsTheirNearestPoint) {
  const Collider box = colliderOfSize(Vec3(1, 1, 1));
  const double half = std::sqrt(0.5);
  for (const double gap : {1e-3, -1e-3}) {
    const auto contacts = contactsOf(box, box, {rotationAbout(Vec3::UnitX(), M_PI / 4), Vec3(0.1, 0, 0)},
                                     {rotationAbout(Vec3::UnitZ(), M_PI / 4), Vec3(0.3, 2 * half + gap, 0.2)}, 0.01);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_NEAR(contacts[0].separation, gap, 1e-14);
    EXPECT_LT((contacts[0].normal - Vec3::UnitY()).norm(), 1e-14);
    EXPECT_LT((contacts[0].point - Vec3(0.3, half + gap / 2, 0)).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace cradle
