// The forces of a rod keep its acceleration right (index 1), and nothing takes out what steps leave wrong: a length
// that is off stays off, a speed along the rod goes on (J. Baumgarte, "Stabilization of constraints and integrals of
// motion in dynamical systems", 1972).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/stability/fixed_step_trial.h"
#include "study/stability/island_steps.h"
#include "study/stability/smooth_motion_maps.h"

namespace cradle {
namespace {

constexpr double kDriftTime = 100;  // s
constexpr double kFirst = 0.1;      // s
constexpr int kTimesADecade = 8;
constexpr double kMinDrift = 1e-17, kMaxDrift = 1e2;  // m, shown
constexpr double kLostLength = 10;                    // m: the rod of 1 m has come apart

Scene rodPendulum() {
  return sceneOfText(
      R"({"schema": "cradle-scene/1", "name": "rod pendulum", "duration": 1,
      "bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.1}}, "collision": "none", "mass": 1,
      "position": [1, 0, 0]}],
      "rods": [{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}]})");
}

/// The largest error of the rod's length so far, at more and more times.
std::vector<MapPoint> driftOf(const FixedStepMethod& method, double timeStep, bool projects) {
  IslandSteps steps(rodPendulum(), method.integrate, timeStep, projects);
  std::vector<MapPoint> points;
  double largest = 0, next = kFirst;
  while (steps.time() < kDriftTime) {
    steps.advance();
    const double length = centerOfMass(steps.state(), 0).norm();
    if (!(length < kLostLength)) {
      points.push_back({steps.time(), kLostLength});
      return points;
    }
    largest = std::max(largest, std::abs(length - 1));
    if (steps.time() < next && steps.time() < kDriftTime) continue;
    while (next <= steps.time()) next *= std::pow(10, 1.0 / kTimesADecade);
    points.push_back({steps.time(), std::max(largest, kMinDrift)});
  }
  return points;
}

}  // namespace

StabilityMap rodDriftMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "rod_drift";
  map.title = "A rod of 1 m drifts apart, unless it is projected";
  map.subtitle =
      "A pendulum released horizontally. The exact force of the rod is in every evaluation; projection takes out what "
      "a "
      "step leaves wrong";
  map.paragraph =
      "With the exact constraint force in every evaluation, the length of a rod is still only as good as the steps: "
      "errors add up, a speed along the rod that an error has left goes on for ever, and a rod that is too long has no "
      "force that would pull it back. After 100 s in steps of 0.02 s a rod of 1 m is off by 6 cm with RK4; with "
      "semi-implicit Euler it is nearly three times as long. A method of order 8 only starts lower. Projection of "
      "lengths "
      "and velocities after each step, which is what Cradle does, leaves rounding, by any method and at any step, as "
      "long as the method is stable: explicit Euler, which gains energy, tears the rod apart in the end.";
  map.x = logarithmicAxis("time", "s", {});
  map.y = logarithmicAxis("largest error of the length", "m", {kMinDrift, kMaxDrift});
  addPanels(
      map,
      [](const FixedStepMethod& method, const MapProgress& part) {
        MapPanel panel{method.title, {}, {}};
        for (const double timeStep : {0.02, 0.002})
          for (const bool projects : {false, true}) {
            panel.curves.push_back({fmt::format("step {} s{}", timeStep, projects ? ", projected" : ""),
                                    CurveKind::series, driftOf(method, timeStep, projects)});
            part(static_cast<double>(panel.curves.size()) / 4);
          }
        return panel;
      },
      progress);
  return map;
}

}  // namespace cradle
