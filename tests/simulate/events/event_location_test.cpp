#include "simulate/events/event_location.h"

#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/integrators/rk4.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

constexpr double kTolerance = 1e-13;  // of the margins below

/// A ball in free flight, for which RK4 is exact.
OneIsland flight(const Vec3& position, const Vec3& velocity) {
  return OneIsland(fmt::format(R"("duration": 9, "bodies": [{})", cradle::ball("ball", position, velocity)) + "]");
}

double heightOf(const VectorX& state) {
  return state[1];
}

/// The step of that length (s) that an event is looked for in.
void takeStep(IslandState& island, double length) {
  rk4(island.rightHandSide, island.state, 0, length, island.step);
}

// A ball that falls by 1.25 m: t = sqrt(2 h / g). The guesses are off by up to a tenth of a step, to either side.
TEST(EventLocation, IsTheRootFromGuessesThatAreTooEarlyAndTooLate) {
  const double fall = std::sqrt(2 * 1.25 / kGravity);
  for (const double error : {-0.05, -1e-4, -1e-9, 0.0, 1e-12, 1e-7, 1e-3, 0.05}) {
    OneIsland at = flight(Vec3(0, 1.25, 0), Vec3(3, 0, 0));
    takeStep(at.island, 0.6);
    const double margin = endStepAtEvent(at.island, rk4, {fall + error, 0.6, kTolerance}, heightOf);
    EXPECT_LE(std::abs(margin), kTolerance) << error;
    // The speed is sqrt(2 g h) = 5 m/s: a margin of 1e-13 m is 2e-14 s, and so is the rounding of a height of 1.25 m.
    EXPECT_NEAR(at.island.step.timeStep, fall, 1e-13) << error;
    EXPECT_EQ(heightOf(at.island.step.state), margin) << error;
    EXPECT_NEAR(at.island.step.state[0], 3 * fall, 1e-12) << error;
  }
}

// The same zero, of a margin as steep as a cubic, and of one that is flat there: its slope is a thousandth elsewhere.
TEST(EventLocation, IsFoundForMarginsThatAreNotStraight) {
  const double fall = std::sqrt(2 * 1.25 / kGravity);
  for (const double flatness : {1e-3, 1.0, 1e3}) {
    OneIsland at = flight(Vec3(0, 1.25, 0), Vec3::Zero());
    takeStep(at.island, 0.6);
    const auto margin = [&](const VectorX& state) {
      const double height = heightOf(state);
      return height * (flatness + height * height);
    };
    endStepAtEvent(at.island, rk4, {fall + 0.03, 0.6, 1e-16}, margin);
    // Beyond that the step would have to be shorter by less than 1e-14 of 0.6 s; heights are rounded to 2e-16 m.
    EXPECT_NEAR(at.island.step.timeStep, fall, 1e-13) << flatness;
  }
}

// An event beyond the latest time has not come: the step ends there, with a margin left of g (t^2 - T^2) / 2.
TEST(EventLocation, LeavesWhatComesLaterForTheNextStep) {
  const double fall = std::sqrt(2 * 1.25 / kGravity), latest = fall - 0.01;
  OneIsland at = flight(Vec3(0, 1.25, 0), Vec3::Zero());
  takeStep(at.island, 0.6);
  const double margin = endStepAtEvent(at.island, rk4, {latest - 1e-4, latest, kTolerance}, heightOf);
  EXPECT_EQ(at.island.step.timeStep, latest);
  EXPECT_NEAR(margin, kGravity * (fall * fall - latest * latest) / 2, 1e-15);
}

// A ball that has just left the floor comes back after 2 v / g: the start, where it has no margin either, is no event.
TEST(EventLocation, IsNotTheStartOfWhatHasJustRebounded) {
  for (const double speed : {0.5, 1e-3}) {
    OneIsland at = flight(Vec3::Zero(), Vec3(0, speed, 0));
    takeStep(at.island, 0.3);
    const double back = 2 * speed / kGravity;
    endStepAtEvent(at.island, rk4, {1.01 * back, 0.3, 1e-16}, heightOf);
    // A margin of 1e-16 m at this speed, or 1e-14 of a step, and the rounding of heights v^2 / 2 g of 1e-2 m at most.
    EXPECT_NEAR(at.island.step.timeStep, back, 1e-16 / speed + 2e-14) << speed;
  }
}

// On a spring RK4 has an error, and its interpolant another one. The event's state is that of a step as long as the
// event is late, to the bit.
TEST(EventLocation, HasTheStateOfAStepAndNotOfAnInterpolant) {
  OneIsland at(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [)" + cradle::ball("ball", Vec3(1, 0.2, 0)) +
               R"(], "springs": [{"bodyA": "ball", "anchorB": [0, 0, 0], "stiffness": 40, "restLength": 0}])");
  takeStep(at.island, 0.4);
  const auto margin = [](const VectorX& state) { return state[0]; };
  const double left = endStepAtEvent(at.island, rk4, {0.26, 0.4, kTolerance}, margin);
  EXPECT_LE(std::abs(left), kTolerance);
  Step again;
  rk4(at.island.rightHandSide, at.island.state, 0, at.island.step.timeStep, again);
  EXPECT_EQ(at.island.step.state, again.state);
  // x = R(i z) of RK4 has no real part where 1 - z^2 / 2 + z^4 / 24 = 0: z^2 = 6 - sqrt(12), z = t sqrt(40).
  EXPECT_NEAR(at.island.step.timeStep, std::sqrt((6 - std::sqrt(12)) / 40), 1e-13);
}

}  // namespace
}  // namespace cradle
