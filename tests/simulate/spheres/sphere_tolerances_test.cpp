#include "simulate/spheres/sphere_tolerances.h"

#include <gmock/gmock.h>

namespace cradle {
namespace {

// A sphere at the border of rest would bounce by v^2 / (2 g).
TEST(SphereTolerances, OfRestAreHeightsThatAreRounding) {
  const SphereTolerances made{4};
  const double slowest = made.maxRestSpeed(0.25, 0.1);
  EXPECT_NEAR(slowest * slowest / (2 * 4) / 0.25, 5e-15, 1e-28);
  EXPECT_NEAR(made.maxRestSpeed(0.25, 1e7), 1e-6, 1e-20);  // of a fast one, its rounding
  EXPECT_NEAR(made.minLoadedAcceleration(), 4e-9, 1e-23);
}

TEST(SphereTolerances, OfTouchArePartsOfTheRadius) {
  EXPECT_NEAR(SphereTolerances::touch(0.25), 2.5e-12, 1e-26);
  EXPECT_NEAR(SphereTolerances::minClosingSpeed(3), 3e-14, 1e-28);
}

}  // namespace
}  // namespace cradle
