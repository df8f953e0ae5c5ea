#include "collision/mesh_feature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "collision/triangle_soup.h"

// Which feature of a mesh a ball touches, against its nearest point found triangle by triangle.

namespace cradle {
namespace {

using Feature = MeshPoint::Feature;

TEST(InsideRegion, IsThatOfTheNearestFeatureAlone) {
  const TriangleMesh mesh = crumpledSheet(2);
  const MeshSurface sheet = sheetOf(mesh);
  RandomPoses random(4);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 point = Vec3(2, 0, 2) + random.vector(2.6);
    const MeshPoint nearest = nearestPoint(sheet, point);
    EXPECT_NEAR(std::sqrt(nearest.distance2), distanceTo(mesh, point), 1e-14);
    const double inside = insideRegion(sheet, {nearest.feature, nearest.index}, point);
    EXPECT_GE(inside, -1e-14);
    // It changes no faster than the point moves, and the way out of it leads to where another feature is nearest.
    const Vec3 moved = point + random.vector(0.1);
    EXPECT_LE(std::abs(insideRegion(sheet, {nearest.feature, nearest.index}, moved) - inside),
              (moved - point).norm() + 1e-14);
  }
}

// What is left out is behind the tangent plane at the nearest feature, so that it cannot be nearer than that.
TEST(DistanceBeside, IsThatOfAllTrianglesInFrontOfATangentPlane) {
  for (unsigned seed = 5; seed < 15; ++seed) {
    const TriangleMesh mesh = crumpledSheet(seed);
    const MeshSurface sheet = sheetOf(mesh);
    RandomPoses random(seed);
    for (int i = 0; i < 200; ++i) {
      const Vec3 point = Vec3(2, 0, 2) + random.vector(2.6);
      const MeshPoint nearest = nearestPoint(sheet, point);
      TouchedFeature touched{nearest.feature, nearest.index};
      if (touched.feature == Feature::face && (point - nearest.point).dot(nearest.normal) < 0)
        touched.index = (touched.index + 32) % 64;  // the side that is touched
      // Edges and vertices inside are there twice, one of them facing the point.
      if (touched.feature != Feature::face && (point - nearest.point).dot(nearest.normal) < 0) continue;
      const double beside = distanceBeside(sheet, {spaceBehind(sheet, touched)}, point, 10);
      EXPECT_GE(beside, std::sqrt(nearest.distance2) - 1e-14);
      double expected = INFINITY;
      for (const Triangle& triangle : mesh.triangles) {
        const bool isAhead = std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t vertex) {
          const auto space = spaceBehind(sheet, touched);
          return std::any_of(space.begin(), space.end(), [&](const HalfSpace& half) {
            return half.normal.dot(mesh.vertices[vertex]) > half.offset + 1e-7;
          });
        });
        if (isAhead) expected = std::min(expected, distanceTo(mesh, triangle, point));
      }
      EXPECT_NEAR(std::min(beside, 10.0), std::min(expected, 10.0), 1e-12);
    }
  }
}

}  // namespace
}  // namespace cradle
