// The same for rods as stacks_map.h is for contacts. Light links that carry a heavy bob swing across it as a string
// does, at sqrt(pull / mass x length): that is what bounds explicit steps here, not the rods.

#include "study/stability/chains_map.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

constexpr double kAccuracy = 1e-6;                  // of the plan: its default
constexpr double kHolds = 1e-3, kStretches = 1e-1;  // m, of rods of 1 m
constexpr double kChainCpuLimit = 2;                // s of a run; 0.1 s are usual

const double kBottomPull = 3 - 2 * std::sqrt(0.75);  // of the weight: a pendulum's let go at 30 degrees
constexpr double kRk4Limit = 2.828427124746190;      // of step x frequency
constexpr int kBisections = 60;

struct Way {
  const char *method, *title;
};
constexpr std::array<Way, 6> kWays = {{{"plan", "cradle's plan: DOP853"},
                                       {"rk4", "cradle, RK4"},
                                       {"bulletTuned", "Bullet, tuned"},
                                       {"ode", "ODE, step"},
                                       {"odeQuick", "ODE, quick step"},
                                       {"mujocoTuned", "MuJoCo, implicit, stiff"}}};

/// rad/s, of balls of 1 kg on rods of 1 m that pull with what hangs below them.
double fastestSwing(int balls, double bobMass) {
  const auto massOf = [&](int ball) { return ball == balls - 1 ? bobMass : 1.0; };
  const auto pullOn = [&](int ball) {  // N, of the rod above the ball
    double mass = 0;
    for (int below = ball; below < balls; ++below) mass += massOf(below);
    return kBottomPull * kSceneGravity * mass;
  };
  MatrixX stiffness = MatrixX::Zero(balls, balls);  // scaled to masses of 1
  for (int i = 0; i < balls; ++i) {
    stiffness(i, i) = (pullOn(i) + (i + 1 < balls ? pullOn(i + 1) : 0)) / massOf(i);
    if (i > 0) stiffness(i, i - 1) = stiffness(i - 1, i) = -pullOn(i) / std::sqrt(massOf(i) * massOf(i - 1));
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<MatrixX>(stiffness, Eigen::EigenvaluesOnly).eigenvalues()[balls - 1]);
}

MapCurve theoryOf(const StabilityMap& map) {
  MapCurve theory{"theory of RK4: step x fastest swing across = 2.83", CurveKind::theory, {}};
  for (const double balls : map.y.values)
    theory.points.push_back({heaviestForRk4(static_cast<int>(balls), kUsualStep), balls});
  return theory;
}

}  // namespace

ChainOutcome outcomeOf(const StudyRun& run) {
  if (run.status != RunStatus::ok) return ChainOutcome::stopped;
  return run.constraintDrift <= kHolds       ? ChainOutcome::holds
         : run.constraintDrift <= kStretches ? ChainOutcome::stretches
                                             : ChainOutcome::parts;
}

double heaviestForRk4(int balls, double timeStep) {
  double light = 1e-3, heavy = 1e9;
  for (int i = 0; i < kBisections; ++i) {
    const double mass = std::sqrt(light * heavy);
    (timeStep * fastestSwing(balls, mass) < kRk4Limit ? light : heavy) = mass;
  }
  return light;
}

namespace {

std::vector<double> cellsOf(const StabilityMap& map, const StudyMethod& method) {
  const double setting = method.setting == SettingKind::timeStep ? kUsualStep : kAccuracy;
  std::vector<double> cells;
  for (const double balls : map.y.values)
    for (const double mass : map.x.values) {
      StudyScene scene(swingingChain(static_cast<int>(balls), mass));
      cells.push_back(static_cast<double>(outcomeOf(scene.run(method, setting, kChainCpuLimit))));
    }
  return cells;
}

}  // namespace

StabilityMap chainsMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "chains";
  map.title = "Chains with a heavy ball at the end, swinging: where their rods hold for 5 s";
  map.subtitle =
      "Balls of 1 kg on rods of 1 m, let go at 30 degrees from the vertical, in a line; the last is heavier. All "
      "but the plan go by steps of 1/60 s.";
  map.paragraph =
      "Solvers that sweep leave rods a part of the pull at every step: the chain gets longer, and comes apart for a "
      "last ball of thirty to a hundred times the mass. Cradle factorises all rods at once and projects what steps "
      "leave: rods hold to rounding. What bounds RK4 is not the rods but that light balls under a strong pull swing "
      "across the chain as a string does, faster than steps can follow: it stops with an error there; the plan "
      "takes smaller steps.";
  map.x = logarithmicAxis("mass of the last ball / others", "", logarithmicallySpaced(1, 1e4, 9));
  map.y = linearAxis("balls", "", {2, 4, 6, 8, 10, 12});
  map.outcomes = {{"rods keep their length to 1 mm", "#a9d3ee"},
                  {"to 10 cm", "#f7dc8a"},
                  {"come apart", "#e79a7c"},
                  {"energy from nowhere, or stopped with an error", "#c8c8c8"}};
  for (const Way& way : kWays)
    for (const StudyMethod& method : studyMethods()) {
      if (method.name != way.method) continue;
      map.panels.push_back({way.title, cellsOf(map, method), {}});
      if (method.name == "rk4") map.panels.back().curves = {theoryOf(map)};
      progress(static_cast<double>(map.panels.size()) / static_cast<double>(kWays.size()));
    }
  return map;
}

}  // namespace cradle
