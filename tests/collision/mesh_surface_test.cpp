#include "collision/mesh_surface.h"

#include <gtest/gtest.h>

#include "collision/mesh_nearest.h"
#include "collision/triangle_soup.h"
#include "rounding.h"

namespace cradle {
namespace {

// An L-shaped prism: 8 flat sides, 18 edges between them, one of them in the inner corner; the others divide sides.
TEST(SurfaceOf, KnowsTheEdgesOfASolidFromTheDiagonalsOfItsSides) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    const MeshSurface prism = surfaceOf(moved(lPrismMesh(), [&](const Vec3& v) { return Vec3(size * v); }));
    EXPECT_EQ(prism.vertices.size() - prism.edges.size() + prism.faces.size(), 2u);  // Euler
    int convex = 0, inner = 0;
    for (const MeshSurface::Edge& edge : prism.edges) {
      const Vec3 mean = prism.faces[edge.faces[0]].normal + prism.faces[edge.faces[1]].normal;
      EXPECT_LT((edge.normal - mean.normalized()).norm(), 4 * kEpsilon);
      const bool isFlat = mean.norm() > 2 - 1e-9;
      const auto isInner = [&](std::uint32_t v) {
        return prism.vertices[v].head<2>() == size * Vec3(1, 1, 0).head<2>();
      };
      const bool isInnerCorner = !isFlat && isInner(edge.vertices[0]) && isInner(edge.vertices[1]);
      EXPECT_EQ(edge.isConvex, !isFlat && !isInnerCorner);
      convex += edge.isConvex, inner += isInnerCorner;
    }
    EXPECT_EQ(convex, 17);
    EXPECT_EQ(inner, 1);
    EXPECT_EQ(prism.firstBorder.size(), 8u + 1);
    EXPECT_EQ(prism.borders.size(), 2u * 18);
    EXPECT_FALSE(prism.inner);
    EXPECT_NEAR(prism.size, size * std::sqrt(9 + 4 + 1), 4 * kEpsilon * size);
  }
}

TEST(SurfaceOf, NamesNeighboursAndOwnersOnce) {
  RandomPoses random(1);
  const MeshSurface lump = surfaceOf(lumpMesh(random));
  std::vector<int> vertexOwners(lump.vertices.size(), 0), edgeOwners(lump.edges.size(), 0);
  for (std::uint32_t index = 0; index < lump.faces.size(); ++index) {
    const MeshSurface::Face& face = lump.faces[index];
    for (std::size_t i = 0; i < 3; ++i) {
      vertexOwners[face.vertices[i]] += face.ownsVertex[i], edgeOwners[face.edges[i]] += face.ownsEdge[i];
      const MeshSurface::Edge& edge = lump.edges[face.edges[i]];
      EXPECT_EQ(std::minmax(edge.vertices[0], edge.vertices[1]),
                std::minmax(face.vertices[i], face.vertices[(i + 1) % 3]));
      const std::size_t side = edge.faces[0] == index ? 0 : 1;
      EXPECT_EQ(edge.faces[side], index);
      EXPECT_EQ(edge.across[side], face.vertices[(i + 2) % 3]);
    }
  }
  EXPECT_EQ(std::count(vertexOwners.begin(), vertexOwners.end(), 1), std::ssize(vertexOwners));
  EXPECT_EQ(std::count(edgeOwners.begin(), edgeOwners.end(), 1), std::ssize(edgeOwners));
  for (std::uint32_t v = 0; v < lump.vertices.size(); ++v) {
    std::vector<std::uint32_t> expected;
    for (const MeshSurface::Edge& edge : lump.edges)
      for (const std::size_t end : {0u, 1u})
        if (edge.vertices[end] == v) expected.push_back(edge.vertices[1 - end]);
    const auto from = lump.neighbours.begin() + lump.firstNeighbour[v];
    EXPECT_EQ(std::vector<std::uint32_t>(from, lump.neighbours.begin() + lump.firstNeighbour[v + 1]), expected);
  }
}

