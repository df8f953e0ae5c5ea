// A body with three different moments of inertia that spins about the middle one turns over again and again (L.
// Poinsot, 1834): the closed form of dynamics/free_rotation says when.

#include "study/stability/tumbling.h"

#include <algorithm>
#include <cmath>

#include "dynamics/free_rotation.h"

namespace cradle {
namespace {

constexpr double kTilt = 0.01;  // of the spin, about the other axes at the start
constexpr double kTurned = 60;  // rad: with that tilt, the body turns over three times
constexpr long kMinTumblingSteps = 30;
constexpr long kMaxTumblingFrames = 200;  // looked at
constexpr double kClear = 0.5;            // of the spin: about the middle axis, between two turns over
constexpr double kEnergyError = 0.1;

/// Parts of the spin about the body's axes.
Vec3 spinOf(const Quat& worldFromBody, const Vec3& angularVelocity, double speed) {
  return worldFromBody.conjugate() * angularVelocity / speed;
}

}  // namespace

Scene tumblingScene(double speed) {
  static const Scene prototype = sceneOfText(
      R"({"schema": "cradle-scene/1", "name": "tumbling", "duration": 1, "gravity": [0, 0, 0],
      "bodies": [{"name": "body", "shape": {"box": {"size": [1, 1, 1]}}, "collision": "none", "mass": 1,
      "centerOfMass": [0, 0, 0], "inertiaTensor": [[1, 0, 0], [0, 2, 0], [0, 0, 3]]}]})");
  Scene scene = prototype;
  scene.bodies[0].angularVelocity = speed * Vec3(kTilt, 1, kTilt);
  return scene;
}

Tumbling tumblingOf(double speed, const FixedStepMethod& method, double timeStep) {
  const long steps = std::max(kMinTumblingSteps, static_cast<long>(std::ceil(kTurned / (speed * timeStep))));
  const long stepsAFrame = std::max(1L, steps / kMaxTumblingFrames);
  Scene scene = tumblingScene(speed);
  const Mat3& inertiaTensor = scene.bodies[0].massProperties.inertiaTensor;
  const FreeRotation truth(inertiaTensor, {Quat::Identity(), scene.bodies[0].angularVelocity});
  const FixedStepTrial trial = tryFixedSteps(scene, method, {timeStep, stepsAFrame, std::max(1L, steps / stepsAFrame)});
  if (trial.isUnstable) return Tumbling::stopped;
  Tumbling tumbling = Tumbling::right;
  const double energy = trial.frames[0].energy.kinetic;
  for (const Frame& frame : trial.frames) {
    if (!(std::abs(frame.energy.kinetic - energy) <= kEnergyError * energy)) return Tumbling::energyWrong;
    const RotationState right = truth.at(frame.time);
    const double wanted = spinOf(right.worldFromBody, right.angularVelocity, speed).y();
    const double found = spinOf(frame.states[0].orientation, frame.states[0].angularVelocity, speed).y();
    if (std::abs(wanted) > kClear && wanted * found < 0) tumbling = Tumbling::flipsWrong;
  }
  return tumbling;
}

}  // namespace cradle
