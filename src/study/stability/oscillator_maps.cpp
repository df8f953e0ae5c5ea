#include <fmt/format.h>

#include <cmath>

#include "study/stability/oscillator.h"
#include "study/stability/smooth_motion_maps.h"

namespace cradle {
namespace {

constexpr double kMinStiffness = 10, kMaxStiffness = 1e5;  // N/m, of 1 kg
constexpr double kShortestStep = 1e-3, kLongestStep = 1;   // s
constexpr double kMinStepOmega = 0.03;
constexpr int kColumns = 33, kRows = 49, kTheoryPoints = 129;
constexpr const char* kTheory = "limit by theory";

MapPanel stiffnessPanel(const StabilityMap& map, const FixedStepMethod& method, const MapProgress& progress) {
  const double limit = oscillatorLimit(method, 0);
  MapPanel panel{limit > 0 ? fmt::format("{}: step x omega < {:.3g}", method.title, limit)
                           : fmt::format("{}: no step is stable", method.title),
                 {},
                 {}};
  const auto trial = [&](double stiffness, double timeStep) {
    return static_cast<double>(oscillatorStability({std::sqrt(stiffness), 0}, method, timeStep));
  };
  panel.cells = cellsOf(map, trial, progress);
  MapCurve theory{kTheory, CurveKind::theory, {}}, measured{kMeasuredName, CurveKind::measured, {}};
  for (const double stiffness : someOf(map.x, kMeasured)) {
    const double found = measuredOscillatorLimit({std::sqrt(stiffness), 0}, method);
    if (limit > 0) theory.points.push_back({stiffness, limit / std::sqrt(stiffness)});
    if (found > 0) measured.points.push_back({stiffness, found});
  }
  panel.curves = {theory, measured};
  return panel;
}

MapPanel dampingPanel(const StabilityMap& map, const FixedStepMethod& method, const MapProgress& progress) {
  MapPanel panel{method.title, {}, {}};
  const auto trial = [&](double dampingRatio, double stepOmega) {
    return static_cast<double>(oscillatorStability({1, dampingRatio}, method, stepOmega));
  };
  panel.cells = cellsOf(map, trial, progress);
  MapCurve theory{kTheory, CurveKind::theory, {}}, measured{kMeasuredName, CurveKind::measured, {}};
  for (const double dampingRatio : someOf(map.x, kTheoryPoints))
    if (const double limit = oscillatorLimit(method, dampingRatio); limit > 0)
      theory.points.push_back({dampingRatio, limit});
  for (const double dampingRatio : someOf(map.x, kMeasured))
    if (const double found = measuredOscillatorLimit({1, dampingRatio}, method); found > 0)
      measured.points.push_back({dampingRatio, found});
  panel.curves = {theory, measured};
  return panel;
}

}  // namespace

StabilityMap stiffnessMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "step_stiffness";
  map.title = "Step and stiffness: a mass of 1 kg on a spring without damping";
  map.subtitle =
      "Ten periods, at least 300 steps. Unstable: energy from nowhere. Inaccurate: off by more than 10 % of the "
      "amplitude";
  map.paragraph =
      "Each explicit method can follow a spring only up to a step that is so many parts of its period: step x omega is "
      "2 for semi-implicit Euler, 2.83 for RK4 and 5.96 for DOP853, which does 12 evaluations of the forces in that "
      "step. A spring a hundred times as stiff needs steps a tenth as long, hence lines of slope -1/2. Explicit Euler "
      "has no limit at all: it gains energy at any step, and short steps only make it take longer. Between stable and "
      "right lies a wide band: semi-implicit Euler is stable, but its answer is good only below step x omega = 0.1.";
  map.x = logarithmicAxis("stiffness", "N/m", logarithmicallySpaced(kMinStiffness, kMaxStiffness, kColumns));
  map.y = logarithmicAxis("time step", "s", logarithmicallySpaced(kShortestStep, kLongestStep, kRows));
  map.outcomes = stabilityOutcomes();
  addPanels(
      map, [&](const FixedStepMethod& method, const MapProgress& part) { return stiffnessPanel(map, method, part); },
      progress);
  return map;
}

StabilityMap dampingMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "step_damping";
  map.title = "Step and damping: a mass on a spring with a damper beside it";
  map.subtitle =
      "Ten periods, at least 300 steps. Unstable: energy from nowhere. Inaccurate: off by more than 10 % of the "
      "amplitude";
  map.paragraph =
      "A damper takes energy out of the motion, and for that very reason limits the step: what it takes in a step that "
      "is too long is more than there was. A little damping is what explicit Euler lives on (step x omega < 2 zeta); "
      "strong damping shortens the step of every method. Semi-implicit Euler takes the damper's force from the start "
      "of the step, and its limit falls from 2 at once: 2 (sqrt(1 + zeta^2) - zeta). RK4 and DOP853 follow the borders "
      "of their stability regions along the roots of the damped oscillator. Beyond critical damping (zeta = 1) one "
      "root is fast and does nothing but limit the step.";
  map.x = linearAxis("damping ratio zeta (1: critical)", "", evenlySpaced(0, kMaxDamping, kColumns));
  map.y = logarithmicAxis("step x omega", "rad", logarithmicallySpaced(kMinStepOmega, kMaxStepOmega, kRows));
  map.outcomes = stabilityOutcomes();
  addPanels(
      map, [&](const FixedStepMethod& method, const MapProgress& part) { return dampingPanel(map, method, part); },
      progress);
  return map;
}

}  // namespace cradle
