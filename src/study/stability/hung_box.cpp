#include "study/stability/hung_box.h"

#include <algorithm>
#include <cmath>

#include "dynamics/spring.h"
#include "simulate/assembly.h"

namespace cradle {
Scene hungBox(double stiffness, double dampingRatio) {
  static const Scene prototype = sceneOfText(
      R"({"schema": "cradle-scene/1", "name": "hung box", "duration": 1, "gravity": [0, 0, -9.81],
      "bodies": [{"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "collision": "none", "mass": 2,
      "position": [-0.2, -0.1, -0.8]}],
      "springs": [{"bodyA": "box", "anchorA": [0.2, 0.1, 0.3], "anchorB": [0, 0, 0], "stiffness": 1,
      "restLength": 0.5}]})");
  Scene scene = prototype;
  scene.springs[0].stiffness = stiffness;
  scene.springs[0].damping = 2 * dampingRatio * stiffness / boxOmega(scene);
  return scene;
}

double boxOmega(const Scene& scene) {
  const Assembly assembly = assemble(scene, wholeScene(scene));
  return naturalFrequency(assembly.mechanism.springs[0], assembly.mechanism.bodies, assembly.state);
}

bool isBoxStable(Scene& scene, const FixedStepMethod& method, double timeStep) {
  return isStableFor(scene, method, timeStep, std::max(kTrialSteps, static_cast<long>(kBoxDuration / timeStep)));
}

double measuredBoxLimit(Scene& scene, const FixedStepMethod& method) {
  return measuredLimit([&](double timeStep) { return isBoxStable(scene, method, timeStep); },
                       kFirstTrialStep / boxOmega(scene));
}

}  // namespace cradle
