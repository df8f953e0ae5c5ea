#include "math/parabola.h"

#include <gtest/gtest.h>

#include <array>

namespace cradle {
namespace {

/// 3 (x - 0.7)^2 - 0.2 through any three of its points, at uneven distances.
TEST(Parabola, IsLeastAtItsVertex) {
  const auto at = [](double x) { return Sample{x, 3 * (x - 0.7) * (x - 0.7) - 0.2}; };
  for (const auto& [a, b, c] : {std::array{-1.0, 0.5, 2.0}, {0.0, 0.1, 0.9}, {0.6, 0.7, 5.0}}) {
    const std::optional<Sample> least = leastOf({at(a), at(b), at(c)});
    ASSERT_TRUE(least) << a;
    EXPECT_NEAR(least->at, 0.7, 1e-14);
    EXPECT_NEAR(least->value, -0.2, 1e-13);
  }
}

/// None where it bends down, is straight, or is least beyond the samples.
TEST(Parabola, HasNoLeastPlaceElsewhere) {
  EXPECT_FALSE(leastOf({{{0, 0}, {1, 1}, {2, 0}}}));
  EXPECT_FALSE(leastOf({{{0, 0}, {1, 1}, {2, 2}}}));
  EXPECT_FALSE(leastOf({{{1, 1}, {2, 4}, {3, 9}}}));
}

}  // namespace
}  // namespace cradle
