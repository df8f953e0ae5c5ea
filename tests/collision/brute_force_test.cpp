#include <gtest/gtest.h>

#include <cmath>

#include "collision/random_poses.h"
#include "collision/separation.h"
#include "collision/widest_gap.h"

// Every kind of pair against a computation that knows nothing of features. The signed distance of two convex solids is
// the largest gap that any direction n sees, -h_A(n) - h_B(-n), where h is the support function (the farthest that a
// solid reaches along n): the distance if they are apart, minus the least translation that separates them if not. It is
// searched over the whole sphere of directions, and each solid is nothing but its support function.

namespace cradle {
namespace {

/// A solid by its pose and what reaches farthest: points with a ball around each.
struct Solid {
  std::vector<Vec3> corners;  // m, body's frame
  double radius = 0;          // m
  bool isBox = false;
  Vec3 boxSize = Vec3::Ones();
  RigidTransform worldFromBody;

  double reach(const Vec3& direction) const {
    double farthest = -INFINITY;
    for (const Vec3& corner : corners) farthest = std::max(farthest, direction.dot(worldFromBody * corner));
    return farthest + radius;
  }
  Vec3 inBody(const Vec3& point) const { return worldFromBody.inverse() * point; }
  /// How far outside a point is; <= 0 inside.
  double outside(const Vec3& point) const {
    if (isBox) return (inBody(point).cwiseAbs() - boxSize / 2).maxCoeff();
    return inBody(point).norm() - radius;
  }
};

Solid sphereOf(double radius) {
  return {{Vec3::Zero()}, radius, false, {}, {}};
}
Solid boxOf(const Vec3& size) {
  Solid box{{}, 0, true, size, {}};
  for (int corner = 0; corner < 8; ++corner)
    box.corners.emplace_back(
        size.cwiseProduct(Vec3(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5)));
  return box;
}
Solid capsuleOf(double radius, double length) {
  return {{Vec3(0, length / 2, 0), Vec3(0, -length / 2, 0)}, radius, false, {}, {}};
}
Solid someMesh(RandomPoses& random) {
  Solid mesh;
  for (int i = 0; i < 20; ++i) mesh.corners.push_back(random.vector(0.7));
  return mesh;
}

/// The solids as the program has them: two moving bodies, or one and a plane.
struct SolidPair {
  ContactGeometry geometry;
  VectorX state;
  Solid a, b;
  PlaneCollider plane;
};

void addCollider(SolidPair& pair, const Solid& solid, int body) {
  Collider collider{body, solid.corners, solid.radius, 0, {}};
  for (const Vec3& corner : solid.corners)
    collider.boundingRadius = std::max(collider.boundingRadius, corner.norm() + solid.radius);
  if (solid.isBox) {
    collider.polytope = std::make_shared<const Polytope>(polytopeOf(Box{solid.boxSize}, {}));
    collider.points = collider.polytope->vertices;
  }
  pair.geometry.colliders.push_back(collider);
  centerOfMass(pair.state, body) = solid.worldFromBody.translation;
  setOrientation(pair.state, body, solid.worldFromBody.rotation);
}

SolidPair pairOf(const Solid& a, const Solid& b) {
  SolidPair pair{{}, VectorX::Zero(stateSize(2)), a, b, {}};
  addCollider(pair, a, 0);
  addCollider(pair, b, 1);
  pair.geometry.pairs = {{0, 1, false, {}}};
  return pair;
}

SolidPair pairOf(const Solid& a, const PlaneCollider& plane) {
  SolidPair pair{{}, VectorX::Zero(stateSize(1)), a, {}, plane};
  addCollider(pair, a, 0);
  pair.geometry.planes = {plane};
  pair.geometry.pairs = {{0, 0, true, {}}};
  return pair;
}

double gapAlong(const SolidPair& pair, const Vec3& direction) {
  return -pair.a.reach(direction) - pair.b.reach(-direction);
}

/// Of 2000 directions, 3 degrees apart, the 12 best climbedSupportGap.
Vec3 directionOfWidestGap(const SolidPair& pair) {
  return widestGap([&](const Vec3& direction) { return gapAlong(pair, direction); }, {2000, 12, 1e-5});
}

std::vector<Contact> contactsOf(const SolidPair& pair, double margin) {
  std::vector<Contact> contacts;
  findContacts(pair.geometry, pair.state, margin, contacts);
  return contacts;
}

double separationOf(const SolidPair& pair) {
  return separation(pair.geometry, pair.geometry.pairs[0], 0, pair.state);
}

constexpr double kSumRounding = 1e-13;  // m: sums and products of lengths of some metres
// Climbing gets stuck on ridges, where two faces meet, up to about its smallest useful step from the top.
constexpr double kSearchError = 1e-3;  // m

/// The separation is what the normal sees, and no other direction sees more.
void expectWidest(const SolidPair& pair, double separation, const Vec3& normal) {
  EXPECT_NEAR(gapAlong(pair, normal), separation, kSumRounding);
  const double searched = gapAlong(pair, directionOfWidestGap(pair));
  EXPECT_LE(searched, separation + kSumRounding);
  EXPECT_GE(searched, separation - kSearchError);
}

/// What makes a contact of convex solids right: the normal sees the gap, and each surface point is on its solid where
/// that reaches farthest along the normal.
void expectRightContact(const SolidPair& pair, const Contact& contact, double tolerance = kSumRounding) {
  EXPECT_NEAR(contact.normal.norm(), 1, kSumRounding);
  const Vec3 onA = contact.point - contact.separation / 2 * contact.normal;
  const Vec3 onB = contact.point + contact.separation / 2 * contact.normal;
  EXPECT_NEAR(pair.a.reach(contact.normal), contact.normal.dot(onA), tolerance);
  EXPECT_NEAR(pair.b.reach(-contact.normal), -contact.normal.dot(onB), tolerance);
  EXPECT_NEAR(pair.a.outside(onA), 0, tolerance);
  EXPECT_NEAR(pair.b.outside(onB), 0, tolerance);
}

TEST(BruteForce, SphereOnSphere) {
  RandomPoses random(1);
  for (int i = 0; i < 20; ++i) {
    Solid a = sphereOf(random.number(0.1, 1)), b = sphereOf(random.number(0.1, 1));
    a.worldFromBody = {random.turn(), random.vector(1)}, b.worldFromBody = {random.turn(), random.vector(1)};
    const SolidPair pair = pairOf(a, b);
    const auto contacts = contactsOf(pair, 10);
    ASSERT_EQ(contacts.size(), 1u);
    expectWidest(pair, separationOf(pair), contacts[0].normal);
    EXPECT_EQ(contacts[0].separation, separationOf(pair));
    expectRightContact(pair, contacts[0]);
  }
}

/// A point of the box's frame beside a face, an edge or a corner (`beyond` 1, 2 or 3 of its extents).
Vec3 besideBox(const Vec3& size, int beyond, RandomPoses& random) {
  Vec3 point;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double side = random.number(0, 1) < 0.5 ? -1 : 1;
    point[axis] =
        axis < beyond ? side * (size[axis] / 2 + random.number(0.01, 0.4)) : random.number(-0.4, 0.4) * size[axis];
  }
  return point;
}

TEST(BruteForce, SphereOnBoxBesideFaceEdgeAndCornerAndInside) {
  RandomPoses random(2);
  for (int beyond = 0; beyond <= 3; ++beyond)
    for (int i = 0; i < 10; ++i) {
      Solid ball = sphereOf(random.number(0.05, 0.5)), box = boxOf(Vec3(0.6, 1, 1.7));
      box.worldFromBody = {random.turn(), random.vector(1)};
      ball.worldFromBody = {random.turn(), box.worldFromBody * besideBox(box.boxSize, beyond, random)};
      for (const SolidPair& pair : {pairOf(ball, box), pairOf(box, ball)}) {
        const auto contacts = contactsOf(pair, 10);
        ASSERT_EQ(contacts.size(), 1u);
        expectWidest(pair, separationOf(pair), contacts[0].normal);
        EXPECT_EQ(contacts[0].separation, separationOf(pair));
        expectRightContact(pair, contacts[0]);
      }
    }
}

constexpr double kHalfThickness = 0.25;  // m: of the thinner box

/// Contacts of boxes that overlap: all along the normal that sees the overlap, the deepest as deep as that, and each in
/// both solids.
void expectBoxesRight(const SolidPair& pair) {
  const auto contacts = contactsOf(pair, 0);
  ASSERT_FALSE(contacts.empty());
  expectWidest(pair, separationOf(pair), contacts[0].normal);
  double deepest = 0;
  for (const Contact& contact : contacts) {
    deepest = std::min(deepest, contact.separation);
    EXPECT_EQ(contact.normal, contacts[0].normal);
    // One of the two surface points is where a feature of one solid is inside the other, unless it comes out of it at
    // the far side.
    if (separationOf(pair) < -kHalfThickness) continue;
    const Vec3 half = contact.separation / 2 * contact.normal;
    const auto depth = [&](const Vec3& point) { return std::max(pair.a.outside(point), pair.b.outside(point)); };
    EXPECT_LT(std::min(depth(contact.point - half), depth(contact.point + half)), kSumRounding);
  }
  EXPECT_NEAR(deepest, separationOf(pair), kSumRounding);
}

TEST(BruteForce, BoxesThatOverlapAnyhow) {
  RandomPoses random(3);
  int overlapping = 0;
  for (int i = 0; i < 60; ++i) {
    Solid a = boxOf(Vec3(1, 0.6, 1.4)), b = boxOf(Vec3(0.5, 1.1, 0.8));
    a.worldFromBody = {random.turn(), random.vector(0.5)}, b.worldFromBody = {random.turn(), random.vector(0.5)};
    const SolidPair pair = pairOf(a, b);
    if (separationOf(pair) >= 0) {
      EXPECT_GE(gapAlong(pair, directionOfWidestGap(pair)), 0);
      continue;
    }
    ++overlapping;
    expectBoxesRight(pair);
  }
  EXPECT_GT(overlapping, 20);
}

/// Moves B along the widest gap until it overlaps A by `depth`, as the climbing knows it.
SolidPair touching(Solid a, Solid b, double depth) {
  const SolidPair apart = pairOf(a, b);
  const Vec3 direction = directionOfWidestGap(apart);
  b.worldFromBody.translation -= (gapAlong(apart, direction) + depth) * direction;
  return pairOf(a, b);
}

// Randomly turned boxes touch with a vertex on a face or with two edges: the deepest contact is one point, on the
// surface of both. Of a vertex pressed in by 1 mm it is the vertex; of two edges, their nearest points.
TEST(BruteForce, BoxesThatTouchByAVertexOnAFaceOrByTwoEdges) {
  RandomPoses random(4);
  int vertexOnFace = 0, edges = 0;
  for (int i = 0; i < 40; ++i) {
    Solid a = boxOf(Vec3(1, 0.6, 1.4)), b = boxOf(Vec3(0.5, 1.1, 0.8));
    a.worldFromBody = {random.turn(), random.vector(0.3)};
    b.worldFromBody = {random.turn(), random.vector(0.5)};
    const SolidPair pair = touching(a, b, 1e-3);
    expectBoxesRight(pair);
    const double depth = separationOf(pair);
    const auto deepest = contactsOf(pair, depth + kSumRounding);
    ASSERT_EQ(deepest.size(), 1u) << i;
    expectRightContact(pair, deepest[0]);
    const auto isAxisOf = [&](const Solid& box) {
      return (box.worldFromBody.rotation.conjugate() * deepest[0].normal).cwiseAbs().maxCoeff() > 1 - 1e-12;
    };
    isAxisOf(a) || isAxisOf(b) ? ++vertexOnFace : ++edges;
  }
  EXPECT_GT(vertexOnFace, 5);
  EXPECT_GT(edges, 5);
}

// A face on a face, turned about their common normal: contacts are the corners of the shared polygon, so that any point
// of both faces is inside their hull; the support function of contacts and of the overlap agree. The overlap's is found
// by sampling the smaller face on a grid.
TEST(BruteForce, BoxesWithParallelFacesShareTheWholePolygon) {
  RandomPoses random(5);
  for (int i = 0; i < 20; ++i) {
    Solid a = boxOf(Vec3(1, 0.6, 1.4)), b = boxOf(Vec3(0.5, 1.1, 0.8));
    const RigidTransform frame{random.turn(), random.vector(1)};
    a.worldFromBody = frame;
    const Vec3 across{random.number(-0.5, 0.5), 0, random.number(-0.7, 0.7)};
    b.worldFromBody =
        frame * RigidTransform{rotationAbout(Vec3::UnitY(), random.number(0, 6)), across + Vec3(0, 0.85 - 1e-4, 0)};
    const SolidPair pair = pairOf(a, b);
    const auto contacts = contactsOf(pair, 0);
    ASSERT_GE(contacts.size(), 3u);
    for (const Contact& contact : contacts) {
      EXPECT_NEAR(contact.separation, -1e-4, kSumRounding);
      EXPECT_LT((contact.normal - frame.rotation * Vec3::UnitY()).norm(), kSumRounding);
    }
    const Vec3 sideways = frame.rotation * Vec3(std::cos(i), 0, std::sin(i));
    double farthest = -INFINITY, sampled = -INFINITY;
    for (const Contact& contact : contacts) farthest = std::max(farthest, sideways.dot(contact.point));
    const int grid = 400;
    for (int x = 0; x <= grid; ++x)
      for (int z = 0; z <= grid; ++z) {
        const Vec3 point = b.worldFromBody * Vec3(0.5 * (x / 400.0 - 0.5), -0.55, 0.8 * (z / 400.0 - 0.5));
        if (a.outside(point) <= 0) sampled = std::max(sampled, sideways.dot(point));
      }
    // The grid misses the polygon's corner by up to a cell's diagonal at a right angle, more at a sharper one.
    EXPECT_NEAR(farthest, sampled, 0.02);
    EXPECT_GE(farthest, sampled - 1e-6);
  }
}

TEST(BruteForce, EveryShapeOnAPlane) {
  RandomPoses random(6);
  for (int i = 0; i < 40; ++i) {
    const PlaneCollider plane{random.vector(1), random.direction()};
    for (Solid solid : {sphereOf(0.4), boxOf(Vec3(0.6, 1, 1.7)), capsuleOf(0.3, 1.2), someMesh(random)}) {
      solid.worldFromBody = {random.turn(), random.vector(1.5)};
      const SolidPair pair = pairOf(solid, plane);
      const double gap = -solid.reach(-plane.normal) - plane.normal.dot(plane.point);
      double least = INFINITY;
      std::vector<std::size_t> features;
      appendFeaturesWithin(pair.geometry, pair.geometry.pairs[0], solid.worldFromBody, gap + 1e-6, features);
      for (const std::size_t feature : features)
        least = std::min(least, separation(pair.geometry, pair.geometry.pairs[0], feature, pair.state));
      EXPECT_NEAR(least, gap, kSumRounding);

      // One contact for each corner that is near enough, below it on the surface, and the normal into the ground.
      const double margin = gap + 0.5;
      const auto contacts = contactsOf(pair, margin);
      const auto isNear = [&](const Vec3& corner) {
        return plane.normal.dot(solid.worldFromBody * corner - plane.point) - solid.radius <= margin;
      };
      // Of more than 8 corners of a mesh, those between others are left out.
      if (std::count_if(solid.corners.begin(), solid.corners.end(), isNear) > 8) continue;
      std::size_t expected = 0;
      for (const Vec3& corner : solid.corners) {
        const Vec3 lowest = solid.worldFromBody * corner - solid.radius * plane.normal;
        const double height = plane.normal.dot(lowest - plane.point);
        if (height > margin) continue;
        ++expected;
        if (solid.corners.size() > 8) continue;  // of a mesh with many, few stand for all
        const auto at = std::find_if(contacts.begin(), contacts.end(), [&](const Contact& contact) {
          return (contact.point - (lowest - height / 2 * plane.normal)).norm() < kSumRounding;
        });
        ASSERT_NE(at, contacts.end());
        EXPECT_NEAR(at->separation, height, kSumRounding);
        EXPECT_LT((at->normal + plane.normal).norm(), kSumRounding);
      }
      if (solid.corners.size() > 8)
        EXPECT_NEAR(std::min_element(contacts.begin(), contacts.end(),
                                     [](const Contact& x, const Contact& y) { return x.separation < y.separation; })
                        ->separation,
                    gap, kSumRounding);
      else
        EXPECT_EQ(contacts.size(), expected);
    }
  }
}

}  // namespace
}  // namespace cradle
