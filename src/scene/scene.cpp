#include "scene/scene.h"

#include <algorithm>
#include <cmath>

namespace cradle {

bool looksAlongUp(const Camera& camera) {
  // Sine of the angle between them. Closer, the picture turns by degrees with the last digits of a position of 1e3 m.
  constexpr double kMinAngle = 1e-6;
  const Vec3 towards = camera.target - camera.position;
  return towards.cross(camera.up).norm() <= kMinAngle * towards.norm();
}

Vec3 upOf(const Scene& scene) {
  const Vec3& gravity = scene.gravity;
  for (const int axis : {0, 1, 2}) {
    const Vec3 up = Vec3::Unit(axis) * (gravity[axis] < 0 ? 1 : -1);
    if (gravity[axis] != 0 && (gravity.array() != 0).count() == 1) return up;
  }
  return Vec3::UnitY();
}

long lastFrame(const Scene& scene) {
  const Output& output = scene.output;
  // A duration that is a whole number of frames must not lose its last one to rounding.
  constexpr double kRounding = 1e-9;
  return static_cast<long>(std::floor(scene.duration * output.framesPerSecond / output.playbackSpeed + kRounding));
}

// N whole frames may be longer than the duration by rounding, and nothing is simulated beyond it.
double frameTime(const Scene& scene, long frame) {
  const double time = static_cast<double>(frame) * scene.output.playbackSpeed / scene.output.framesPerSecond;
  return std::min(time, scene.duration);
}

double frameInterval(const Scene& scene) {
  return scene.output.playbackSpeed / scene.output.framesPerSecond;
}

}  // namespace cradle
