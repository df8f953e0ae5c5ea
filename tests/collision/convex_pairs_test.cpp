#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "collision/random_poses.h"
#include "collision/separation.h"
#include "collision/widest_gap.h"

// Every pair of convex shapes. What a contact says is proven, not compared: the surface points are on their solids, as
// far apart as the separation, which bounds the distance from above; and the normal sees a gap as large between the
// solids' support functions, which bounds it from below. Where solids overlap no other of many directions may see a
// larger gap. Supports and solids are written down here once more, without the program's.

namespace cradle {
namespace {

/// A shape by its support function and by how far outside a point is (<= 0 inside), in its own frame.
struct Shape {
  std::string name;
  Collider collider;
  std::function<double(const Vec3&)> reach;
  std::function<double(const Vec3&)> outside;
};

double radiusOf(const Vec3& point) {
  return std::sqrt(point.x() * point.x() + point.z() * point.z());
}

Shape ball(double radius) {
  return {"ball", colliderOf(Sphere{radius}, {}), [=](const Vec3& n) { return radius * n.norm(); },
          [=](const Vec3& p) { return p.norm() - radius; }};
}

Shape capsule(double radius, double length) {
  return {"capsule", colliderOf(Capsule{radius, length}, {}),
          [=](const Vec3& n) { return length / 2 * std::abs(n.y()) + radius * n.norm(); },
          [=](const Vec3& p) {
            const double beyond = std::max(0.0, std::abs(p.y()) - length / 2);
            return Vec3(p.x(), beyond, p.z()).norm() - radius;
          }};
}

Shape cylinder(double radius, double length) {
  return {"cylinder", colliderOf(Cylinder{radius, length}, {}),
          [=](const Vec3& n) { return length / 2 * std::abs(n.y()) + radius * radiusOf(n); },
          [=](const Vec3& p) { return std::max(radiusOf(p) - radius, std::abs(p.y()) - length / 2); }};
}

Shape box(const Vec3& size) {
  return {"box", colliderOf(Box{size}, {}), [=](const Vec3& n) { return n.cwiseAbs().dot(size / 2); },
          [=](const Vec3& p) { return (p.cwiseAbs() - size / 2).maxCoeff(); }};
}

Shape hull(const std::string& name, std::vector<Vec3> points) {
  const ConvexHull found = convexHullOf(points);
  return {name, colliderOf(found, {}),
          [=](const Vec3& n) {
            double farthest = -INFINITY;
            for (const Vec3& point : points) farthest = std::max(farthest, n.dot(point));
            return farthest;
          },
          [=](const Vec3& p) {
            double most = -INFINITY;
            for (const auto& loop : found.faces) {
              const auto at = [&](std::size_t i) { return found.vertices[loop[i]]; };
              most = std::max(most, (at(1) - at(0)).cross(at(2) - at(0)).normalized().dot(p - at(0)));
            }
            return most;
          }};
}

Shape stone() {
  RandomPoses random(11);
  std::vector<Vec3> points;
  for (int i = 0; i < 14; ++i) points.push_back(random.direction().cwiseProduct(Vec3(0.7, 0.5, 0.9)));
  return hull("stone", points);
}

Shape pebble() {
  RandomPoses random(12);
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.push_back(random.direction().cwiseProduct(Vec3(0.6, 0.8, 0.5)));
  return hull("pebble", points);
}

std::vector<Shape> allShapes() {
  return {ball(0.4), capsule(0.3, 1.2), cylinder(0.5, 0.8), cylinder(0.2, 1.6), box(Vec3(1, 0.6, 1.4)),
          stone(),   pebble()};
}

/// Two shapes in their poses.
struct ShapePair {
  const Shape &a, &b;
  RigidTransform poseA, poseB;
  ContactGeometry geometry;
  VectorX state = VectorX::Zero(stateSize(2));

