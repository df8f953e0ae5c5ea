#include "impact/soft_manifolds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "impact/posed_bodies.h"
#include "math/rotation.h"
#include "mesh/convex_hull.h"

namespace cradle {
namespace {

const Quat kTurn = rotationAbout(Vec3(1, -2, 0.5), 0.4);

/// The manifold of the only pair.
PredictedManifold manifoldOfPair(const PosedBodies& bodies) {
  const SoftManifolds manifolds(bodies.geometry);
  std::vector<Contact> scratch;
  SoftPair pair = manifolds.pairOf(0);
  return manifolds.manifoldOf(pair, bodies.stepStart(), scratch);
}

double deepestOf(const PredictedManifold& manifold) {
  double least = INFINITY;
  for (std::size_t i = 0; i < manifold.count; ++i) least = std::min(least, manifold.points[i].separation);
  return least;
}

TEST(SoftManifolds, HaveAMovingBodyFirst) {
  PosedBodies bodies;
  bodies.addFixed(colliderOf(Box{Vec3(2, 0.2, 2)}, {}));
  bodies.add(colliderOf(Sphere{0.1}, {}), Vec3(0, 0.201, 0));
  bodies.geometry.pairs = {{0, 1, false, {}}};
  bodies.place();
  const SoftPair pair = SoftManifolds(bodies.geometry).pairOf(0);
  EXPECT_TRUE(pair.isExchanged);
  EXPECT_EQ(std::pair(pair.shapeA, pair.shapeB), std::pair(1u, 0u));
  EXPECT_EQ(std::pair(pair.bodyA, pair.bodyB), std::pair(0, kFixed));
  const PredictedManifold manifold = manifoldOfPair(bodies);
  ASSERT_EQ(manifold.count, 1u);
  EXPECT_LT((manifold.normal + Vec3::UnitY()).norm(), 1e-15);  // from the sphere down
  EXPECT_NEAR(manifold.points[0].separation, 1e-3, 1e-15);
  EXPECT_LT((manifold.points[0].onA - Vec3(0, 0.101, 0)).norm(), 1e-15);
  EXPECT_LT((manifold.points[0].onB - Vec3(0, 0.1, 0)).norm(), 1e-15);
}

/// Each shape over a slanting plane, turned and with its centre of mass beside its middle: where its lowest point is
/// follows from its support value.
struct OverPlane : PosedBodies {
  OverPlane(const Collider& collider, double gap) {
    const Vec3 normal = Vec3(0.2, 1, -0.3).normalized();
    geometry.planes = {{Vec3(0.5, 0.1, 0), normal, 0}};
    geometry.pairs = {{0, 0, true, {}}};
    const Vec3 down = kTurn.conjugate() * -normal;
    double reach = -INFINITY;
    for (const Vec3& point : collider.points) reach = std::max(reach, down.dot(point) + collider.radius);
    add(collider, geometry.planes[0].point + (reach + gap) * normal + Vec3(0.3, 0, 0.2), kTurn);
    const Vec3 place = geometry.planes[0].point + (reach + gap) * normal;
    const Vec3 along = Vec3(0.3, 0, 0.2) - normal.dot(Vec3(0.3, 0, 0.2)) * normal;
    move(0, place + along - (place + Vec3(0.3, 0, 0.2)));
  }
};

TEST(SoftManifolds, OfAPlaneAreAsFarAsTheLowestPoint) {
  const RigidTransform beside{Quat::Identity(), Vec3(0.02, -0.01, 0.03)};
  for (const Collider& collider :
       {colliderOf(Sphere{0.1}, beside), colliderOf(Capsule{0.06, 0.2}, beside),
        colliderOf(Box{Vec3(0.2, 0.3, 0.1)}, beside),
        colliderOf(convexHullOf({{0, 0, 0}, {0.2, 0, 0}, {0, 0.1, 0}, {0, 0, 0.3}}), beside)})
    for (const double gap : {-2e-3, 0.0, 3e-3}) {
      const OverPlane bodies(collider, gap);
      const PredictedManifold manifold = manifoldOfPair(bodies);
      ASSERT_GT(manifold.count, 0u);
      EXPECT_NEAR(deepestOf(manifold), gap, 1e-15);
      EXPECT_LT((manifold.normal + bodies.geometry.planes[0].normal).norm(), 1e-15);
      for (std::size_t i = 0; i < manifold.count; ++i) {
        const auto& point = manifold.points[i];
        EXPECT_NEAR(manifold.normal.dot(point.onB - point.onA), point.separation, 1e-15);
      }
    }
}

// Farther apart than the margin, and what a spin may close of it in the step, there is none, and all clearance.
TEST(SoftManifolds, AreEmptyBeyondTheMargin) {
  const Collider box = colliderOf(Box{Vec3(0.2, 0.3, 0.1)}, {});
  for (const double spin : {0.0, 10.0}) {
    const double margin = PosedBodies::kMargin + PosedBodies::kTimeStep * spin * box.boundingRadius;
    for (const double part : {0.99, 1.01}) {
      OverPlane bodies(box, part * margin);
      bodies.poses[0].angularVelocity = Vec3(0, spin, 0);
      bodies.place();
      const PredictedManifold manifold = manifoldOfPair(bodies);
      EXPECT_EQ(manifold.count > 0, part < 1) << spin;
      if (part > 1) {
        EXPECT_LE(manifold.clearance, part * margin);
        EXPECT_GE(manifold.clearance, margin);
      }
    }
  }
}

// Spheres that are farther apart than the margin touch if they meet within the step.
TEST(SoftManifolds, SeeAhead) {
  for (const double part : {0.99, 1.01}) {
    PosedBodies bodies;
    const double speed = 6, gap = speed * PosedBodies::kTimeStep;
    bodies.add(colliderOf(Sphere{0.1}, {}), Vec3::Zero(), kTurn, Vec3(speed, 0, 0));
    bodies.add(colliderOf(Sphere{0.2}, {}), Vec3(0.3 + part * gap, 0, 0), kTurn);
    bodies.geometry.pairs = {{0, 1, false, {}}};
    bodies.place();
    const PredictedManifold manifold = manifoldOfPair(bodies);
    EXPECT_EQ(manifold.count, part < 1 ? 1u : 0u);
  }
}

// All pairs of quick shapes, and a capsule with a box and a cylinder, which take the general search: the gap along x is
// what their support values leave.
TEST(SoftManifolds, OfAllShapesAreAsFarAsSupportPointsTell) {
  const std::vector<Collider> shapes = {colliderOf(Sphere{0.1}, {}), colliderOf(Box{Vec3(0.2, 0.3, 0.1)}, {}),
                                        colliderOf(Capsule{0.06, 0.2}, {}), colliderOf(Cylinder{0.1, 0.3}, {})};
  const Quat aQuarter = rotationAbout(Vec3::UnitZ(), 1.5707963267948966);
  const double reaches[] = {0.1, 0.15, 0.16, 0.15};  // m, along x, of what has turned so that y is x
  for (std::size_t a = 0; a < shapes.size(); ++a)
    for (std::size_t b = 0; b < shapes.size(); ++b)
      for (const double gap : {-1e-3, 2e-3}) {
        PosedBodies bodies;
        bodies.add(shapes[a], Vec3::Zero(), aQuarter);
        bodies.add(shapes[b], Vec3(reaches[a] + reaches[b] + gap, 0.01, -0.02), aQuarter);
        bodies.geometry.pairs = {{0, 1, false, {}}};
        bodies.place();
        if (shapes[a].radius > 0 && shapes[b].radius > 0) bodies.move(1, Vec3(0, -0.01, 0.02));  // no flat face
        const PredictedManifold manifold = manifoldOfPair(bodies);
        ASSERT_GT(manifold.count, 0u) << a << " " << b;
        EXPECT_NEAR(deepestOf(manifold), gap, 1e-12) << a << " " << b;  // roots of EPA and GJK
        EXPECT_GT(manifold.normal.x(), 1 - 1e-9) << a << " " << b;
      }
}

// A frustum has eight corners and six faces as a box has, numbered alike: of its side that slants the plane touches the
// lower corners.
TEST(SoftManifolds, DoNotTakeAFrustumForABox) {
  std::vector<Vec3> corners;
  for (const double z : {-0.1, 0.1})
    for (const double y : {-0.1, 0.1})
      for (const double x : {-0.1, 0.1}) corners.push_back(Vec3(z > 0 ? 0.6 * x : x, z > 0 ? 0.6 * y : y, z));
  const Collider frustum = colliderOf(convexHullOf(corners), {});
  ASSERT_EQ(frustum.polytope->vertices.size(), 8u);
  ASSERT_EQ(frustum.polytope->faces.size(), 6u);
  for (const double gap : {-1e-3, 2e-3}) {
    const PredictedManifold manifold = manifoldOfPair(OverPlane(frustum, gap));
    ASSERT_GT(manifold.count, 0u);
    EXPECT_NEAR(deepestOf(manifold), gap, 1e-15);
  }
}

}  // namespace
}  // namespace cradle
