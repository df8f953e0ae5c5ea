#include "study/ladder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "study/sample_scenes.h"

namespace cradle {
namespace {

std::vector<double> settingsOf(const char* method, const StudyScene& scene) {
  Ladder ladder(methodOf(method), scene);
  std::vector<double> settings;
  do settings.push_back(ladder.setting());
  while (ladder.descend(0, 1));
  return settings;
}

TEST(Ladder, StartsAtTheStabilityLimitOfTheFastestSpring) {
  // The step that divides the duration evenly is at most one part in the number of steps longer.
  const double omega = 50, duration = 10;
  const StudyScene scene(oscillator(omega, duration));
  for (const auto& [method, limit] : {std::pair("explicitEuler", 2.0), std::pair("semiImplicitEuler", 2.0),
                                      std::pair("rk4", 2.8284271), std::pair("dop853FixedStep", 5.96)}) {
    const double first = settingsOf(method, scene).front();
    EXPECT_GE(first, 0.9999999 * limit / omega) << method;
    EXPECT_LE(first, limit / omega * (1 + 1 / std::floor(duration * omega / limit))) << method;
  }
}

TEST(Ladder, StartsAtAThirtiethOfASecondWithoutSprings) {
  EXPECT_DOUBLE_EQ(settingsOf("rk4", StudyScene(freeFall(1))).front(), 1.0 / 30);
}

TEST(Ladder, HalvesTheStepDownToThreeMillion) {
  const std::vector<double> steps = settingsOf("rk4", StudyScene(freeFall(1)));
  for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_DOUBLE_EQ(steps[i], steps[i - 1] / 2);
  EXPECT_GE(steps.back(), 1 / 3e6);
  EXPECT_LT(steps.back(), 2 / 3e6);
}

TEST(Ladder, TakesAccuraciesByTenths) {
  const std::vector<double> accuracies = settingsOf("dop853", StudyScene(freeFall(1)));
  ASSERT_EQ(accuracies.size(), 11U);
  EXPECT_EQ(accuracies.front(), 1e-2);
  EXPECT_EQ(accuracies[4], 1e-6);
  EXPECT_EQ(accuracies.back(), 1e-12);
}

TEST(Ladder, EndsWhereTheNextRungWouldTakeTooLong) {
  Ladder ladder(methodOf("rk4"), StudyScene(freeFall(1)));
  EXPECT_TRUE(ladder.descend(0.49, 1));
  EXPECT_FALSE(ladder.descend(0.51, 1));
}

TEST(GainWatch, EndsAtTheFloor) {
  GainWatch watch;
  EXPECT_TRUE(watch.goesOn(1e-6, 1e-9));
  EXPECT_FALSE(watch.goesOn(1e-9, 1e-9));
}

TEST(GainWatch, EndsAfterThreeRungsWithoutGain) {
  GainWatch watch;
  EXPECT_TRUE(watch.goesOn(1e-8, 1e-12));
  EXPECT_TRUE(watch.goesOn(2e-8, 1e-12));
  EXPECT_TRUE(watch.goesOn(3e-8, 1e-12));
  EXPECT_FALSE(watch.goesOn(1e-8, 1e-12));
}

TEST(GainWatch, WaitsUntilTheMotionIsResolved) {
  GainWatch watch;
  for (const double error : {0.5, 0.7, 0.9, 0.6, 0.8, 1.1}) EXPECT_TRUE(watch.goesOn(error, 1e-12));
}

}  // namespace
}  // namespace cradle
