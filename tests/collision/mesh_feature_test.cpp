#include "collision/mesh_feature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "collision/random_poses.h"

// Which feature of a mesh a ball touches, against its nearest point found triangle by triangle.

namespace cradle {
namespace {

using Feature = MeshPoint::Feature;

/// Ground of 4 x 4 squares of 1 m whose inner corners are lifted at random; two of the squares stay in one plane.
TriangleMesh crumpledSheet(unsigned seed) {
  RandomPoses random(seed);
  TriangleMesh mesh;
  for (int i = 0; i <= 4; ++i)
    for (int k = 0; k <= 4; ++k) mesh.vertices.emplace_back(i, i > 0 ? random.number(-0.5, 0.5) : 0.0, k);
  for (std::uint32_t i = 0; i < 4; ++i)
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t at = 5 * i + k;
      mesh.triangles.push_back({at, at + 1, at + 6});
      // Not wound alike: a sheet need not be.
      mesh.triangles.push_back((i + k) % 2 ? Triangle{at, at + 6, at + 5} : Triangle{at, at + 5, at + 6});
    }
  return mesh;
}

double distanceTo(const TriangleMesh& mesh, const Triangle& triangle, const Vec3& point) {
  const Vec3 &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
  const FlatTriangle flat{a, b, c, (b - a).cross(c - a).normalized()};
  double least = flat.isAbove(point) ? std::abs(flat.heightOf(point)) : INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment side{cornerOf(flat, i), cornerOf(flat, (i + 1) % 3) - cornerOf(flat, i)};
    least = std::min(least, (point - side.at(side.nearestPart(point))).norm());
  }
  return least;
}

double distanceTo(const TriangleMesh& mesh, const Vec3& point) {
  double least = INFINITY;
  for (const Triangle& triangle : mesh.triangles) least = std::min(least, distanceTo(mesh, triangle, point));
  return least;
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
