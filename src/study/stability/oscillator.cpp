#include "study/stability/oscillator.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace cradle {
namespace {

constexpr double kPeriods = 10;
constexpr long kMaxFrames = 200;     // within ten periods
constexpr double kInaccurate = 0.1;  // of the amplitude
constexpr long kLimitSteps = 1000;   // a growth of 0.1 % a step is then one of 2.7

}  // namespace

Scene oscillatorScene(const Oscillator& oscillator) {
  static const Scene prototype = sceneOfText(
      R"({"schema": "cradle-scene/1", "name": "oscillator", "duration": 1, "gravity": [0, 0, 0],
      "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [1.01, 0, 0]}],
      "springs": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": 1, "restLength": 1}]})");
  Scene scene = prototype;
  scene.springs[0].stiffness = oscillator.omega * oscillator.omega;
  scene.springs[0].damping = 2 * oscillator.dampingRatio * oscillator.omega;
  return scene;
}

double oscillatorStretch(const Oscillator& oscillator, double time) {
  constexpr double kNotCritical = 1e-7;  // keeps the two roots apart: then the stretch is exact to 1e-7
  const double ratio = oscillator.dampingRatio;
  const double apart = std::abs(ratio - 1) < kNotCritical ? 1 + kNotCritical : ratio;
  const std::complex<double> root = std::sqrt(std::complex<double>(apart * apart - 1, 0));
  const std::complex<double> fast = oscillator.omega * (-apart - root), slow = oscillator.omega * (-apart + root);
  return kOscillatorAmplitude * ((slow * std::exp(fast * time) - fast * std::exp(slow * time)) / (slow - fast)).real();
}

Stability oscillatorStability(const Oscillator& oscillator, const FixedStepMethod& method, double timeStep) {
  const double asked = kPeriods * 2 * std::numbers::pi / oscillator.omega;
  const long steps = static_cast<long>(std::ceil(asked / timeStep));
  const long stepsAFrame = std::max(1L, steps / kMaxFrames);
  const long frames = std::max(steps, kTrialSteps) / stepsAFrame;
  Scene scene = oscillatorScene(oscillator);
  const FixedStepTrial trial = tryFixedSteps(scene, method, {timeStep, stepsAFrame, frames});
  if (trial.isUnstable) return Stability::unstable;
  for (const Frame& frame : trial.frames) {
    const double stretch = frame.states[0].position.x() - 1;
    if (frame.time > asked + timeStep) break;
    if (!(std::abs(stretch - oscillatorStretch(oscillator, frame.time)) <= kInaccurate * kOscillatorAmplitude))
      return Stability::inaccurate;
  }
  return Stability::stable;
}

double measuredOscillatorLimit(const Oscillator& oscillator, const FixedStepMethod& method) {
  Scene scene = oscillatorScene(oscillator);
  return measuredLimit([&](double timeStep) { return isStableFor(scene, method, timeStep, kLimitSteps); },
                       kFirstTrialStep / oscillator.omega);
}

}  // namespace cradle
