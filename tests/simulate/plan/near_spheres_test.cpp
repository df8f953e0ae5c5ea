#include "simulate/plan/near_spheres.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace cradle {
namespace {

using Pairs = std::multiset<std::pair<std::size_t, std::size_t>>;

/// All pairs that are visited, the smaller index first.
Pairs visitedOf(const std::vector<Reach>& spheres) {
  Pairs visited;
  forEachNearPair(spheres, [&](std::size_t i, std::size_t j) {
    visited.emplace(std::min(i, j), std::max(i, j));
    return true;
  });
  return visited;
}

// Radii over eight orders of magnitude, so that each size has its grid; places on both sides of all axes.
TEST(NearSpheres, AllThatOverlapAreVisitedOnce) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1, 1), exponent(-6, 2);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Reach> spheres;
    for (int i = 0; i < 150; ++i) {
      const double radius = std::pow(10.0, exponent(random)), far = i % 3 == 0 ? 1e3 : 10 * radius;
      spheres.push_back({far * Vec3(place(random), place(random), place(random)), radius});
    }
    const Pairs visited = visitedOf(spheres);
    for (std::size_t i = 0; i < spheres.size(); ++i)
      for (std::size_t j = i + 1; j < spheres.size(); ++j) {
        const double distance = (spheres[i].center - spheres[j].center).norm();
        const std::size_t times = visited.count({i, j});
        EXPECT_LE(times, 1u) << i << " " << j;
        if (distance <= spheres[i].radius + spheres[j].radius) {
          EXPECT_EQ(times, 1u) << i << " " << j;
        }
      }
  }
}

// Half as far apart again as spheres that touch; each has 26 around it. Along x alone, 900 would be near each.
TEST(NearSpheres, OfABlockFewOthersAreVisited) {
  std::vector<Reach> spheres;
  for (int x = 0; x < 30; ++x)
    for (int y = 0; y < 30; ++y)
      for (int z = 0; z < 30; ++z) spheres.push_back({0.15 * Vec3(x, y, z), 0.05});
  EXPECT_LT(visitedOf(spheres).size(), 40 * spheres.size());
}

TEST(NearSpheres, OfAnySizeAndPlaceEndTheVisitWhenToldTo) {
  std::vector<Reach> spheres;
  for (const double radius : {0.0, 1e-300, 1.0, 1e200, 1e308, std::numeric_limits<double>::infinity()})
    for (const double x : {0.0, 1e-300, -1e30, 1e150}) spheres.push_back({x * Vec3(1, -1, 1), radius});
  const Pairs visited = visitedOf(spheres);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(visited.count({i, 20}), 1u) << i;
  int visits = 0;
  forEachNearPair(spheres, [&](std::size_t, std::size_t) { return ++visits < 5; });
  EXPECT_EQ(visits, 5);
}

}  // namespace
}  // namespace cradle
