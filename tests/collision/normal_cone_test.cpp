#include "collision/normal_cone.h"

#include <gtest/gtest.h>

#include "collision/triangle_soup.h"

namespace cradle {
namespace {

/// How far (m) the vertex of a solid that is farthest along a direction is ahead of a point.
double farthestAhead(const MeshSurface& solid, const Vec3& point, const Vec3& direction) {
  double most = -INFINITY;
  for (const Vec3& vertex : solid.vertices) most = std::max(most, direction.dot(vertex - point));
  return most;
}

/// A convex solid without symmetry.
MeshSurface askewBox() {
  return surfaceOf(moved(boxMesh(Vec3(1, 0.6, 1.4)), [](const Vec3& v) {
    return Vec3(v.x() + 0.3 * v.y(), v.y() + 0.1 * v.z(), v.z() - 0.2 * v.x());
  }));
}

// Of a convex solid a direction is in the cone of a vertex if no other vertex is ahead of it; decided beyond the tilt
// of 1e-5 that counts as behind.
TEST(NormalCone, OfAVertexIsWhereTheWholeSolidIsBehind) {
  const MeshSurface box = askewBox();
  RandomPoses random(1);
  int inCone = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 direction = random.direction();
    int cones = 0;
    for (std::uint32_t vertex = 0; vertex < 8; ++vertex) {
      const double ahead = farthestAhead(box, box.vertices[vertex], direction);
      const bool isIn = isInNormalCone(box, vertex, direction, 0);
      if (ahead == 0) {
        EXPECT_TRUE(isIn);
      }
      if (ahead > 1e-4) {
        EXPECT_FALSE(isIn);
      }
      cones += isIn;
    }
    EXPECT_GE(cones, 1);  // the cones cover all directions
    inCone += cones;
  }
  EXPECT_LE(inCone, 501);
}

TEST(NormalCone, OfAnEdgeIsBetweenItsTwoFaces) {
  const MeshSurface box = askewBox();
  for (const MeshSurface::Edge& edge : box.edges) {
    const Vec3 &one = box.faces[edge.faces[0]].normal, &other = box.faces[edge.faces[1]].normal;
    const Vec3 along = (box.vertices[edge.vertices[1]] - box.vertices[edge.vertices[0]]).normalized();
    for (int i = 0; i < 360; ++i) {
      const Vec3 direction = rotationAbout(along, (i + 0.5) * M_PI / 180) * one;
      // Between the two normals: on the same side of each as the other one.
      const bool isBetween = along.dot(one.cross(direction)) * along.dot(one.cross(other)) > 0 &&
                             along.dot(other.cross(direction)) * along.dot(other.cross(one)) > 0 &&
                             direction.dot(one + other) > 0;
      EXPECT_EQ(isInNormalCone(box, edge, direction, 0), edge.isConvex && isBetween) << i;
    }
  }
}

// Inner edges have no cone: neither of the diagonal of a flat side nor of a reflex edge, whatever is ahead.
TEST(NormalCone, OfInnerEdgesIsEmpty) {
  const MeshSurface prism = surfaceOf(lPrismMesh());
  int inner = 0;
  for (const MeshSurface::Edge& edge : prism.edges) {
    if (edge.isConvex) continue;
    ++inner;
    EXPECT_FALSE(isInNormalCone(prism, edge, edge.normal, 0.1));
  }
  EXPECT_EQ(inner, static_cast<int>(prism.edges.size()) - 17);
  // A vertex at a reflex corner is touched by no plane: some of the solid is ahead.
  RandomPoses random(2);
  for (std::uint32_t v = 0; v < prism.vertices.size(); ++v) {
    if (prism.vertices[v].x() != 1 || prism.vertices[v].y() != 1) continue;
    for (int i = 0; i < 200; ++i) EXPECT_FALSE(isInNormalCone(prism, v, random.direction(), 0));
  }
}

// At the border of a sheet a direction straight over either side is in the cone, and so is all outside between.
TEST(NormalCone, OfABorderIsTheHalfPlaneBesideTheSheet) {
  const MeshSurface sheet = sheetOf({{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 2}}});
  for (const MeshSurface::Edge& edge : sheet.edges) {
    ASSERT_TRUE(edge.isBorder);
    for (const double angle : {0.0, 0.5, 1.57}) {
      const Vec3 direction = std::cos(angle) * edge.normal + std::sin(angle) * Vec3::UnitY();
      EXPECT_TRUE(isInNormalCone(sheet, edge, direction, 0)) << angle;
      EXPECT_TRUE(isInNormalCone(sheet, edge, direction - 2 * direction.y() * Vec3::UnitY(), 0)) << angle;
    }
    EXPECT_TRUE(isInNormalCone(sheet, edge, Vec3::UnitY(), 0));
    EXPECT_FALSE(isInNormalCone(sheet, edge, (Vec3::UnitY() - 0.01 * edge.normal).normalized(), 0));
  }
}

// A margin lets as much be ahead, within tilts of 1e-5 and 0.1 rad.
TEST(NormalCone, AllowsTheMarginAhead) {
  EXPECT_EQ(allowedAhead(0, 2), 2e-5);
  EXPECT_EQ(allowedAhead(0.01, 2), 0.01);
  EXPECT_EQ(allowedAhead(0.5, 2), 0.2);
  const MeshSurface box = surfaceOf(boxMesh(Vec3(2, 2, 2)));
  for (std::uint32_t v = 0; v < 8; ++v) {
    // Tilted off the top by 0.01 rad, away from the corner: 0.02 m of the side is ahead.
    const Vec3 corner = box.vertices[v];
    const Vec3 tilted = Vec3(-0.01 * corner.x(), corner.y(), 0).normalized();
    EXPECT_TRUE(isInNormalCone(box, v, tilted, 0.021));
    EXPECT_FALSE(isInNormalCone(box, v, tilted, 0.019));
  }
}

}  // namespace
}  // namespace cradle
