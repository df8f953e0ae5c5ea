#include "collision/mesh_nearest.h"

#include <gtest/gtest.h>

#include "collision/triangle_soup.h"
#include "rounding.h"

namespace cradle {
namespace {

using Feature = MeshPoint::Feature;

// The distance is that of the nearest of all triangles, the sign that of the solid angle, at any size and far away.
TEST(HeightOver, IsTheDistanceOfAllTrianglesWithTheSignOfTheSolidAngle) {
  RandomPoses random(1);
  const TriangleMesh solids[] = {lumpMesh(random), lPrismMesh()};
  for (const double size : {1.0, 1e-6, 1e6})
    for (const TriangleMesh& solid : solids) {
      const TriangleMesh mesh = moved(solid, [&](const Vec3& v) { return Vec3(size * v); });
      const MeshSurface surface = surfaceOf(mesh);
      const std::vector<Corners> corners = cornersOf(mesh, {});
      int inside = 0;
      for (int i = 0; i < 150; ++i) {
        const Vec3 point = size * random.vector(i % 10 ? 1.2 : 100);
        const SignedHeight found = heightOver(surface, point);
        const double rounding = 16 * kEpsilon * (size + point.norm());
        EXPECT_NEAR(std::abs(found.height), distanceTo(mesh, point), rounding);
        EXPECT_EQ(found.height<0, windingAround(point, corners)> 0.5);
        inside += found.height < 0;
        EXPECT_NEAR(found.normal.norm(), 1, 4 * kEpsilon);
        EXPECT_LT((found.nearest + found.height * found.normal - point).norm(),
                  rounding + 1e-6 * std::abs(found.height));
        EXPECT_NEAR(distanceTo(mesh, found.nearest), 0, rounding);
      }
      EXPECT_GT(inside, 3);
    }
}

// Straight over a side, an edge and a corner of a box, at it and under it: which feature, and its normal.
TEST(NearestPoint, TellsTheFeatureAndItsNormal) {
  const MeshSurface box = surfaceOf(boxMesh(Vec3(2, 4, 6)));
  for (const double height : {0.5, 1e-9, 0.0}) {
    const MeshPoint face = nearestPoint(box, Vec3(1 + height, 0.3, 0.7));
    EXPECT_EQ(face.feature, Feature::face);
    EXPECT_EQ(face.normal, Vec3::UnitX());
    EXPECT_LT((face.point - Vec3(1, 0.3, 0.7)).norm(), 8 * kEpsilon);
    EXPECT_EQ(box.faces[face.index].normal, Vec3::UnitX());
    const MeshPoint edge = nearestPoint(box, Vec3(1 + height, 2 + height, 0.7));
    EXPECT_LT((edge.point - Vec3(1, 2, 0.7)).norm(), 8 * kEpsilon);
    const MeshPoint corner = nearestPoint(box, Vec3(1 + height, 2 + height, -3 - height));
    EXPECT_LT((corner.point - Vec3(1, 2, -3)).norm(), 8 * kEpsilon);
    if (height == 0) continue;  // in the plane of a side its point is as near as the edge
    EXPECT_EQ(edge.feature, Feature::edge);
    EXPECT_LT((edge.normal - Vec3(1, 1, 0).normalized()).norm(), 4 * kEpsilon);
    EXPECT_EQ(corner.feature, Feature::vertex);
    EXPECT_LT((corner.normal - Vec3(1, 1, -1).normalized()).norm(), 1e-7);  // angles of triangles
    EXPECT_EQ(box.vertices[corner.index], Vec3(1, 2, -3));
  }
  EXPECT_EQ(nearestPoint(box, Vec3(2, 0, 0), 1.01).feature, Feature::face);
  EXPECT_EQ(nearestPoint(box, Vec3(2, 0, 0), 0.99).feature, Feature::none);
}

// Beside the reflex edge of an L and in the middle between its sides the nearest point may be on either, but inside
// stays inside: pseudo-normals decide where a face's normal would be wrong.
TEST(HeightOver, TellsInsideFromOutsideAtSharpAndReflexEdges) {
  const MeshSurface prism = surfaceOf(lPrismMesh());
  for (const double part : {1e-3, 1e-9, 1e-13}) {
    EXPECT_NEAR(heightOver(prism, Vec3(1 + part, 1 + part, 0.5)).height, part, 2 * kEpsilon);
    EXPECT_NEAR(heightOver(prism, Vec3(1 - part, 1 - part, 0.5)).height, -part * std::sqrt(2), 4 * kEpsilon);
    EXPECT_NEAR(heightOver(prism, Vec3(3 + part, 1 + part, 0.5)).height, part * std::sqrt(2), 8 * kEpsilon);
    EXPECT_NEAR(heightOver(prism, Vec3(3 - part, 1 - part, 0.5)).height, -part, 8 * kEpsilon);
  }
  // At a flat thin wedge the outside of one side is nearer than the other's.
  const TriangleMesh wedge =
      moved(boxMesh(Vec3(2, 2, 2)), [](const Vec3& v) { return Vec3(v.x(), 1e-3 * v.y() * (1 + v.x()), v.z()); });
  const MeshSurface thin = surfaceOf(wedge);
  EXPECT_GT(heightOver(thin, Vec3(-1.1, 0, 0.1)).height, 0);
  EXPECT_LT(heightOver(thin, Vec3(0.5, 1e-3, 0.1)).height, 0);
}

// Nothing is inside a sheet: heights are positive on both sides, normals lead to the point.
TEST(HeightOver, OverASheetIsPositiveOnBothSides) {
  const MeshSurface sheet = sheetOf({{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}});
  for (const double y : {0.3, -0.3, 1e-12, -1e-12}) {
    const SignedHeight found = heightOver(sheet, Vec3(0.2, y, 0.2));
    EXPECT_NEAR(found.height, std::abs(y), kEpsilon);
    EXPECT_EQ(found.normal, Vec3(0, y > 0 ? 1 : -1, 0));
  }
  const SignedHeight beside = heightOver(sheet, Vec3(0.4, 0, -0.3));
  EXPECT_NEAR(beside.height, 0.3, kEpsilon);
  EXPECT_LT((beside.normal + Vec3::UnitZ()).norm(), 4 * kEpsilon);
}

}  // namespace
}  // namespace cradle
