#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "collision/closest_points.h"
#include "collision/separation.h"
#include "math/rotation.h"

namespace cradle {
namespace {

Polytope boxPolytope(const Vec3& size) {
  return polytopeOf(Box{size}, {});
}

Collider colliderOfSize(const Vec3& size) {
  return colliderOf(Box{size}, {});
}

/// Two moving colliders in their poses.
struct PosedColliders {
  ContactGeometry geometry;
  VectorX state = VectorX::Zero(stateSize(2));

  PosedColliders(const Collider& a, const Collider& b, const RigidTransform& poseA, const RigidTransform& poseB) {
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
  const PosedColliders pair(a, b, poseA, poseB);
  return separation(pair.geometry, pair.geometry.pairs[0], 0, pair.state);
}

std::vector<Contact> contactsOf(const Collider& a, const Collider& b, const RigidTransform& poseA,
                                const RigidTransform& poseB, double margin) {
  const PosedColliders pair(a, b, poseA, poseB);
  std::vector<Contact> contacts;
  findContacts(pair.geometry, pair.state, margin, contacts);
  return contacts;
}

class Random {
 public:
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  Vec3 vector(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }
  RigidTransform pose(double reach) {
    const Vec3 axis = vector(1);
    const Quat turn = rotationAbout(axis, number(0, 6));
    return {turn, vector(reach)};
  }

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
  const Polytope box = boxPolytope(Vec3(1, 2, 3));
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

/// The point of a solid box that is nearest to one, in the box's frame.
Vec3 nearestInBox(const Vec3& size, const Vec3& point) {
  return point.cwiseMin(size / 2).cwiseMax(-size / 2);
}

/// Whether a segment meets a box: the parts of it between the three pairs of planes have one in common.
bool meets(const Vec3& size, const Vec3& from, const Vec3& to) {
  double enter = 0, leave = 1;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double along = to[axis] - from[axis];
    const double one = (-size[axis] / 2 - from[axis]) / along, other = (size[axis] / 2 - from[axis]) / along;
    enter = std::max(enter, std::min(one, other)), leave = std::min(leave, std::max(one, other));
  }
  return enter <= leave;
}

double segmentDistance(const Segment& a, const Segment& b) {
  const SegmentParts parts = nearestParts(a, b);
  return (a.at(parts.a) - b.at(parts.b)).norm();
}

/// Distance of two boxes, 0 if they overlap, by all their corners and edges: shares nothing with separating axes.
double distanceOfBoxes(const Vec3& sizeA, const Vec3& sizeB, const RigidTransform& aFromB) {
  const Polytope a = boxPolytope(sizeA), b = boxPolytope(sizeB);
  const RigidTransform bFromA = aFromB.inverse();
  double least = INFINITY;
  for (const Vec3& corner : b.vertices)
    least = std::min(least, (aFromB * corner - nearestInBox(sizeA, aFromB * corner)).norm());
  for (const Vec3& corner : a.vertices)
    least = std::min(least, (bFromA * corner - nearestInBox(sizeB, bFromA * corner)).norm());
  const auto edgeOf = [](const Polytope& box, const Polytope::Edge& edge, const RigidTransform& pose) {
    const Vec3 from = pose * box.vertices[edge.from];
    return Segment{from, pose * box.vertices[edge.to] - from};
  };
  for (const Polytope::Edge& ofA : a.edges) {
    const Segment seen = edgeOf(a, ofA, bFromA), edge = edgeOf(a, ofA, {});
    if (meets(sizeB, seen.from, seen.at(1))) return 0;
    for (const Polytope::Edge& ofB : b.edges) least = std::min(least, segmentDistance(edge, edgeOf(b, ofB, aFromB)));
  }
  for (const Polytope::Edge& ofB : b.edges) {
    const Segment edge = edgeOf(b, ofB, aFromB);
    if (meets(sizeA, edge.from, edge.at(1))) return 0;
  }
  return least;
}

TEST(SeparationOfPolytopes, IsTheDistanceApartAndNegativeExactlyIfTheyOverlap) {
  Random random;
  const Vec3 sizeA(1, 0.6, 1.4), sizeB(0.5, 1.1, 0.8);
  const Collider a = colliderOfSize(sizeA), b = colliderOfSize(sizeB);
  int apart = 0, overlapping = 0;
  for (int i = 0; i < 300; ++i) {
    const RigidTransform poseA = random.pose(0.6), poseB = random.pose(0.9);
    const double separation = separationOf(a, b, poseA, poseB);
    const double distance = distanceOfBoxes(sizeA, sizeB, poseA.inverse() * poseB);
    separation > 0 ? ++apart : ++overlapping;
    if (distance > 0) {
      EXPECT_NEAR(separation, distance, 1e-14) << i;  // sums and products of lengths of about 1 m
    } else {
      EXPECT_LT(separation, 0) << i;
    }
  }
  EXPECT_GT(apart, 50);
  EXPECT_GT(overlapping, 50);
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
  const auto corner = contactsWhen(rotationBetween(Vec3(1, 1, 1), Vec3(0, -1, 0)));
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
