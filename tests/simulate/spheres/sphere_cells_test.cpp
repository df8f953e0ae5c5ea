#include "simulate/spheres/sphere_cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace cradle {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Not;

constexpr double kRadius = 0.1;

std::vector<Vec3> randomCenters(int count, double extent) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, extent);
  std::vector<Vec3> centers;
  for (int i = 0; i < count; ++i) centers.push_back({uniform(random), uniform(random), uniform(random)});
  return centers;
}

std::vector<int> near(const SphereCells& cells, int ball) {
  std::vector<int> found;
  cells.visitNear(ball, [&](int other) { found.push_back(other); });
  return found;
}

TEST(SphereCells, FindEachBallThatMayBeTouchedOnce) {
  const std::vector<Vec3> centers = randomCenters(300, 1.5);
  const SphereCells cells(centers, kRadius, 0);
  ASSERT_TRUE(cells.isBounded());
  for (int ball = 0; ball < 300; ++ball) {
    std::vector<int> found = near(cells, ball);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    for (int other = 0; other < 300; ++other) {
      const Vec3 apart = centers[static_cast<std::size_t>(ball)] - centers[static_cast<std::size_t>(other)];
      EXPECT_TRUE(apart.norm() > 2 * kRadius || std::binary_search(found.begin(), found.end(), other));
    }
  }
}

TEST(SphereCells, KeepBallsThatLieInTheirCell) {
  const std::vector<Vec3> centers = randomCenters(50, 3);
  const SphereCells cells(centers, kRadius, 0);
  for (int ball = 0; ball < 50; ++ball)
    for (int axis = 0; axis < 3; ++axis) {
      const long cell = cells.cellOf(ball)[static_cast<std::size_t>(axis)];
      EXPECT_LE(cells.sideOf(cell, axis), centers[static_cast<std::size_t>(ball)][axis]);
      EXPECT_LE(centers[static_cast<std::size_t>(ball)][axis], cells.sideOf(cell + 1, axis));
    }
}

// Far out and back: lists that repeat in space are the same after as many steps.
TEST(SphereCells, FindWhatIsAheadOfABallThatMoves) {
  SphereCells cells(randomCenters(50, 3), kRadius, 0);
  for (const int axis : {0, 1, 2}) {
    for (int i = 0; i < 100; ++i) cells.move(7, axis, 1);
    EXPECT_THAT(near(cells, 7), Contains(7));
    for (int i = 0; i < 100; ++i) {
      cells.move(7, axis, -1);
      std::vector<int> ahead;
      cells.visitAhead(7, axis, -1, [&](int other) { ahead.push_back(other); });
      EXPECT_THAT(ahead, Not(Contains(7)));
      for (const int other : ahead) EXPECT_THAT(near(cells, 7), Contains(other));
    }
  }
}

TEST(SphereCells, KnowWhatFixedThingsABallMayTouch) {
  const std::vector<Vec3> centers = randomCenters(50, 3);
  SphereCells cells(centers, kRadius, 0);
  cells.addFixed(0, Bounds(Vec3(1, 1, 1), Vec3(1.5, 1.5, 1.5)));
  cells.addFixed(1, Bounds(Vec3::Constant(-1e9), Vec3::Constant(1e9)));
  for (int ball = 0; ball < 50; ++ball) {
    EXPECT_THAT(cells.fixedNear(ball), Contains(1));
    const Vec3& center = centers[static_cast<std::size_t>(ball)];
    const bool isInside = (center.array() >= 1).all() && (center.array() <= 1.5).all();
    EXPECT_TRUE(!isInside || cells.fixedNear(ball)[0] == 0) << ball;
  }
}

TEST(SphereCells, AreOneForAFewBalls) {
  const SphereCells cells({Vec3::Zero(), Vec3(1e6, 0, 0)}, kRadius, 0);
  EXPECT_FALSE(cells.isBounded());
  EXPECT_THAT(near(cells, 0), testing::UnorderedElementsAre(0, 1));
  EXPECT_THAT(cells.fixedNear(0), IsEmpty());
}

}  // namespace
}  // namespace cradle
