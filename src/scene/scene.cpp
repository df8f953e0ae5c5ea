#include "scene/scene.h"

#include <cmath>

namespace cradle {

long lastFrame(const Scene& scene) {
  const Output& output = scene.output;
  // A duration that is a whole number of frames must not lose its last one to rounding.
  constexpr double kRounding = 1e-9;
  return static_cast<long>(std::floor(scene.duration * output.framesPerSecond / output.playbackSpeed + kRounding));
}

double frameTime(const Scene& scene, long frame) {
  return static_cast<double>(frame) * scene.output.playbackSpeed / scene.output.framesPerSecond;
}

}  // namespace cradle
