#include "collision/collider.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "collision/contact_point.h"
#include "collision/mesh_surface.h"
#include "math/rotation.h"
#include "mesh/sample_meshes.h"

namespace cradle {
namespace {

constexpr double kPlaceRounding = 1e-14;  // m, of coordinates of a few m

Collider colliderOfMesh(const TriangleMesh& mesh, bool isSheet) {
  Collider collider;
  collider.points = mesh.vertices, collider.boundingRadius = 17;
  collider.mesh = std::make_shared<const MeshSurface>(isSheet ? sheetOf(mesh) : surfaceOf(mesh));
  return collider;
}

// Along a unit vector u a box reaches by the sum of |u_i| halves, a cylinder by |u.a| L / 2 + R sqrt(1 - (u.a)^2), a
// capsule by |u.a| L / 2 + R: along x, y and z these are half of the bounds. The bounding radius is about the body's
// origin.
TEST(Collider, IsBoundedByItsShape) {
  const RigidTransform place = askew();
  const Mat3 turn = place.rotation.toRotationMatrix();
  const auto expectBounds = [&](const Collider& collider, const Vec3& half) {
    EXPECT_LT((collider.bounds.center() - place.translation).norm(), kPlaceRounding);
    EXPECT_LT((collider.bounds.sizes() / 2 - half).norm(), kPlaceRounding);
  };
  const Vec3 along = turn.col(1).cwiseAbs(), across = (Vec3::Ones() - along.cwiseAbs2()).cwiseSqrt();
  const Collider sphere = colliderOf(Sphere{0.3}, place);
  expectBounds(sphere, Vec3::Constant(0.3));
  EXPECT_NEAR(sphere.boundingRadius, place.translation.norm() + 0.3, kPlaceRounding);
  const Collider box = colliderOf(Box{Vec3(0.4, 0.6, 1)}, place);
  expectBounds(box, turn.cwiseAbs() * Vec3(0.2, 0.3, 0.5));
  const Collider capsule = colliderOf(Capsule{0.2, 0.7}, place);
  expectBounds(capsule, 0.35 * along + Vec3::Constant(0.2));
  const Vec3 end = 0.35 * turn.col(1);
  EXPECT_NEAR(capsule.boundingRadius,
              std::max((place.translation + end).norm(), (place.translation - end).norm()) + 0.2, kPlaceRounding);
  const Collider cylinder = colliderOf(Cylinder{0.2, 0.7}, place);
  expectBounds(cylinder, 0.35 * along + 0.2 * across);

  EXPECT_EQ(sphere.kind(), ColliderKind::sphere);
  EXPECT_EQ(box.kind(), ColliderKind::polytope);
  EXPECT_EQ(capsule.kind(), ColliderKind::capsule);
  EXPECT_EQ(cylinder.kind(), ColliderKind::cylinder);
}

// About the middle: half the diagonals.
TEST(Collider, HasTheRadiusOfItsFarthestPoint) {
  EXPECT_NEAR(colliderOf(Box{Vec3(0.4, 0.6, 1)}, {}).boundingRadius, Vec3(0.2, 0.3, 0.5).norm(), 1e-15);
  EXPECT_NEAR(colliderOf(Cylinder{0.2, 0.7}, {}).boundingRadius, std::hypot(0.2, 0.35), 1e-15);
  EXPECT_NEAR(colliderOf(Capsule{0.2, 0.7}, {}).boundingRadius, 0.55, 1e-15);
  // Of a disc beside the axis: the farthest point of the rim is beyond.
  const Collider beside = colliderOf(Cylinder{0.2, 0.7}, {Quat::Identity(), Vec3(0.3, 0.1, 0.4)});
  EXPECT_NEAR(beside.boundingRadius, std::hypot(0.5 + 0.2, 0.1 + 0.35), 1e-15);
}

/// Signed distances of a point from shapes along y, in their own frame.
double outsideSphere(const Vec3& p) {
  return p.norm() - 0.3;
}
double outsideCapsule(const Vec3& p) {
  return Vec3(p.x(), std::max(0.0, std::abs(p.y()) - 0.35), p.z()).norm() - 0.2;
}
double outsideCylinder(const Vec3& p) {
  const double side = std::hypot(p.x(), p.z()) - 0.2, end = std::abs(p.y()) - 0.35;
  return side > 0 && end > 0 ? std::hypot(side, end) : std::max(side, end);
}

// The nearest point is as far away as the distance says, along the normal, and on the surface.
TEST(Collider, HasTheNearestPointOfItsSurface) {
  const RigidTransform place = askew();
  const std::pair<Collider, double (*)(const Vec3&)> shapes[] = {
      {colliderOf(Sphere{0.3}, place), outsideSphere},
      {colliderOf(Capsule{0.2, 0.7}, place), outsideCapsule},
      {colliderOf(Cylinder{0.2, 0.7}, place), outsideCylinder}};
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> number(-0.6, 0.6);
  for (const auto& [collider, outside] : shapes) {
    int inside = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 local(number(engine), number(engine), number(engine)), point = place * local;
      const SurfacePoint found = nearestSurfacePoint(collider, point);
      EXPECT_NEAR(found.distance, outside(local), kPlaceRounding);
      EXPECT_NEAR(found.normal.norm(), 1, kPlaceRounding);
      EXPECT_LT((found.nearest + found.distance * found.normal - point).norm(), kPlaceRounding);
      EXPECT_NEAR(outside(place.inverse() * found.nearest), 0, kPlaceRounding);
      inside += found.distance < 0;
    }
    EXPECT_GT(inside, 10);
  }
}

// A sphere's surface has its radius, so have the ends of a capsule, whose side is no sphere; an end of a cylinder is
// flat.
TEST(Collider, TellsTheRadiusOfItsSurface) {
  const auto radiusAt = [](const Collider& collider, const Vec3& point) {
    return nearestSurfacePoint(collider, point).radius;
  };
  EXPECT_EQ(radiusAt(colliderOf(Sphere{0.3}, {}), Vec3(1, 1, 1)), 0.3);
  const Collider capsule = colliderOf(Capsule{0.2, 0.7}, {}), cylinder = colliderOf(Cylinder{0.2, 0.7}, {});
  EXPECT_EQ(radiusAt(capsule, Vec3(1, 0.4, 0)), 0.2);
  EXPECT_EQ(radiusAt(capsule, Vec3(1, -0.4, 0)), 0.2);
  EXPECT_TRUE(std::isnan(radiusAt(capsule, Vec3(1, 0.3, 0))));
  EXPECT_EQ(radiusAt(cylinder, Vec3(0.1, 1, 0)), kFlat);
  EXPECT_TRUE(std::isnan(radiusAt(cylinder, Vec3(1, 0.3, 0))));
  EXPECT_TRUE(std::isnan(radiusAt(cylinder, Vec3(1, 1, 0))));
}

// The centre of a pyramid's bounds is outside of it, that of a wedge's in its slope. The mean of the corners is a
// quarter of the way to each face of the pyramid from its opposite corner, a third in the wedge's section.
TEST(InnerRadius, IsPositiveWhereTheCentreOfTheBoundsIsOutside) {
  const ConvexHull pyramid = convexHullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  const ConvexHull wedge = convexHullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 3}, {1, 0, 3}, {0, 1, 3}});
  EXPECT_NEAR(innerRadius(colliderOf(pyramid, {})), 0.25 / std::sqrt(3), kPlaceRounding);
  EXPECT_NEAR(innerRadius(colliderOf(wedge, {})), 1 / (3 * std::sqrt(2)), kPlaceRounding);
  // Turned, they have other bounds, whose centre may be deeper.
  EXPECT_GT(innerRadius(colliderOf(pyramid, askew())), 0.25 / std::sqrt(3) - kPlaceRounding);
  EXPECT_GT(innerRadius(colliderOf(wedge, askew())), 1 / (3 * std::sqrt(2)) - kPlaceRounding);
}

