// A body with three different moments of inertia that spins about the middle one turns over again and again (L.
// Poinsot, 1834): the closed form of dynamics/free_rotation says when.

#include <algorithm>
#include <cmath>

#include "dynamics/free_rotation.h"
#include "study/stability/fixed_step_trial.h"
#include "study/stability/smooth_motion_maps.h"

namespace cradle {
namespace {

constexpr double kTilt = 0.01;  // of the spin, about the other axes at the start
constexpr double kTurned = 60;  // rad: with that tilt, the body turns over three times
constexpr long kLeastSteps = 30;
constexpr long kMostFrames = 200;  // looked at
constexpr double kClear = 0.5;     // of the spin: about the middle axis, between two turns over
constexpr double kEnergyError = 0.1;
constexpr double kLeastSpeed = 1, kMostSpeed = 100;       // rad/s
constexpr double kShortestStep = 3e-3, kLongestStep = 1;  // s
constexpr int kColumns = 31, kRows = 41;

enum class Turning { right, flipsWrong, energyWrong, stopped };

Scene tumblingScene(double speed) {
  static const Scene prototype = sceneOfText(
      R"({"schema": "cradle-scene/1", "name": "tumbling", "duration": 1, "gravity": [0, 0, 0],
      "bodies": [{"name": "body", "shape": {"box": {"size": [1, 1, 1]}}, "collision": "none", "mass": 1,
      "centerOfMass": [0, 0, 0], "inertiaTensor": [[1, 0, 0], [0, 2, 0], [0, 0, 3]]}]})");
  Scene scene = prototype;
  scene.bodies[0].angularVelocity = speed * Vec3(kTilt, 1, kTilt);
  return scene;
}

/// Parts of the spin about the body's axes.
Vec3 spinOf(const Quat& worldFromBody, const Vec3& angularVelocity, double speed) {
  return worldFromBody.conjugate() * angularVelocity / speed;
}

Turning turningOf(double speed, const FixedStepMethod& method, double timeStep) {
  const long steps = std::max(kLeastSteps, static_cast<long>(std::ceil(kTurned / (speed * timeStep))));
  const long stepsAFrame = std::max(1L, steps / kMostFrames);
  Scene scene = tumblingScene(speed);
  const Mat3& inertiaTensor = scene.bodies[0].massProperties.inertiaTensor;
  const FreeRotation truth(inertiaTensor, {Quat::Identity(), scene.bodies[0].angularVelocity});
  const FixedStepTrial trial = tryFixedSteps(scene, method, {timeStep, stepsAFrame, std::max(1L, steps / stepsAFrame)});
  if (trial.isUnstable) return Turning::stopped;
  Turning turning = Turning::right;
  const double energy = trial.frames[0].energy.kinetic;
  for (const Frame& frame : trial.frames) {
    if (!(std::abs(frame.energy.kinetic - energy) <= kEnergyError * energy)) return Turning::energyWrong;
    const RotationState right = truth.at(frame.time);
    const double wanted = spinOf(right.worldFromBody, right.angularVelocity, speed).y();
    const double found = spinOf(frame.states[0].orientation, frame.states[0].angularVelocity, speed).y();
    if (std::abs(wanted) > kClear && wanted * found < 0) turning = Turning::flipsWrong;
  }
  return turning;
}

MapPanel panelOf(const StabilityMap& map, const FixedStepMethod& method, const MapProgress& progress) {
  MapPanel panel{method.title, {}, {}};
  for (std::size_t row = 0; row < map.y.values.size(); ++row) {
    for (const double speed : map.x.values)
      panel.cells.push_back(static_cast<double>(turningOf(speed, method, map.y.values[row])));
    progress(static_cast<double>(row + 1) / static_cast<double>(map.y.values.size()));
  }
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
      "into "
      "the spin: semi-implicit Euler, which does so well on springs, has nothing to be symplectic about here, and is "
      "right only below 0.03 rad in a step. RK4 is right up to 0.2 rad, DOP853 up to 1 rad. Between there and the "
      "steps "
      "at which energy shows that something is wrong, both turn the body over at the wrong time, or not at all: that "
      "energy is kept does not mean that a motion is right.";
  map.x = logarithmicAxis("angular speed", "rad/s", logarithmicallySpaced(kLeastSpeed, kMostSpeed, kColumns));
  map.y = logarithmicAxis("time step", "s", logarithmicallySpaced(kShortestStep, kLongestStep, kRows));
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
