#include "simulate/steps/step_tolerances.h"

#include <gmock/gmock.h>

#include <cmath>

#include "simulate/one_island.h"

namespace cradle {
namespace {

constexpr double kSize = 0.1, kStepGravity = 9.0;  // m, m/s^2
constexpr double kLength = 1.0 / 960;              // s
constexpr double kFloorSpeed = 1e-12;              // m/s

void expectClose(double found, double expected) {
  EXPECT_NEAR(found, expected, 1e-15 * expected);
}

TEST(StepTolerances, AreOfTheScalesOfTheBodies) {
  OneIsland at(R"("duration": 7, "gravity": [3, 0, 4], "bodies": [
      {"name": "ball", "shape": {"sphere": {"radius": 0.3}}, "position": [0, 0, 0]},
      {"name": "small", "shape": {"sphere": {"radius": 0.2}}, "position": [2, 0, 0]}])");
  const StepScales scales = stepScalesOf(at.island.assembly);
  EXPECT_EQ(scales.size, 0.2);
  EXPECT_EQ(scales.gravity, 5);
}

TEST(StepTolerances, OfGapsArePartsOfTheSmallestSize) {
  const StepTolerances made = stepTolerancesOf({kSize, kStepGravity});
  expectClose(made.touch, 1e-10);
  expectClose(made.overlap, 1e-10);
  expectClose(made.support, 1e-7);
  expectClose(made.margin(), 1e-7);
  expectClose(made.letBe(), 1e-8);
  expectClose(made.closedGap, 1e-13);
  expectClose(made.minFollowedWay(), 1e-5);
  expectClose(made.separationError(1e-9), 1e-11);
  expectClose(made.separationError(1e-6), 1e-9);
}

// Contacts of one instant: the faster they close, the farther apart they may be, for a thousandth of the step.
TEST(StepTolerances, OfOneInstantGrowWithTheSpeed) {
  const StepTolerances made = stepTolerancesOf({kSize, kStepGravity});
  expectClose(made.simultaneousGap(0, kLength), 1e-10);
  expectClose(made.simultaneousGap(2, kLength), 2 * kLength / 1000);
}

TEST(StepTolerances, OfSpeedsArePartsOfWhatGravityGivesInAStep) {
  const StepTolerances made = stepTolerancesOf({kSize, kStepGravity});
  const double gained = kStepGravity * kLength;
  expectClose(made.minClosingSpeed(kLength), kFloorSpeed + 1e-6 * gained);
  expectClose(made.minImpactSpeed(kLength), kFloorSpeed + 0.01 * gained);
  expectClose(made.minNextImpactSpeed(kLength), kFloorSpeed + 0.1 * gained);
}

// A contact that closes with what gravity gives in two steps, and with no more than an impact has, does not rebound.
TEST(StepTolerances, OfReboundsAreThoseThatStepsDoNotResolve) {
  const StepTolerances made = stepTolerancesOf({kSize, kStepGravity});
  const double gained = kStepGravity * kLength;  // m/s: as the contact is pressed by gravity
  expectClose(made.maxRestSpeed(gained, kLength), 2 * gained + made.minImpactSpeed(kLength));
}

// The kinetic energy of a slow body could lift it by 1e-7 of its size.
TEST(StepTolerances, OfRestAreHeightsThatAreNotSeen) {
  const StepTolerances made = stepTolerancesOf({kSize, kStepGravity});
  expectClose(made.maxSlowSquare(0.4) / (2 * kStepGravity), 0.4e-7);
  expectClose(made.maxSmoothSlip(0.25), 1.5e-7);
  expectClose(made.minAwakeTime(kLength), 20 * kLength);
  expectClose(made.residualAcceleration, 1e-6 * kStepGravity);
  expectClose(made.forceError, made.residualAcceleration / 100);
}

}  // namespace
}  // namespace cradle