  ShapePair(const Shape& shapeA, const Shape& shapeB, const RigidTransform& worldFromA,
            const RigidTransform& worldFromB)
      : a(shapeA), b(shapeB) {
    geometry.colliders = {a.collider, b.collider};
    geometry.colliders[0].body = 0, geometry.colliders[1].body = 1;
    geometry.pairs = {{0, 1, false, {}}};
    place(worldFromA, worldFromB);
  }
  void place(const RigidTransform& worldFromA, const RigidTransform& worldFromB) {
    centerOfMass(state, 0) = worldFromA.translation, setOrientation(state, 0, worldFromA.rotation);
    centerOfMass(state, 1) = worldFromB.translation, setOrientation(state, 1, worldFromB.rotation);
    poseA = poseOf(state, 0), poseB = poseOf(state, 1);
  }
  double separation() const { return cradle::separation(geometry, geometry.pairs[0], 0, poseA, poseB); }
  std::vector<Contact> contacts(double margin) const {
    std::vector<Contact> found;
    findContacts(geometry, state, margin, found);
    return found;
  }
  double gapAlong(const Vec3& normal) const {
    return normal.dot(poseB.translation - poseA.translation) - a.reach(poseA.rotation.conjugate() * normal) -
           b.reach(poseB.rotation.conjugate() * Vec3(-normal));
  }
};

constexpr double kProductRounding = 2e-14;  // m: of sums of products of lengths of some metres

/// The largest gap that a search over the sphere of directions sees.
double widestGapSearched(const ShapePair& pair) {
  const auto gapAlong = [&](const Vec3& direction) { return pair.gapAlong(direction); };
  return gapAlong(widestGap(gapAlong, {700, 6, 1e-4}));
}

std::string describe(const ShapePair& pair) {
  return pair.a.name + " on " + pair.b.name;
}

/// Of all contacts: unit normal; deepest as deep as the separation; none deeper.
const Contact& deepestOf(const std::vector<Contact>& contacts) {
  return *std::min_element(contacts.begin(), contacts.end(),
                           [](const Contact& a, const Contact& b) { return a.separation < b.separation; });
}

/// `preference` (m): what a contact may give away for the normal of a face.
void expectProven(const ShapePair& pair, double preference) {
  const double separation = pair.separation();
  const auto contacts = pair.contacts(separation + 1e-9);
  ASSERT_FALSE(contacts.empty()) << describe(pair) << ' ' << separation;
  const Contact& contact = deepestOf(contacts);
  EXPECT_NEAR(contact.normal.norm(), 1, kProductRounding);
  EXPECT_NEAR(contact.separation, separation, preference) << describe(pair);
  // The corner that is deepest may be beside the face that it is held against: then others stand in, if as deep but for
  // what the face gives away.
  EXPECT_NEAR(pair.gapAlong(contact.normal), contact.separation, preference) << describe(pair) << ' ' << separation;
  const Vec3 onA = contact.point - contact.separation / 2 * contact.normal;
  const Vec3 onB = contact.point + contact.separation / 2 * contact.normal;
  EXPECT_LE(pair.a.outside(pair.poseA.inverse() * onA), preference) << describe(pair) << ' ' << separation;
  EXPECT_LE(pair.b.outside(pair.poseB.inverse() * onB), preference) << describe(pair) << ' ' << separation;
}

template <class Check>
void forAllPairs(const Check& check) {
  const std::vector<Shape> shapes = allShapes();
  for (const Shape& a : shapes)
    for (const Shape& b : shapes) check(a, b);
}

TEST(ConvexPairs, DistancesApartAreProvenBySurfacePointsAndNormal) {
  RandomPoses random(1);
  forAllPairs([&](const Shape& a, const Shape& b) {
    int apart = 0;
    for (int i = 0; apart < 10 && i < 200; ++i) {
      const RigidTransform poseA = random.pose(1), poseB = random.pose(1.5);
      const ShapePair pair(a, b, poseA, poseB);
      if (pair.separation() <= 0.02) continue;
      ++apart;
      expectProven(pair, kProductRounding);
    }
    EXPECT_EQ(apart, 10);
  });
}

// A step along the normal by the distance touches; a little more overlaps by as much. The gap stays what it is.
TEST(ConvexPairs, SeparationGoesThroughZeroAlongTheNormal) {
  RandomPoses random(2);
  forAllPairs([&](const Shape& a, const Shape& b) {
    int apart = 0;
    for (int i = 0; apart < 4 && i < 200; ++i) {
      const RigidTransform poseA = random.pose(1), poseB = random.pose(1.5);
      ShapePair pair(a, b, poseA, poseB);
      const double distance = pair.separation();
      if (distance <= 0.02) continue;
      ++apart;
      const Vec3 normal = pair.contacts(distance + 1e-9)[0].normal;
      const RigidTransform start = pair.poseB;
      for (const double left : {1e-3, 1e-6, 1e-9, 1e-11, 0.0}) {
        pair.place(pair.poseA, {start.rotation, start.translation - (distance - left) * normal});
        EXPECT_NEAR(pair.separation(), left, 3e-13) << describe(pair);
      }
      // Overlapping by less than any feature is large, the least way out is the same but for corners and edges: any
      // direction m that saw no gap when they touched now sees -depth n.m, which is next to nothing for a face of a
      // sharp corner. Around a rim, of at least 0.1 m as it is seen, it goes on to where it sees depth^2 / (2 0.1 m)
      // more.
      for (const double depth : {1e-11, 1e-9, 1e-6}) {
        pair.place(pair.poseA, {start.rotation, start.translation - (distance + depth) * normal});
        const double leads = normal.dot(deepestOf(pair.contacts(0)).normal);
        EXPECT_LT(pair.separation(), 0) << describe(pair);
        EXPECT_GE(pair.separation(), -depth * leads - 3e-13 - 5 * depth * depth) << describe(pair);
        expectProven(pair, 2e-6);
      }
    }
  });
}

// A shape and its mirror image that meet in the mirror's plane, mostly with a corner or a rim: a contact's normal is
// the plane's, or the contacts come in mirrored pairs. Up to the 1e-9 of the size that corners meet within.
TEST(ConvexPairs, MirrorImagesThatMeetHaveAMirroredNormal) {
  RandomPoses random(4);
  for (const Shape& shape : {capsule(0.3, 1.2), cylinder(0.5, 0.8), cylinder(0.2, 1.6), box(Vec3(1, 0.6, 1.4))})
    for (int i = 0; i < 40; ++i)
      for (const double gap : {0.0, 1e-16, -1e-16, 1e-13, -1e-13, 1e-11, -1e-11, 1e-10, -1e-10}) {
        const Quat turn = random.turn();
        const Vec3 place(gap / 2 + shape.reach(turn.conjugate() * Vec3::UnitX()), random.number(-1, 1), 0.3);
        const ShapePair pair(shape, shape, {turn, place},
                             {Quat(turn.w(), turn.x(), -turn.y(), -turn.z()), Vec3(-place.x(), place.y(), place.z())});
        Vec3 sum = Vec3::Zero();
        const std::vector<Contact> contacts = pair.contacts(1e-9);
        for (const Contact& contact : contacts) sum += contact.normal;
        EXPECT_NEAR(sum.x(), -double(contacts.size()), 1e-10) << describe(pair) << ' ' << gap;
      }
}

// The same where they meet with faces that tilt a little: neither face has the normal, but their mean.
TEST(ConvexPairs, MirrorImagesThatMeetWithTiltedFacesHaveAMirroredNormal) {
  RandomPoses random(6);
  for (const Shape& shape : {cylinder(0.5, 0.8), cylinder(0.2, 1.6), box(Vec3(1, 0.6, 1.4))})
    for (const double tilt : {1e-10, 1e-9, 4e-9, 1e-8, 3e-8})
      for (const double gap : {0.0, 1e-13, -1e-13, 1e-11, -1e-11}) {
        const Quat turn = rotationAbout(Vec3(0, 1, random.number(-1, 1)).normalized(), tilt) *
                          rotationAbout(Vec3::UnitX(), random.number(-1, 1)) * rotationAbout(Vec3::UnitZ(), M_PI / 2);
        const Vec3 place(gap / 2 + shape.reach(turn.conjugate() * Vec3::UnitX()), random.number(-1, 1), 0.3);
        const ShapePair pair(shape, shape, {turn, place},
                             {Quat(turn.w(), turn.x(), -turn.y(), -turn.z()), Vec3(-place.x(), place.y(), place.z())});
        Vec3 sum = Vec3::Zero();
        for (const Contact& contact : pair.contacts(1e-9)) sum += contact.normal;
        EXPECT_LT(sum.x(), -0.9) << describe(pair) << ' ' << gap;
        EXPECT_LT(std::hypot(sum.y(), sum.z()), 1e-13) << describe(pair) << ' ' << tilt << ' ' << gap;
      }
}

TEST(ConvexPairs, NoDirectionSeesALargerGapWhereTheyOverlap) {
  RandomPoses random(3);
  forAllPairs([&](const Shape& a, const Shape& b) {
    int overlapping = 0;
    for (int i = 0; overlapping < 3 && i < 100; ++i) {
      const RigidTransform poseA = random.pose(0.4), poseB = random.pose(0.5);
      const ShapePair pair(a, b, poseA, poseB);
      const double separation = pair.separation();
      if (separation >= 0) continue;
      ++overlapping;
      EXPECT_LE(widestGapSearched(pair), separation + kProductRounding) << describe(pair);
      const Contact deepest = deepestOf(pair.contacts(0));
      EXPECT_NEAR(pair.gapAlong(deepest.normal), separation, 1e-7) << describe(pair);
    }
    EXPECT_EQ(overlapping, 3);
  });
}

// Swapped, and turned and moved together: the same to rounding.
TEST(ConvexPairs, DoNotDependOnOrderOrFrame) {
  RandomPoses random(4);
  forAllPairs([&](const Shape& a, const Shape& b) {
    for (int i = 0; i < 10; ++i) {
      const RigidTransform poseA = random.pose(1), poseB = random.pose(1), frame = random.pose(2);
      const double separation = ShapePair(a, b, poseA, poseB).separation();
      EXPECT_NEAR(ShapePair(b, a, poseB, poseA).separation(), separation, 1e-13) << a.name << " on " << b.name;
      EXPECT_NEAR(ShapePair(a, b, frame * poseA, frame * poseB).separation(), separation, 1e-13) << a.name << b.name;
    }
  });
}

// d(separation)/dt is the normal's part of the relative velocity of the surface points: the gap of an hour's motion is
// followed by its slope.
TEST(ConvexPairs, SlopeOfTheSeparationIsTheRelativeVelocityAtTheContact) {
  RandomPoses random(5);
  forAllPairs([&](const Shape& a, const Shape& b) {
    int apart = 0;
    for (int i = 0; apart < 5 && i < 100; ++i) {
      const RigidTransform poseA = random.pose(1), poseB = random.pose(1.5);
      ShapePair pair(a, b, poseA, poseB);
      const double separation = pair.separation();
      if (separation <= 0.05) continue;
      ++apart;
      const Contact contact = deepestOf(pair.contacts(separation + 1e-9));
      const Vec3 velocity = random.vector(1), spin = random.vector(1);
      const Vec3 onB = contact.point + contact.separation / 2 * contact.normal;
      const double slope = contact.normal.dot(velocity + spin.cross(onB - poseB.translation));
      const double step = 1e-6;
      const auto gapAt = [&](double time) {
        pair.place(poseA, {rotationAbout(spin.normalized(), spin.norm() * time) * poseB.rotation,
                           poseB.translation + velocity * time});
        return pair.separation();
      };
      // Kinks between features have a slope of their own on each side.
      const double before = (gapAt(0) - gapAt(-step)) / step, after = (gapAt(step) - gapAt(0)) / step;
      EXPECT_NEAR(std::min(std::abs(before - slope), std::abs(after - slope)), 0, 1e-4) << describe(pair);
    }
  });
}

/// Aligned and nearly aligned, along and across: parallel edges, coincident faces, common axes.
std::vector<Quat> alignedTurns() {
  std::vector<Quat> turns;
  for (const double angle : {0.0, M_PI / 2, M_PI, M_PI / 4})
    for (const double noise : {0.0, 1e-15, 1e-12, 1e-8, 1e-5})
      for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
        turns.push_back(rotationAbout(axis, angle) * rotationAbout(Vec3(1, 2, 3).normalized(), noise));
  return turns;
}

// On a way through the other, from one side to the other past the common centre: no NaN, a unit normal that sees the
// gap, and no separation that changes by more than the way.
TEST(ConvexPairs, AlignedPosesPassThroughEachOtherWithoutAJump) {
  const std::vector<Quat> turns = alignedTurns();
  std::size_t next = 0;  // five for each pair, others for the next
  forAllPairs([&](const Shape& a, const Shape& b) {
    ShapePair pair(a, b, {}, {});
    for (int trial = 0; trial < 5; ++trial, next += 7) {
      const Quat& turn = turns[next % turns.size()];
      const Vec3 way = Vec3::Unit(trial % 3);
      double last = 0;
      const double step = 0.2;
      for (int i = -9; i <= 9; ++i) {
        pair.place({}, {turn, step * i * way});
        const double separation = pair.separation();
        ASSERT_TRUE(std::isfinite(separation));
        if (i > -9) {
          EXPECT_LE(std::abs(separation - last), step + 1e-12) << describe(pair) << i;
        }
        last = separation;
        for (const Contact& contact : pair.contacts(separation + 1e-9)) {
          EXPECT_NEAR(contact.normal.norm(), 1, kProductRounding);
          EXPECT_TRUE(contact.point.allFinite());
          EXPECT_GE(contact.separation, separation - 2e-7) << describe(pair);
        }
      }
    }
  });
}

}  // namespace
}  // namespace cradle