// Three right angles meet at a corner of a box, however its sides are divided: the mean weighted by angle is along
// (1, 1, 1). A mean over triangles would count divided sides twice.
TEST(SurfaceOf, WeighsTheNormalsOfAVertexByAngle) {
  const MeshSurface box = surfaceOf(boxMesh(Vec3(1, 20, 0.3)));
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3 expected = box.vertices[v].cwiseSign() / std::sqrt(3);
    EXPECT_LT((box.vertexNormals[v] - expected).norm(), 1e-7);  // angleBetween
  }
  const MeshSurface prism = surfaceOf(lPrismMesh());
  for (std::size_t v = 0; v < prism.vertices.size(); ++v) {
    const Vec3& at = prism.vertices[v];
    if (at.x() == 1 && at.y() == 1) continue;  // the inner corner
    const Vec3 expected = Vec3(at.x() > 0 ? 1 : -1, at.y() > 0 ? 1 : -1, at.z() > 0 ? 1 : -1) / std::sqrt(3);
    EXPECT_LT((prism.vertexNormals[v] - expected).norm(), 1e-7);
  }
  ASSERT_TRUE(box.inner);
  EXPECT_LT(box.inner->norm(), 4 * kEpsilon);
  const MeshSurface two =
      surfaceOf(joined(boxMesh(Vec3::Ones()),
                       moved(boxMesh(Vec3::Ones()), [](const Vec3& v) { return Vec3(v.x() + 2, v.y(), v.z()); })));
  EXPECT_EQ(two.parts.size(), 2u);
  EXPECT_FALSE(two.inner);  // between them is not inside
}

TEST(SheetOf, HasTwoSidesThatMeetAtItsBorder) {
  const TriangleMesh mesh = crumpledSheet(1);
  const MeshSurface sheet = sheetOf(mesh);
  EXPECT_TRUE(sheet.isSheet);
  ASSERT_EQ(sheet.faces.size(), 2 * mesh.triangles.size());
  // 16 edges around; 40 of squares and 16 diagonals less these, on both sides.
  EXPECT_EQ(std::count_if(sheet.edges.begin(), sheet.edges.end(), [](const auto& edge) { return edge.isBorder; }), 16);
  EXPECT_EQ(sheet.edges.size(), 16u + 2 * (40 - 16 + 16));
  EXPECT_EQ(sheet.vertices.size(), 16u + 2 * 9);  // Euler: 34 - 96 + 64 = 2, a sphere
  EXPECT_EQ(sheet.parts.size(), 1u);
  for (const MeshSurface::Edge& edge : sheet.edges) {
    for (const std::uint32_t face : edge.faces)
      for (const std::uint32_t end : edge.vertices)
        EXPECT_EQ(std::count(sheet.faces[face].vertices.begin(), sheet.faces[face].vertices.end(), end), 1);
    const double towardsMiddle = edge.normal.dot(Vec3(2, 0, 2) - sheet.vertices[edge.vertices[0]]);
    EXPECT_TRUE(!edge.isBorder || towardsMiddle < 0);
  }
}

// Three sheets that meet at one line: each has two sides there.
TEST(SheetOf, TakesSheetsThatMeetAtOneEdge) {
  TriangleMesh book{{{0, 0, 0}, {1, 0, 0}}, {}};
  for (const auto& [y, z] : {std::pair(1.0, 0.0), {-0.5, 0.8}, {-0.5, -0.8}}) {
    book.vertices.emplace_back(0.5, y, z);
    book.triangles.push_back({0, 1, static_cast<std::uint32_t>(book.vertices.size() - 1)});
  }
  const MeshSurface sheet = sheetOf(book);
  EXPECT_EQ(sheet.faces.size(), 6u);
  RandomPoses random(3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 point = random.vector(1.5);
    EXPECT_NEAR(heightOver(sheet, point).height, distanceTo(book, point), 1e-14);
  }
}

}  // namespace
}  // namespace cradle
