#include "mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/primitives.h"

namespace cradle {
namespace {

TEST(Weld, JoinsBitEqualVerticesInOrderOfAppearance) {
  const std::vector<Vec3> vertices{{1, 2, 3}, {4, 5, 6}, {1, 2, 3}, {7, 8, 9}, {4, 5, 6}};
  const TriangleMesh mesh = weld(vertices, {{0, 1, 3}, {2, 3, 4}});
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 1}}));
}

TEST(Weld, MinusZeroIsZero) {
  const TriangleMesh mesh = weld({{0.0, 1, 0}, {-0.0, 1, -0.0}, {1, 0, 0}, {0, 0, 1}}, {{0, 2, 3}, {1, 3, 2}});
  EXPECT_EQ(mesh.vertices.size(), 3U);
  for (const Vec3& vertex : mesh.vertices) EXPECT_FALSE(std::signbit(vertex.x()));
}

TEST(Weld, VerticesThatDifferInTheLastBitStayApart) {
  const double next = std::nextafter(1.0, 2.0);
  EXPECT_EQ(weld({{1, 0, 0}, {next, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}).vertices.size(), 3U);
}

TEST(Weld, DropsTrianglesWithEqualCorners) {
  const TriangleMesh mesh = weld({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}});
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(Weld, WeldedMeshStaysAsItIs) {
  const DrawnMesh drawn = tessellate(Capsule{1, 2}, 64);
  const TriangleMesh once = weld(drawn.vertices, drawn.triangles), twice = weld(once.vertices, once.triangles);
  EXPECT_EQ(once.vertices, twice.vertices);
  EXPECT_EQ(once.triangles, twice.triangles);
}

TEST(Weld, NothingIsNothing) {
  EXPECT_TRUE(weld({}, {}).vertices.empty());
}

}  // namespace
}  // namespace cradle
