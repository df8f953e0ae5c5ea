// Textbook collisions see a marble of radius r at a plate of thickness d if a step ends within the d + 2 r of its way
// in which they overlap: v h < d + 2 r. The shortest way out leads back only before the middle of the plate, so that
// the marble is stopped for v h < d / 2 + r. At another moment of the step it may be luckier.

#include "study/stability/tunnelling_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "dynamics/integrators/semi_implicit_euler.h"
#include "simulate/simulate.h"
#include "study/peers/peer.h"
#include "study/stability/contact_scenes.h"
#include "study/stability/discrete_collisions.h"

namespace cradle {
namespace {

constexpr double kNoGap = 1e-9;                                  // m
constexpr std::array<double, 4> kPhases = {0, 0.25, 0.5, 0.75};  // of a step's way: gaps that throws begin with
constexpr std::size_t kSpeedsTogether = 16;  // in a scene: enough marbles for soft sub-stepping, few for MuJoCo
constexpr int kSpeedBisections = 40;
constexpr double kFastStepAccuracy = 1e-3;  // for which the plan takes soft sub-stepping

/// What becomes of each marble of a scene.
using Thrower = std::function<std::vector<Passage>(Scene)>;

/// The plate is at x = 0, and marbles come from the left.
bool isPast(double x) {
  return x > 0;
}

std::vector<Passage> throwDiscretely(const Scene& scene, double timeStep, Integrator integrate) {
  DiscreteCollisions run(scene, integrate, timeStep);
  while (run.time() < scene.duration) run.step();
  std::vector<Passage> passages;
  for (int body = 0; body < bodyCount(run.state()); ++body)
    passages.push_back(!isPast(centerOfMass(run.state(), body).x()) ? Passage::stopped
                       : run.hasTouched(body)                       ? Passage::pushedThrough
                                                                    : Passage::unseen);
  return passages;
}

std::vector<Passage> throwByPlan(Scene scene) {
  scene.output.framesPerSecond = 1 / scene.duration;
  std::vector<Passage> passages;
  const auto take = [&](const Frame& frame) {
    passages.clear();
    for (const BodyState& state : frame.states)
      passages.push_back(isPast(state.position.x()) ? Passage::unseen : Passage::stopped);
  };
  simulate(scene, {take, [](const Event&) {}, [](const std::string&) {}});
  return passages;
}

std::vector<Passage> throwVisually(Scene scene) {
  scene.accuracy = kFastStepAccuracy;
  return throwByPlan(std::move(scene));
}

std::vector<Passage> throwInPeer(const Peer& peer, const Scene& scene) {
  const Assembly assembly = assemble(scene, wholeScene(scene));
  const auto world = peer.open(scene, assembly, kUsualStep);
  VectorX state = assembly.state;
  world->advance(scene.duration);
  world->read(state);
  std::vector<Passage> passages;
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    passages.push_back(isPast(centerOfMass(state, body).x()) ? Passage::unseen : Passage::stopped);
  return passages;
}

/// Throws of some of the speeds, at all phases of each, one after the other.
std::vector<Throw> throwsOf(const std::vector<double>& speeds, std::size_t first, std::size_t end) {
  std::vector<Throw> throws;
  for (std::size_t i = first; i < end; ++i)
    for (const double phase : kPhases) throws.push_back({kNoGap + phase * speeds[i] * kUsualStep, speeds[i]});
  return throws;
}

/// The worst that happened to marbles of each speed, by plates of each thickness.
MapPanel panelOf(const std::string& title, const Thrower& thrower, const StabilityMap& map) {
  const std::vector<double>&thicknesses = map.x.values, &speeds = map.y.values;
  MapPanel panel{title, std::vector<double>(thicknesses.size() * speeds.size(), 0), {}};
  for (std::size_t column = 0; column < thicknesses.size(); ++column)
    for (std::size_t first = 0, end = 0; first < speeds.size(); first = end) {
      end = std::min(first + kSpeedsTogether, speeds.size());
      const auto passages = thrower(marblesAtPlate(thicknesses[column], throwsOf(speeds, first, end)));
      for (std::size_t i = 0; i < passages.size(); ++i) {
        double& cell = panel.cells[(first + i / kPhases.size()) * thicknesses.size() + column];
        cell = std::max(cell, static_cast<double>(passages[i]));
      }
    }
  return panel;
}

/// Between a hundredth and ten times what theory has, by bisection.
double fastest(const PlateTrial& trial, const std::function<bool(Passage)>& isGood) {
  const double seen = (trial.thickness + 2 * kMarbleRadius) / trial.timeStep;
  double good = 0.01 * seen, bad = 10 * seen;
  for (int i = 0; i < kSpeedBisections; ++i) {
    const double speed = std::sqrt(good * bad);
    const Scene scene = marblesAtPlate(trial.thickness, {{kNoGap, speed}});
    (isGood(throwDiscretely(scene, trial.timeStep, trial.integrate)[0]) ? good : bad) = speed;
  }
  return good;
}

/// Of textbook collisions, that engines which look at the ends of steps alone have too.
std::vector<MapCurve> throughTheory(const StabilityMap& map) {
  MapCurve stopped{"theory: v h = d/2 + r, v h = d + 2 r", CurveKind::theory, {}}, seen = stopped;
  for (const double thickness : map.x.values) {
    stopped.points.push_back({thickness, (thickness / 2 + kMarbleRadius) / kUsualStep});
    seen.points.push_back({thickness, (thickness + 2 * kMarbleRadius) / kUsualStep});
  }
  return {stopped, seen};
}

MapCurve measuredBoundary(const StabilityMap& map) {
  MapCurve measured{"found by bisection", CurveKind::measured, {}};
  for (const double thickness : map.x.values) {
    const PlateTrial trial{thickness, kUsualStep, semiImplicitEuler};
    measured.points.push_back({thickness, fastestStopped(trial)});
    measured.points.push_back({thickness, fastestSeen(trial)});
  }
  return measured;
}

}  // namespace

double fastestStopped(const PlateTrial& trial) {
  return fastest(trial, [](Passage passage) { return passage == Passage::stopped; });
}

double fastestSeen(const PlateTrial& trial) {
  return fastest(trial, [](Passage passage) { return passage != Passage::unseen; });
}

StabilityMap tunnellingMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "tunnelling";
  map.title = "Marbles of radius 1 cm at a plate: where they get through, with steps of 1/60 s";
  map.subtitle = "A cell is four marbles, thrown at four moments of a step; it shows the worst of them. No gravity.";
  map.paragraph =
      "Collisions that are looked for at the ends of steps alone miss what passes between them: v h > d + 2 r; and "
      "what is seen beyond the middle of the plate is let out on the wrong side: v h > d/2 + r. The plan goes from "
      "impact to impact, the fast contact step looks ahead by a step's way: nothing gets through. The other engines "
      "run with their defaults: ODE does as the textbook says, Bullet looks 2 cm ahead, MuJoCo's soft contacts give "
      "way long before.";
  map.x = logarithmicAxis("thickness of the plate", "m", logarithmicallySpaced(1e-3, 1, 25));
  map.y = logarithmicAxis("speed", "m/s", logarithmicallySpaced(0.3, 300, 31));
  map.outcomes = {{"stopped", "#a9d3ee"}, {"let out on the far side", "#f7dc8a"}, {"passed", "#e79a7c"}};
  std::vector<std::pair<std::string, Thrower>> throwers = {
      {"textbook: at the ends of steps",
       [](const Scene& scene) { return throwDiscretely(scene, kUsualStep, semiImplicitEuler); }},
      {"cradle's plan: time of impact", throwByPlan},
      {"cradle's fast contact step", throwVisually}};
  for (const Peer& peer : peers())
    if (peer.name == peer.engine && peer.setting == SettingKind::timeStep)
      throwers.emplace_back(peer.title, [&peer](const Scene& scene) { return throwInPeer(peer, scene); });
  for (const auto& [title, thrower] : throwers) {
    map.panels.push_back(panelOf(title, thrower, map));
    progress(static_cast<double>(map.panels.size()) / static_cast<double>(throwers.size()));
  }
  for (MapPanel& panel : map.panels)
    if (!panel.title.starts_with("cradle")) panel.curves = throughTheory(map);
  map.panels.front().curves.push_back(measuredBoundary(map));
  return map;
}

}  // namespace cradle
