// Between bounces Euler's methods keep g y + v^2/2 + a g h v exactly (a = 1/2 the explicit, -1/2 the semi-implicit
// one), RK4 is exact on parabolas (a = 0). Textbook collisions turn v = -s into e s at the depth d that the step's end
// has, 0 <= d < s h: the sum becomes e^2 of itself - (1 - e^2) g d + a g h s e (1 + e). With d = s h / 2 in the mean,
// the height that a bounce leaves is e^2 of the one before + s h (1 + e) (a e - (1 - e) / 2).

#include "study/stability/bounce_energy_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/semi_implicit_euler.h"
#include "simulate/simulate.h"
#include "study/stability/contact_scenes.h"
#include "study/stability/discrete_collisions.h"

namespace cradle {
namespace {

constexpr double kDropHeight = 1;  // m
constexpr double kPatience = 20;   // s: five bounces from 1 m take 5 s at the most
constexpr double kPhaseSteps = 4;  // over which drops are spread
constexpr int kDrops = 16;
constexpr double kHighest = 2;  // right heights, that the chart shows
constexpr std::array<double, 4> kRestitutions = {1, 0.9, 0.8, 0.6};

/// Height (m) that a ball in flight comes from, or goes to.
double apexOf(const VectorX& state, double radius) {
  const double speed = linearVelocity(state, 0).y();
  return centerOfMass(state, 0).y() - radius + speed * speed / (2 * kSceneGravity);
}

double rightPart(double restitution) {
  return std::pow(restitution, 2 * kCountedBounces);
}

/// When the ball is at its highest after the last bounce counted.
double apexTime(double restitution) {
  const double fall = std::sqrt(2 * kDropHeight / kSceneGravity);
  double time = fall;
  for (int bounce = 1; bounce < kCountedBounces; ++bounce) time += 2 * fall * std::pow(restitution, bounce);
  return time + fall * std::pow(restitution, kCountedBounces);
}

MapPanel panelOf(const BounceMethod& method, const std::vector<double>& steps) {
  MapPanel panel{"textbook, " + method.title, {}, {}};
  std::vector<MapCurve> theories;
  for (const double restitution : kRestitutions) {
    MapCurve theory{"theory", CurveKind::theory, {}};
    MapCurve measured{fmt::format("restitution {}", restitution), CurveKind::series, {}};
    for (const double step : steps) {
      theory.points.push_back({step, 1 + expectedHeightError(method, restitution, step)});
      measured.points.push_back({step, 1 + meanHeightError(method, restitution, step, kDrops)});
    }
    panel.curves.push_back(measured), theories.push_back(theory);
  }
  panel.curves.insert(panel.curves.end(), theories.begin(), theories.end());
  return panel;
}

MapPanel panelWithEvents(const std::vector<double>& steps) {
  MapPanel panel{"cradle, RK4 and steps that end at impacts", {}, {}};
  for (const double restitution : kRestitutions) {
    MapCurve measured{fmt::format("restitution {}", restitution), CurveKind::series, {}};
    for (const double step : steps)
      measured.points.push_back(
          {step, 1 + heightErrorWithEvents(restitution, Method{MethodName::rk4, step, "stability map"})});
    panel.curves.push_back(measured);
  }
  return panel;
}

}  // namespace

double BounceMethod::heightChange(double restitution) const {
  const double kept = name == MethodName::explicitEuler ? 0.5 : name == MethodName::semiImplicitEuler ? -0.5 : 0;
  return (1 + restitution) * (kept * restitution - (1 - restitution) / 2);
}

const std::vector<BounceMethod>& bounceMethods() {
  static const std::vector<BounceMethod> methods = {
      {"explicit Euler", MethodName::explicitEuler, explicitEuler},
      {"semi-implicit Euler", MethodName::semiImplicitEuler, semiImplicitEuler},
      {"RK4", MethodName::rk4, rk4}};
  return methods;
}

double heightAfterBounces(const BounceMethod& method, double restitution, double height, double timeStep) {
  DiscreteCollisions run(bouncingBall(restitution, height, kPatience), method.integrate, timeStep);
  const double radius = run.assembly().radii[0];
  while (run.bounces() < kCountedBounces) {
    if (run.time() > kPatience) return NAN;
    run.step();
  }
  double highest = -INFINITY, apex = 0;
  while (centerOfMass(run.state(), 0).y() > highest) {
    highest = centerOfMass(run.state(), 0).y();
    apex = apexOf(run.state(), radius);
    run.step();
  }
  return apex;
}

double meanHeightError(const BounceMethod& method, double restitution, double timeStep, int drops) {
  const double speed = std::sqrt(2 * kSceneGravity * kDropHeight);
  double sum = 0;
  for (int drop = 0; drop < drops; ++drop) {
    const double height = kDropHeight + kPhaseSteps * speed * timeStep * drop / drops;
    sum += std::max(0.0, heightAfterBounces(method, restitution, height, timeStep)) / height;
  }
  return sum / drops / rightPart(restitution) - 1;
}

double expectedHeightError(const BounceMethod& method, double restitution, double timeStep) {
  double height = kDropHeight;
  for (int bounce = 0; bounce < kCountedBounces; ++bounce) {
    const double speed = std::sqrt(2 * kSceneGravity * height);
    height = std::max(0.0, restitution * restitution * height + method.heightChange(restitution) * speed * timeStep);
  }
  return height / kDropHeight / rightPart(restitution) - 1;
}

double heightErrorWithEvents(double restitution, const std::optional<Method>& method) {
  Scene scene = bouncingBall(restitution, kDropHeight, apexTime(restitution));
  scene.method = method;
  scene.output.framesPerSecond = 1 / scene.duration;
  double height = 0;
  const double radius = std::get<Sphere>(scene.bodies[1].shape).radius;
  const auto take = [&](const Frame& frame) {
    const BodyState& ball = frame.states[0];
    height = ball.position.y() - radius + ball.linearVelocity.y() * ball.linearVelocity.y() / (2 * kSceneGravity);
  };
  simulate(scene, {take, [](const Event&) {}, [](const std::string&) {}});
  return height / kDropHeight / rightPart(restitution) - 1;
}

StabilityMap bounceEnergyMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "bounce_energy";
  map.title = "A ball dropped from 1 m: its height after five bounces, in parts of the right one";
  map.subtitle =
      "Textbook collisions are looked for at the ends of steps alone; the mean of 16 drops, whose impacts fall at "
      "all moments of a step.";
  map.paragraph =
      "Textbook collisions turn the velocity round where a step happens to end, below the ground, and Euler's "
      "methods keep an energy of their own, which the turn changes. In the mean over all moments of a step a bounce "
      "with speed s changes the height by s h (1 + e) (a e - (1 - e) / 2), h the step, e the restitution: a = 1/2 "
      "for explicit Euler (the ball gains height, also with e = 1), -1/2 for semi-implicit Euler (it loses), 0 for "
      "RK4 (right for e = 1; with loss it loses more than it should). With e = 0.6 and steps of 0.014 s "
      "semi-implicit Euler leaves less than a hundredth of the height. Steps that end at impacts are right to 1e-11 "
      "at any step and restitution.";
  map.x = logarithmicAxis("time step", "s", {});
  map.y = linearAxis("height / right height", "", {0, kHighest});
  const std::vector<double> steps = logarithmicallySpaced(3e-4, 3e-2, 7);
  for (const BounceMethod& method : bounceMethods()) {
    map.panels.push_back(panelOf(method, steps));
    progress(static_cast<double>(map.panels.size()) / static_cast<double>(bounceMethods().size()));
  }
  map.panels.push_back(panelWithEvents(steps));
  return map;
}

}  // namespace cradle
