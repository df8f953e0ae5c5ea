// Builds a scene as text, simulates it, and prints how high the bob comes and where the energy goes.
#include <cradle/simulate.h>

#include <algorithm>
#include <cstdio>

int main() {
  namespace cr = cradle::v1;
  try {
    const cr::Scene scene = cr::Scene::parse(R"({
      "schema": "cradle-scene/1", "name": "Pendulum", "duration": 10, "accuracy": 1e-9,
      "bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.1}}, "mass": 2, "position": [1, 0, 0]}],
      "rods": [{"bodyA": "bob", "anchorB": [0, 0, 0]}]})");
    double highest = -1;  // m
    const cr::Trajectory motion =
        cr::simulate(scene, {.frame = [&](const cr::Frame& frame) {
                       highest = std::max(highest, frame.time > 1 ? frame.states[0].position[1] : -1);
                     }});
    const cr::EnergyBalance energy = motion.frame(motion.frameCount() - 1).energy;
    std::printf("%s: %ld frames, comes up to %.4f m, energy %.2e J\n", motion.bodies()[0].c_str(), motion.frameCount(),
                highest, energy.kinetic + energy.potential);
    return 0;
  } catch (const cr::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.kind());
  }
}
