#include "study/stability/smooth_motion_maps.h"
#include "study/stability/tumbling.h"

namespace cradle {
namespace {

constexpr double kMinSpeed = 1, kMaxSpeed = 100;                          // rad/s
constexpr double kShortestTumblingStep = 3e-3, kLongestTumblingStep = 1;  // s
constexpr int kSpeedColumns = 31, kStepRows = 41;

MapPanel panelOf(const StabilityMap& map, const FixedStepMethod& method, const MapProgress& progress) {
  const auto trial = [&](double speed, double timeStep) {
    return static_cast<double>(tumblingOf(speed, method, timeStep));
  };
  MapPanel panel{method.title, cellsOf(map, trial, progress), {}};
  MapCurve radian{"1 rad in a step", CurveKind::theory, {}}, tenth{"0.1 rad in a step", CurveKind::theory, {}};
  for (const double speed : map.x.values) {
    radian.points.push_back({speed, 1 / speed});
    tenth.points.push_back({speed, 0.1 / speed});
  }
  panel.curves = {radian, tenth};
  return panel;
}

}  // namespace

StabilityMap freeRotationMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "free_rotation";
  map.title = "Speed and step: a body that spins about its middle axis turns over";
  map.subtitle =
      "Moments of inertia 1, 2, 3 kg m^2, tilted by 1 %, until it has turned by 60 rad and turned over three times; "
      "truth: the closed form";
  map.paragraph =
      "Only the angle turned in a step counts, so all borders are lines of slope -1. Both Euler methods wind energy "
      "into the spin: semi-implicit Euler, which does so well on springs, has nothing to be symplectic about here, and "
      "is right only below 0.03 rad in a step. RK4 is right up to 0.2 rad, DOP853 up to 1 rad. Between there and the "
      "steps at which energy shows that something is wrong, both turn the body over at the wrong time, or not at all: "
      "that energy is kept does not mean that a motion is right.";
  map.x = logarithmicAxis("angular speed", "rad/s", logarithmicallySpaced(kMinSpeed, kMaxSpeed, kSpeedColumns));
  map.y =
      logarithmicAxis("time step", "s", logarithmicallySpaced(kShortestTumblingStep, kLongestTumblingStep, kStepRows));
  map.outcomes = {{"right", "#a9d3ee"},
                  {"turns over at the wrong time, or not at all", "#f7dc8a"},
                  {"energy off by more than 10 %", "#e79a7c"},
                  {"stopped as unstable", "#9d8ba6"}};
  addPanels(
      map, [&](const FixedStepMethod& method, const MapProgress& part) { return panelOf(map, method, part); },
      progress);
  return map;
}

}  // namespace cradle
