#include "collision/polygon_clip.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/random_poses.h"
#include "math/rotation.h"
#include "rounding.h"

namespace cradle {
namespace {

/// A regular polygon on a circle of 1 m, in a pose.
Points regularPolygon(int corners, const RigidTransform& pose) {
  Points polygon;
  for (int i = 0; i < corners; ++i)
    polygon.push_back(pose * Vec3(std::cos(2 * M_PI * i / corners), std::sin(2 * M_PI * i / corners), 0));
  return polygon;
}

Vec3 areaOf(const Points& polygon) {
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    area += (polygon[i] - polygon[0]).cross(polygon[(i + 1) % polygon.size()] - polygon[0]) / 2;
  return area;
}

Points clipped(Points polygon, const Vec3& outward, double offset) {
  Points scratch(3, Vec3::Constant(NAN));
  clip(polygon, scratch, outward, offset);
  return polygon;
}

// Both sides of a plane together have the area of the whole, also its direction: the order of corners stays. No corner
// is beyond the plane.
TEST(PolygonClip, BothSidesHaveTheAreaOfTheWhole) {
  RandomPoses random(1);
  for (const double size : {1.0, 1e-6, 1e6})
    for (int i = 0; i < 200; ++i) {
      Points polygon = regularPolygon(3 + i % 6, random.pose(1));
      for (Vec3& corner : polygon) corner *= size;
      const Vec3 outward = random.direction();
      const double offset = outward.dot(polygon[0] + polygon[1]) / 2 + random.number(-0.7, 0.7) * size;
      const Points inner = clipped(polygon, outward, offset), outer = clipped(polygon, -outward, -offset);
      EXPECT_LT((areaOf(inner) + areaOf(outer) - areaOf(polygon)).norm(), 64 * kEpsilon * size * size);
      for (const Vec3& corner : inner) EXPECT_LE(outward.dot(corner), offset + 8 * kEpsilon * size);
      EXPECT_LE(inner.size(), polygon.size() + 1);
    }
}

// A square of 2 m, clipped at x <= 0.25 and through two corners: closed forms, corner by corner.
TEST(PolygonClip, OfASquareIsTheRectangleAndTheTriangle) {
  const Points square{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  EXPECT_EQ(clipped(square, Vec3::UnitX(), 0.25), (Points{{-1, -1, 0}, {0.25, -1, 0}, {0.25, 1, 0}, {-1, 1, 0}}));
  // Corners in the plane are there once.
  EXPECT_EQ(clipped(square, Vec3(1, 1, 0), 0), (Points{{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}}));
  EXPECT_EQ(clipped(square, Vec3::UnitX(), 1), square);
  EXPECT_EQ(clipped(square, Vec3::UnitX(), -1), (Points{{-1, -1, 0}, {-1, 1, 0}}));  // an edge touches
  EXPECT_TRUE(clipped(square, Vec3::UnitX(), -1.5).empty());
  EXPECT_TRUE(clipped({}, Vec3::UnitX(), 1).empty());
}

TEST(PolygonClip, OfALineIsItsPart) {
  const Points line{{-1, 2, 0}, {3, 2, 0}};
  EXPECT_EQ(clipped(line, Vec3::UnitX(), 1), (Points{{-1, 2, 0}, {1, 2, 0}}));
  EXPECT_EQ(clipped(line, -Vec3::UnitX(), 0), (Points{{0, 2, 0}, {3, 2, 0}}));
  EXPECT_EQ(clipped(line, Vec3::UnitY(), 3), line);
  EXPECT_TRUE(clipped(line, Vec3::UnitY(), 1).empty());
  EXPECT_EQ(clipped({{1, 2, 0}}, Vec3::UnitX(), 2), (Points{{1, 2, 0}}));
}

// Of a regular polygon all corners span as much, but for rounding: every other one is left, so that the rest is regular
// again. Of 2n corners n are left, of area n/2 sin(2 pi / n).
TEST(ThinOut, LeavesEveryOtherCornerOfARegularPolygon) {
  RandomPoses random(2);
  for (const int corners : {16, 12, 8})
    for (int i = 0; i < 20; ++i) {
      Points polygon = regularPolygon(corners, random.pose(1));
      const Points whole = polygon;
      const int left = corners / 2;
      thinOut(static_cast<std::size_t>(left), polygon);
      EXPECT_NEAR(areaOf(polygon).norm(), left / 2.0 * std::sin(2 * M_PI / left), 64 * kEpsilon);
      for (const Vec3& corner : polygon) EXPECT_EQ(std::count(whole.begin(), whole.end(), corner), 1);
    }
}

// A corner less costs the least of all triangles of neighbours.
TEST(ThinOut, TakesTheCornerThatSpansLeast) {
  RandomPoses random(3);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> angles;
    for (int k = 0; k < 9; ++k) angles.push_back(random.number(0, 2 * M_PI));
    std::sort(angles.begin(), angles.end());
    Points polygon;
    for (const double angle : angles) polygon.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    double best = 0;
    for (std::size_t without = 0; without < polygon.size(); ++without) {
      Points rest = polygon;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(without));
      best = std::max(best, areaOf(rest).norm());
    }
    thinOut(8, polygon);
    EXPECT_EQ(polygon.size(), 8u);
    EXPECT_NEAR(areaOf(polygon).norm(), best, 64 * kEpsilon);
  }
}

// Of the part of a regular polygon beside a line, corners lie in mirror images of each other about the middle of the
// part; the image of the whole in another mirror starts with another corner and goes the other way round.
TEST(ThinOut, LeavesTheMirrorImageOfWhatItLeavesOfAMirrorImage) {
  const auto mirrored = [](Points polygon) {
    for (Vec3& corner : polygon) corner.x() = -corner.x();
    std::reverse(polygon.begin(), polygon.end());
    return polygon;
  };
  const RigidTransform turned{rotationAbout(Vec3::UnitZ(), M_PI / 4), Vec3::Zero()};
  for (const double border : {-0.3, 0.0, 0.15})
    for (const RigidTransform& pose : {RigidTransform{}, turned})
      for (const std::size_t most : {4U, 6U, 8U}) {
        Points part = clipped(regularPolygon(16, pose), pose * Vec3::UnitY(), border), image = mirrored(part);
        thinOut(most, part), thinOut(most, image);
        EXPECT_LE(part.size(), most);
        EXPECT_GE(part.size(), most - 1) << border;
        for (const Vec3& corner : mirrored(image))
          EXPECT_EQ(std::count(part.begin(), part.end(), corner), 1) << border << " " << most;
      }
}

}  // namespace
}  // namespace cradle
