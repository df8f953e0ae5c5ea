#include "study/stability/cradle_map.h"

#include <gmock/gmock.h>

namespace cradle {
namespace {

using Speeds = std::vector<double>;

auto isNear(const Speeds& expected) {
  return ::testing::Pointwise(::testing::DoubleNear(1e-14), expected);
}

// references.json, R7x.
const std::vector<Speeds> kRight = {{0, 0, 0, 0, 1}, {0, 0, 0, 1, 1}, {0, 0, 1, 1, 1}};
const std::vector<Speeds> kNewton = {
    {-0.6, 0.4, 0.4, 0.4, 0.4}, {-0.2, -0.2, 0.8, 0.8, 0.8}, {0.2, 0.2, 0.2, 1.2, 1.2}};

TEST(CradleByLaw, LetsAsManyBallsLeaveAsCome) {
  for (int moving = 1; moving <= 3; ++moving) {
    const Speeds& right = kRight[static_cast<std::size_t>(moving - 1)];
    EXPECT_THAT(speedsAfter(ImpactLaw::generalizedReflections, moving), isNear(right));
    EXPECT_THAT(speedsAfter(ImpactLaw::pairwise, moving), isNear(right));
    EXPECT_THAT(speedsByPlan(moving), isNear(right));
  }
}

TEST(CradleByLaw, IsAnotherWithNewtonsLawForAllAtOnce) {
  for (int moving = 1; moving <= 3; ++moving)
    EXPECT_THAT(speedsAfter(ImpactLaw::newtonAllAtOnce, moving), isNear(kNewton[static_cast<std::size_t>(moving - 1)]));
}

}  // namespace
}  // namespace cradle
