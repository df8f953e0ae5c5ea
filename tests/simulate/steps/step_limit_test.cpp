#include "simulate/steps/step_limit.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <regex>

#include "experiments/experiment.h"

namespace cradle {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kOmega = 10;  // rad/s
constexpr double kPeriod = 2 * std::numbers::pi / kOmega;

/// A ball of 1 kg without gravity that swings with kOmega on a spring.
std::string swing(double dampingRatio = 0) {
  return fmt::format(R"("gravity": [0, 0, 0], "bodies": [{{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}},
      "mass": 1, "position": [1.1, 0, 0]}}],
    "springs": [{{"name": "s", "bodyA": "ball", "stiffness": {}, "damping": {}, "restLength": 1}}])",
                     kOmega * kOmega, 2 * dampingRatio * kOmega);
}

struct Swing {
  std::vector<std::string> warnings;
  double energyAPeriod = 0;  // of the energy at the start of a period, measured
};

/// The swing by a method with step x omega = `z`, for whole steps of about `periods`.
Swing swingBy(const std::string& method, double z, double dampingRatio = 0, double periods = 8) {
  const double step = z / kOmega, steps = std::ceil(periods * kPeriod / step);
  const Scene scene = sceneWith(fmt::format(R"("duration": {}, "output": {{"framesPerSecond": {}}}, {}, {})",
                                            steps * step, 1 / step, methodText(method, step), swing(dampingRatio)));
  Swing result;
  std::vector<Frame> frames;
  simulate(scene, {[&](const Frame& frame) { frames.push_back(frame); }, [](const Event&) {},
                   [&](const std::string& warning) { result.warnings.push_back(warning); }});
  const auto energyOf = [](const Frame& frame) { return frame.energy.kinetic + frame.energy.potential; };
  result.energyAPeriod = std::pow(energyOf(frames.back()) / energyOf(frames.front()),
                                  kPeriod / (frames.back().time - frames.front().time));
  return result;
}

/// The number behind some words of a warning.
double numberBehind(const std::string& words, const std::string& warning) {
  std::smatch match;
  if (!std::regex_search(warning, match, std::regex(words + " ([-+.e0-9]+)"))) ADD_FAILURE() << warning;
  return match.empty() ? NAN : std::stod(match[1]);
}

// RK4: |R(iz)|^2 = 1 - z^6 / 72 + z^8 / 576, 2 pi / z steps in a period.
double lossOfRk4(double z) {
  return 1 - std::pow(1 - std::pow(z, 6) / 72 + std::pow(z, 8) / 576, 2 * std::numbers::pi / z);
}

TEST(StepWarning, TellsTheLossOfStableStepsOfRk4) {
  for (const double z : {0.8, 1.0, 2.0, 2.5}) {
    const Swing swing = swingBy("rk4", z);
    ASSERT_THAT(swing.warnings, ElementsAre(HasSubstr("spring \"s\" loses"))) << z;
    // Two digits are told.
    EXPECT_NEAR(numberBehind("loses", swing.warnings[0]), 100 * lossOfRk4(z), 5.1) << z;
    EXPECT_NEAR(numberBehind("loses", swing.warnings[0]) / 100 / lossOfRk4(z), 1, 0.051) << z;
    const double harmless = numberBehind("timeStep of", swing.warnings[0]) * kOmega;
    EXPECT_LT(lossOfRk4(harmless), 0.01) << z;
    EXPECT_GT(lossOfRk4(1.2 * harmless), 0.01) << z;  // 0.9 of the limit, and two digits
    EXPECT_THAT(swingBy("rk4", harmless).warnings, IsEmpty()) << z;
  }
}

TEST(StepWarning, TellsWhatTheEnergiesOfTheRunShow) {
  // What the energy swings by within a period, in a period's average over 40: the 40th root of a factor of a few.
  for (const auto& [method, z] : {std::pair{"rk4", 1.2}, {"dop853", 5.8}, {"dop853", 4.0}}) {
    const Swing swing = swingBy(method, z, 0, 40);
    ASSERT_THAT(swing.warnings, ElementsAre(AllOf(HasSubstr("loses"), HasSubstr("below 1 %")))) << method << z;
    EXPECT_NEAR(numberBehind("loses", swing.warnings[0]) / 100, 1 - swing.energyAPeriod, 0.03) << method << z;
    const double harmless = numberBehind("timeStep of", swing.warnings[0]) * kOmega;
    EXPECT_NEAR(swingBy(method, harmless, 0, 40).energyAPeriod, 1, 0.01) << method << z;
  }
}