// Around the middle, half of the least width. Of a mesh its volume by its surface: a^3 / (6 a^2) of a cube.
TEST(InnerRadius, IsThatOfASphereInside) {
  const RigidTransform place = askew();
  EXPECT_NEAR(innerRadius(colliderOf(Sphere{0.3}, place)), 0.3, kPlaceRounding);
  EXPECT_NEAR(innerRadius(colliderOf(Box{Vec3(0.4, 0.6, 1)}, place)), 0.2, kPlaceRounding);
  EXPECT_NEAR(innerRadius(colliderOf(Capsule{0.2, 0.7}, place)), 0.2, kPlaceRounding);
  EXPECT_NEAR(innerRadius(colliderOf(Cylinder{0.2, 0.7}, place)), 0.2, kPlaceRounding);
  EXPECT_NEAR(innerRadius(colliderOf(Cylinder{0.2, 0.3}, place)), 0.15, kPlaceRounding);
  const TriangleMesh cube = moved(boxMesh(Vec3::Constant(0.9)), [&](const Vec3& vertex) { return place * vertex; });
  EXPECT_NEAR(innerRadius(colliderOfMesh(cube, false)), 0.9 / 6, kPlaceRounding);
  EXPECT_EQ(innerRadius(colliderOfMesh(cube, true)), std::numeric_limits<double>::infinity());
}

TEST(SmallestSize, IsThatOfWhatMoves) {
  ContactGeometry geometry;
  for (const double radius : {0.5, 0.2, 0.3}) geometry.colliders.push_back(colliderOf(Sphere{radius}, {}));
  EXPECT_EQ(smallestSize(geometry), 1);
  geometry.colliders[0].body = 0, geometry.colliders[2].body = 1;
  EXPECT_EQ(smallestSize(geometry), 0.3);
}

// A ball joint keeps its anchor, a hinge all of its axis: points within the tolerance of that.
TEST(Pins, AreTheAnchorsOfBallJointsAndTheAxesOfHinges) {
  Collider collider = colliderOf(Box{Vec3::Ones()}, {});
  const Vec3 anchor(0.2, 0.3, -0.1), axis(2.0 / 3, -1.0 / 3, 2.0 / 3), across = axis.unitOrthogonal();
  for (const bool isHinge : {false, true}) {
    collider.pins = {{4, anchor, isHinge ? axis : Vec3::Zero()}};
    for (const double part : {0.99, 1.01}) {
      EXPECT_EQ(isPinned(collider, 4, anchor + part * 1e-3 * across, 1e-3), part < 1);
      EXPECT_EQ(isPinned(collider, 4, anchor - 7 * axis + part * 1e-3 * across, 1e-3), isHinge && part < 1);
    }
    EXPECT_FALSE(isPinned(collider, kFixed, anchor, 1e-3));
  }
}

}  // namespace
}  // namespace cradle
