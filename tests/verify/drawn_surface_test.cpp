#include "verify/drawn_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/primitives.h"

namespace cradle {
namespace {

TEST(DrawnSurface, PointsOnEachFaceOfABoxAreOnItAndOthersAsFarAsTheyAre) {
  const Vec3 size(1, 2, 3);
  const DrawnMesh mesh = tessellate(Box{size});
  const DrawnSurface surface(mesh);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Vec3 point(0.1, 0.7, -0.9);
      const Vec3 normal = side * Vec3::Unit(axis);
      point[axis] = side * size[axis] / 2;
      const auto on = surface.match(point, normal, 1e-6, 0);
      EXPECT_LT(on.distance, 1e-15);
      EXPECT_LT(on.normalDeviation, 1e-15);
      EXPECT_LT(surface.match(point, -normal, 1e-6, 0).normalDeviation, 1e-15);  // seen from both sides
      EXPECT_GT(surface.match(point, Vec3::Unit((axis + 1) % 3), 1e-6, 0).normalDeviation, 1);
      EXPECT_NEAR(surface.match(point + 3e-4 * normal, normal, 1e-6, 0).distance, 3e-4, 1e-15);
      EXPECT_TRUE(std::isinf(surface.match(point + 3e-4 * normal, normal, 1e-6, 0).normalDeviation));
    }
}

TEST(DrawnSurface, BesideAnEdgeTheDistanceIsThatOfTheEdge) {
  const DrawnMesh mesh = tessellate(Box{Vec3(2, 2, 2)});
  const DrawnSurface surface(mesh);
  EXPECT_NEAR(surface.match(Vec3(1.003, 1.004, 0.2), Vec3::UnitX(), 1e-4, 0).distance, 0.005, 1e-12);
}

/// A chord between two of 64 vertices around misses the sphere by r (1 - cos(pi / 64)) at most.
TEST(DrawnSurface, FacetsOfASphereAreInsideOfIt) {
  const DrawnMesh mesh = tessellate(Sphere{1});
  const DrawnSurface surface(mesh);
  for (int i = 0; i < 100; ++i) {
    const Vec3 direction = Vec3(std::cos(i), std::sin(1.7 * i), std::cos(0.3 * i + 1)).normalized();
    const double distance = surface.match(direction, direction, 1e-4, 0).distance;
    EXPECT_LT(distance, 2 * (1 - std::cos(M_PI / 64)));  // in both directions around
  }
}

}  // namespace
}  // namespace cradle