TEST(StepWarning, TellsTheGainOfExplicitEulerInRunsThatItDoesNotBlowUp) {
  // (1 + z^2)^(2 pi / z) in a period; 1.3 of them gain less than the 10 % that are called unstable.
  constexpr double kStepOmega = 0.01;
  const Swing swing = swingBy("explicitEuler", kStepOmega, 0, 1.3);
  ASSERT_THAT(swing.warnings, ElementsAre(HasSubstr("gains 6.5 % of its energy in a period")));
  const double harmless = numberBehind("timeStep of", swing.warnings[0]) * kOmega;
  EXPECT_LT(std::pow(1 + harmless * harmless, 2 * std::numbers::pi / harmless), 1.01);
  EXPECT_THAT(swingBy("explicitEuler", harmless, 0, 1.3).warnings, IsEmpty());
}

TEST(StepWarning, LeavesOutWhatADamperTakes) {
  // A damper of 0.1 of the critical one takes 1 - exp(-4 pi 0.1) = 72 % in a period: RK4 at z = 0.3 follows that, and
  // at 2 it takes all. Beyond critical damping nothing swings.
  EXPECT_THAT(swingBy("rk4", 0.3, 0.1).warnings, IsEmpty());
  EXPECT_THAT(swingBy("rk4", 2, 0.1).warnings, ElementsAre(HasSubstr("loses")));
  EXPECT_THAT(swingBy("rk4", 0.5, 2).warnings, IsEmpty());
}

TEST(StepWarning, IsSilentAboutStepsThatKeepTheEnergy) {
  // Semi-implicit Euler keeps a quadratic form near to the energy at any stable step: its matrix has determinant 1.
  for (const double z : {0.1, 1.0, 1.9}) EXPECT_THAT(swingBy("semiImplicitEuler", z).warnings, IsEmpty()) << z;
  for (const double z : {0.1, 0.4}) EXPECT_THAT(swingBy("rk4", z).warnings, IsEmpty()) << z;
  for (const double z : {0.5, 1.5}) EXPECT_THAT(swingBy("dop853", z).warnings, IsEmpty()) << z;
}

TEST(StepWarning, IsSilentAboutRunsTooShortToShowIt) {
  EXPECT_THAT(swingBy("explicitEuler", 0.01, 0, 0.1).warnings, IsEmpty());  // a tenth of 6.5 %
}

TEST(StepWarning, NamesTheSpringThatLosesMost) {
  // Two balls on springs of their own, in reach of each other: one island. RK4 loses most at z = 2.4 or so, and next to
  // nothing at the end of its stability, where the stiffer spring is.
  const Scene scene = sceneWith(R"("duration": 2, "gravity": [0, 0, 0], )" + methodText("rk4", 0.2) + R"(, "bodies": [
      {"name": "a", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [1.1, 0, 0]},
      {"name": "b", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [1.5, 0, 0]}],
    "springs": [{"name": "stiff", "bodyA": "a", "stiffness": 199.9, "restLength": 1},
                {"name": "lossy", "bodyA": "b", "stiffness": 121, "restLength": 1}])");
  std::vector<std::string> warnings;
  simulate(scene, {[](const Frame&) {}, [](const Event&) {}, [&](const std::string& w) { warnings.push_back(w); }});
  EXPECT_THAT(warnings, testing::Contains(HasSubstr("spring \"lossy\" loses")));
  EXPECT_THAT(warnings, testing::Not(testing::Contains(HasSubstr("spring \"stiff\" loses"))));
}

// The steps of a pendulum are of some 0.05 s in a run of thirty years, too.
TEST(LongRuns, AreNotStiff) {
  const Scene scene = sceneWith(R"("duration": 1e9, "output": {"framesPerSecond": 0.1}, "bodies": [{"name": "ball",
      "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [1, 0, 0]}],
    "rods": [{"bodyA": "ball", "anchorB": [0, 0, 0]}])");
  struct Done {};
  const auto take = [](const Frame& frame) {
    if (frame.time > 1000) throw Done();
  };
  EXPECT_THROW(simulate(scene, {take, [](const Event&) {}, [](const std::string&) {}}), Done);
}

}  // namespace
}  // namespace cradle
