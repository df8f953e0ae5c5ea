// Bounces of e^n get shorter without end, and end after a finite time (Zeno). What can be resolved of them: steps of h
// no rebound slower than about 2 g h, after which 4 h / (1 - e) of the series is left; events all but the last 1e-7 of
// the speeds, and the rest of the series is a closed form.

#include "study/stability/coming_to_rest_map.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "dynamics/integrators/semi_implicit_euler.h"
#include "simulate/simulate.h"
#include "study/stability/bounce_energy_map.h"
#include "study/stability/contact_scenes.h"
#include "study/stability/discrete_collisions.h"

namespace cradle {
namespace {

constexpr double kFallHeight = 1;     // m
constexpr double kLonger = 2;         // times as long as it should take
constexpr double kSettledSteps = 2;   // of gravity: a slower rebound is over within a step or two
constexpr double kAfterwards = 1;     // s
constexpr double kManyBounces = 0.5;  // restitution: with less, a mean over bounces says little
constexpr std::array<int, 3> kStepsPerSecond = {60, 240, 960};

}  // namespace

double zenoTime(double restitution) {
  return std::sqrt(2 * kFallHeight / kSceneGravity) * (1 + restitution) / (1 - restitution);
}

double measuredRestTime(double restitution, const std::optional<Method>& method) {
  Scene scene = bouncingBall(restitution, kFallHeight, kLonger * zenoTime(restitution));
  scene.method = method;
  scene.output.framesPerSecond = 1 / scene.duration;
  double rest = NAN;
  const auto note = [&](const Event& event) {
    if (event.kind == EventKind::rest && std::isnan(rest)) rest = event.time;
  };
  simulate(scene, {[](const Frame&) {}, note, [](const std::string&) {}});
  return rest;
}

TextbookRest textbookRest(double restitution, double timeStep) {
  const double end = kLonger * zenoTime(restitution) + kAfterwards;
  DiscreteCollisions run(bouncingBall(restitution, kFallHeight, end), semiImplicitEuler, timeStep);
  const double radius = run.assembly().radii[0];
  TextbookRest rest;
  while (run.time() < end && run.time() < rest.time + kAfterwards) {
    run.step();
    if (std::abs(linearVelocity(run.state(), 0).y()) > kSettledSteps * kSceneGravity * timeStep) rest.time = run.time();
  }
  rest.depth = radius - centerOfMass(run.state(), 0).y();
  return rest;
}

double expectedTextbookRestTime(double restitution, double timeStep) {
  const BounceMethod& method = bounceMethods()[1];
  double height = kFallHeight, time = std::sqrt(2 * kFallHeight / kSceneGravity);
  while (true) {
    const double speed = std::sqrt(2 * kSceneGravity * height);
    height = restitution * restitution * height + method.heightChange(restitution) * speed * timeStep;
    if (height <= 0 || std::sqrt(2 * kSceneGravity * height) < kSettledSteps * kSceneGravity * timeStep) return time;
    time += 2 * std::sqrt(2 * height / kSceneGravity);
  }
}

StabilityMap comingToRestMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "coming_to_rest";
  map.title = "Infinitely many bounces: error of the time at which a ball lies still";
  map.subtitle =
      "Zeno's time for a drop from 1 m: 0.4515 s (1 + e) / (1 - e). Textbook: semi-implicit Euler, impacts at the "
      "ends of steps.";
  map.paragraph =
      "A ball dropped from 1 m bounces infinitely often in the time t1 (1 + e) / (1 - e). Events follow the bounces "
      "down to 1e-7 of the speed and add what is left in closed form. Steps give up when a bounce takes no more "
      "than two of them, early by some steps. Textbook collisions with semi-implicit Euler lose height at each "
      "bounce, the more of it the lower the ball is, and end far too early. They have no rest at all: their time is "
      "when the ball was last faster than gravity makes it in two steps; afterwards it goes on sinking through the "
      "ground. Where a line dips, its error changes sign.";
  map.x = linearAxis("restitution", "", {});
  map.y = logarithmicAxis("|time of rest / Zeno's time - 1|", "", {});
  const std::vector<double> restitutions = evenlySpaced(0.1, 0.95, 18);
  MapCurve plan{"cradle's plan: events", CurveKind::series, {}};
  MapCurve steps{"cradle, RK4, steps of 1/960 s", CurveKind::series, {}};
  std::vector<MapCurve> textbook, theory(kStepsPerSecond.size(), {"theory of textbook steps", CurveKind::theory, {}});
  for (const int rate : kStepsPerSecond)
    textbook.push_back({fmt::format("textbook, steps of 1/{} s", rate), CurveKind::series, {}});
  for (std::size_t i = 0; i < restitutions.size(); ++i) {
    const double e = restitutions[i];
    const auto error = [&](double time) { return std::abs(time / zenoTime(e) - 1); };
    plan.points.push_back({e, error(measuredRestTime(e, {}))});
    steps.points.push_back({e, error(measuredRestTime(e, Method{MethodName::rk4, 1.0 / 960, "stability map"}))});
    for (std::size_t k = 0; k < textbook.size(); ++k)
      textbook[k].points.push_back({e, error(textbookRest(e, 1.0 / kStepsPerSecond[k]).time)}),
          theory[k].points.push_back(
              {e, e < kManyBounces ? NAN : error(expectedTextbookRestTime(e, 1.0 / kStepsPerSecond[k]))});
    progress(static_cast<double>(i + 1) / static_cast<double>(restitutions.size()));
  }
  map.panels = {
      {"dropped from 1 m", {}, {textbook[0], textbook[1], textbook[2], steps, plan, theory[0], theory[1], theory[2]}}};
  return map;
}

}  // namespace cradle
