#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/error.h"
#include "mesh/convex_hull.h"
#include "mesh/primitives.h"

namespace cradle {
namespace {

/// Each directed side once and its opposite once; all points behind every face; Euler's formula.
void expectHullOf(const std::vector<Vec3>& points, const ConvexHull& hull, double tolerance) {
  std::set<std::pair<std::size_t, std::size_t>> sides;
  for (const auto& loop : hull.faces) {
    ASSERT_GE(loop.size(), 3u);
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::size_t from = loop[i], to = loop[(i + 1) % loop.size()];
      EXPECT_TRUE(sides.insert({from, to}).second);
      area += (hull.vertices[from] - hull.vertices[loop[0]]).cross(hull.vertices[to] - hull.vertices[loop[0]]);
    }
    for (const Vec3& point : points) EXPECT_LE(area.normalized().dot(point - hull.vertices[loop[0]]), tolerance);
  }
  for (const auto& [from, to] : sides) EXPECT_TRUE(sides.contains({to, from}));
  EXPECT_EQ(hull.vertices.size() + hull.faces.size(), sides.size() / 2 + 2);
}

class Random {
 public:
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  Vec3 vector(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }

 private:
  std::mt19937 engine_{3};
};

// Points all over the faces, edges and inside of a box: the hull is its corners, six faces and no more.
TEST(ConvexHull, OfPointsAllOverABoxIsTheBox) {
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  for (const bool isTurned : {false, true}) {
    std::vector<Vec3> points;
    for (int x = -3; x <= 3; ++x)
      for (int y = -3; y <= 3; ++y)
        for (int z = -3; z <= 3; ++z)
          points.push_back((isTurned ? turn : Quat(Quat::Identity())) * Vec3(x, 0.4 * y, 2 * z));
    const ConvexHull hull = convexHullOf(points);
    EXPECT_EQ(hull.vertices.size(), 8u);
    EXPECT_EQ(hull.faces.size(), 6u);
    expectHullOf(points, hull, 1e-12);
  }
}

TEST(ConvexHull, OfScatteredPointsHoldsThemAll) {
  Random random;
  for (const std::size_t count : {4u, 5u, 10u, 100u, 1000u}) {
    std::vector<Vec3> points;
    while (points.size() < count) points.push_back(random.vector(1));
    expectHullOf(points, convexHullOf(points), 1e-6);
  }
}

// Files hold floats: caps and sides of a drum of 20 sides are 22 faces all the same.
TEST(ConvexHull, FacesThatAreFlatToSinglePrecisionAreOne) {
  const DrawnMesh drum = tessellate(Cylinder{0.3, 1.1}, 20);
  std::vector<Vec3> points;
  for (const Vec3& vertex : drum.vertices)
    points.push_back((Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())) * vertex).cast<float>().cast<double>());
  const ConvexHull hull = convexHullOf(points);
  EXPECT_EQ(hull.vertices.size(), 40u);
  EXPECT_EQ(hull.faces.size(), 22u);
  expectHullOf(points, hull, 1e-6);
}

TEST(ConvexHull, OfFlatPointsIsAnError) {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_THROW(convexHullOf(square), Error);
  EXPECT_THROW(convexHullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), Error);
  EXPECT_THROW(convexHullOf({}), Error);
  EXPECT_THROW(convexHullOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 1e-9}, {5, 0, 0}}), Error);
  std::vector<Vec3> nearlyFlat = square;
  nearlyFlat.emplace_back(0.5, 0.5, 1e-8);
  EXPECT_THROW(convexHullOf(nearlyFlat), Error);
}

}  // namespace
}  // namespace cradle
