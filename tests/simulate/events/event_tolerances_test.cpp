#include "simulate/events/event_tolerances.h"

#include <gmock/gmock.h>

#include <cmath>

#include "simulate/one_island.h"

namespace cradle {
namespace {

constexpr double kTinyRounding = 1e-15;  // relative, of a few products
constexpr double kSpeedFloor = 1e-12;    // m/s

void expectNear(double found, double expected) {
  EXPECT_NEAR(found, expected, kTinyRounding * expected);
}

TEST(EventTolerances, AreOfTheIslandsScales) {
  OneIsland at(R"("duration": 7, "accuracy": 1e-5, "gravity": [3, 0, 4], "bodies": [
      {"name": "ball", "shape": {"sphere": {"radius": 0.3}}, "position": [0, 0, 0]},
      {"name": "small", "shape": {"sphere": {"radius": 0.2}}, "position": [2, 0, 0]}])");
  const EventScales scales = eventScalesOf(at.island);
  EXPECT_EQ(scales.accuracy, 1e-5);
  EXPECT_EQ(scales.duration, 7);
  EXPECT_EQ(scales.size, 0.2);
  EXPECT_EQ(scales.gravity, 5);
}

// The reach is a tenth of the accuracy, between the touch tolerance and 1e-8 (visual 1e-5) of the size.
TEST(EventTolerances, OfGapsArePartsOfTheSmallestSizeThatAccuracyChooses) {
  for (const double accuracy : {1e-11, 1e-8, 1e-4, 1.1e-4, 1e-3}) {
    const EventTolerances made = eventTolerancesOf({accuracy, 1, 0.1, 9.81});
    const bool isVisual = accuracy > 1e-4;
    expectNear(made.touch, 0.1 * (isVisual ? 1e-8 : 1e-11));
    expectNear(made.deadBand, 0.1 * 1e-12);
    expectNear(made.reach, 0.1 * std::min(std::max(0.1 * accuracy, 1e-11), isVisual ? 1e-5 : 1e-8));
    expectNear(made.closingPairGap, 0.1 * 1e-6);
    expectNear(made.closedGap, made.touch / 1000);
    expectNear(made.leaving, made.touch / 2);
  }
}

// A gap at coordinates of 1 km cannot be known to 4e-12 of 0.1 m.
TEST(EventTolerances, OfGapsFarAwayArePartsOfTheCoordinates) {
  const EventTolerances made = eventTolerancesOf({1e-6, 1, 0.1, 9.81});
  expectNear(made.gapRounding(1), 4e-13);
  expectNear(made.gapRounding(1000), 4e-12);
  expectNear(made.sphereGapRounding(1), 2e-14);
  expectNear(made.sphereGapRounding(1000), 4e-12);
}

// While a sequence of impacts lasts, forces move a body by half of its reach, in sizes: a t^2 / 2 = (reach / L) reach
// / 2.
TEST(EventTolerances, OfASequenceEndItBeforeForcesCount) {
  const EventTolerances made = eventTolerancesOf({1e-8, 1, 0.1, 9.81});
  const double time = made.maxSequenceTime(20);
  expectNear(20 * time * time / 2, made.reach / 0.1 * made.reach / 2);
}

TEST(EventTolerances, OfStepsArePartsOfTheRunButNotOfLongOnes) {
  for (const double duration : {10.0, 1e5}) {
    const EventTolerances made = eventTolerancesOf({1e-6, duration, 0.1, 9.81});
    expectNear(made.shortTimeStep, 1e-9 * std::min(duration, 1000.0));
    expectNear(made.shortestTimeStep, 1e-14 * std::min(duration, 1000.0));
    expectNear(made.slowTimeStep, 1e-5 * std::sqrt(0.1 / 9.81));
    expectNear(made.rateTime, 1e-5 * std::sqrt(0.1 / 9.81));
    expectNear(eventTolerancesOf({1e-6, duration, 0.1, 0}).slowTimeStep, 1e-5 * std::min(duration, 1000.0));
  }
}

// A rebound of speed v is v^2 / (2 a) high.
TEST(EventTolerances, OfReboundsAreHeightsThatAreNotSeen) {
  const auto heightOf = [](double accuracy) {
    const double speed = eventTolerancesOf({accuracy, 1, 0.1, 9.81}).minReboundSpeed(3, 0.4);
    return speed * speed / (2 * 3) / 0.4;
  };
  EXPECT_NEAR(heightOf(1e-9), 5e-15, 1e-25);
  EXPECT_NEAR(heightOf(1e-5), 5e-5 * 1e-10, 1e-25);
  EXPECT_NEAR(heightOf(1e-2), 5e-5, 1e-15);
}

TEST(EventTolerances, OfStillBodiesFollowTheAccuracy) {
  for (const double accuracy : {1e-9, 1e-3}) {
    const EventTolerances made = eventTolerancesOf({accuracy, 1, 0.1, 9});
    const double ratio = std::min(accuracy, 1e-7);
    expectNear(made.maxRestSpeed(0.25), 1.5 * ratio + kSpeedFloor);
    expectNear(made.minOpeningSpeed(0.25), 1.5 * 1e-7 + kSpeedFloor);
  }
}

// An acceleration a leads a T^2 / 2 far: a twentieth of A. It is between 1e-11 and 1e-7 of the largest, and no less
// than ten times what the solution leaves.
TEST(EventTolerances, OfStillAccelerationsLeadNoFartherThanATwentiethOfTheAccuracy) {
  const EventTolerances made = eventTolerancesOf({1e-6, 2, 0.1, 10});
  const double still = made.stillAcceleration(10, 0);
  expectNear(still * 2 * 2 / 2, 1e-6 / 20);
  expectNear(made.stillAcceleration(10, 5e-9), 5e-8);
  expectNear(made.stillAcceleration(10, 1), 1e-6);
  expectNear(made.maxRestAcceleration(1), 1e-6);
  expectNear(eventTolerancesOf({1e-12, 2, 0.1, 10}).stillAcceleration(10, 0), 1e-10);
  expectNear(eventTolerancesOf({1e-9, 0.01, 0.1, 10}).maxRestAcceleration(0), 1e-8);  // of gravity, A
}

TEST(EventTolerances, OfConstraintsAreATenthOfTheAccuracyButNoRounding) {
  expectNear(eventTolerancesOf({1e-6, 1, 0.1, 9.81}).constraintError, 1e-7);
  expectNear(eventTolerancesOf({1e-11, 1, 0.1, 9.81}).constraintError, 1e-9);
}

}  // namespace
}  // namespace cradle
