// The trap of a step that is too long without blowing up: R. M. May, "Simple mathematical models with very complicated
// dynamics", Nature 261, 1976, for Euler's method; RK4 has false equilibria beside, where y grows in no step though y'
// is not 0 there.

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "study/stability/logistic_equation.h"
#include "study/stability/smooth_motion_maps.h"
#include "study/stability/stability_region.h"

namespace cradle {
namespace {

constexpr double kGrowthTime = 8;  // s: all that settles has
constexpr double kMinValue = -50, kMaxValue = 1250;
constexpr int kTransient = 400, kShown = 32;                             // steps
constexpr double kShortestGrowthStep = 0.025, kLongestGrowthStep = 1.1;  // s
constexpr int kStepCount = 216;

const std::vector<const char*> kMethods = {"explicitEuler", "rk4", "dop853FixedStep"};

MapPanel panelOf(double timeStep) {
  MapPanel panel{fmt::format("step {} s", timeStep), {}, {{"exact: 857.14 at the end", CurveKind::theory, {}}}};
  for (const double time : evenlySpaced(0, kGrowthTime, 400))
    panel.curves[0].points.push_back({time, logisticSolution(time)});
  for (const char* name : kMethods) {
    const FixedStepMethod& method = fixedStepMethod(name);
    MapCurve curve{method.title, CurveKind::series, {}};
    const int steps = static_cast<int>(kGrowthTime / timeStep + 0.5);
    const std::vector<double> values = logisticSteps(method.integrate, timeStep, steps);
    for (std::size_t i = 0; i < values.size(); ++i)
      curve.points.push_back({static_cast<double>(i) * timeStep, values[i]});
    panel.curves.push_back(curve);
  }
  return panel;
}

/// What a method does after a long time, for each step.
MapPanel panelOf(const FixedStepMethod& method) {
  MapPanel panel{method.title, {}, {}};
  const double limit = decayLimit(method) / kLogisticGrowth;
  panel.curves.push_back({"longest step that settles at the equilibrium, by theory",
                          CurveKind::theory,
                          {{limit, kMinValue}, {limit, kMaxValue}}});
  panel.curves.push_back(
      {"equilibrium: 857.14", CurveKind::theory, {{0, kLogisticEnd}, {kLongestGrowthStep, kLogisticEnd}}});
  MapCurve dots{fmt::format("values of steps {} to {}", kTransient + 1, kTransient + kShown), CurveKind::dots, {}};
  for (const double timeStep : evenlySpaced(kShortestGrowthStep, kLongestGrowthStep, kStepCount)) {
    const std::vector<double> values = logisticSteps(method.integrate, timeStep, kTransient + kShown);
    std::set<long> shown;
    for (std::size_t i = kTransient + 1; i < values.size(); ++i)
      if (std::isfinite(values[i]) && shown.insert(std::lround(values[i])).second)
        dots.points.push_back({timeStep, values[i]});
  }
  panel.curves.push_back(dots);
  if (method.name == "rk4")
    panel.curves.push_back({"RK4 at 0.5 s: 652.13",
                            CurveKind::measured,
                            {{0.5, logisticSteps(method.integrate, 0.5, kTransient).back()}}});
  return panel;
}

}  // namespace

StabilityMap logisticMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "logistic";
  map.title = "A wrong answer that looks right: RK4 settles at 652.13 instead of 857.14";
  map.subtitle = "The logistic equation y' = 6 y - 0.007 y^2, y(0) = 10, in fixed steps";
  map.paragraph =
      "The logistic equation grows to its equilibrium 6 / 0.007 = 857.14 and stays there. In steps of 0.5 s RK4 "
      "settles too, smoothly and for ever, but at 652.13: a value where its step leads back to itself though y' is not "
      "0 there. Nothing blows up and nothing looks wrong; half the step shows it. Explicit Euler jumps about, since "
      "step x rate = 3 is beyond its limit of 2; it is beyond the 2.79 of RK4 too, which is why the true equilibrium "
      "throws RK4 off. DOP853 has room to 6.4 and finds the equilibrium.";
  map.x = linearAxis("time", "s", {0, kGrowthTime});
  map.y = linearAxis("y", "", {kMinValue, kMaxValue});
  map.panels = {panelOf(0.5), panelOf(0.25)};
  progress(1);
  return map;
}

StabilityMap logisticStepMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "logistic_step";
  map.title = "Where the logistic equation settles, by the step";
  map.subtitle = fmt::format(
      "y' = 6 y - 0.007 y^2, y(0) = 10: what is there after {} steps. One dot above a step: the method has settled; "
      "many: "
      "it never does",
      kTransient);
  map.paragraph =
      "Up to its limit each method ends at the equilibrium, whatever it does on the way there. Beyond, explicit Euler "
      "first swings between two values, then four, and then never repeats itself, the textbook road to chaos, made by "
      "nothing but the step. RK4 leaves the equilibrium for another value that moves with the step: 652.13 at 0.5 s. "
      "The limits are where the stability polynomial R(-6 h) reaches 1 in size: step x rate = 2, 2.785 and 6.4.";
  map.x = linearAxis("time step", "s", {0, kLongestGrowthStep});
  map.y = linearAxis("y", "", {kMinValue, kMaxValue});
  for (std::size_t i = 0; i < kMethods.size(); ++i) {
    map.panels.push_back(panelOf(fixedStepMethod(kMethods[i])));
    progress(static_cast<double>(i + 1) / static_cast<double>(kMethods.size()));
  }
  return map;
}

}  // namespace cradle
