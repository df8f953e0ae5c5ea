#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/random_scene_figures.h"
#include "experiments/scene_sketch.h"

namespace cradle {

/// Throws what parseScene and simulate throw.
SceneRun runSketch(const SceneSketch& sketch);

/// Something that a scene should not do.
struct SketchFault {
  std::string oracle;  // one word: "penetration"
  std::string text;    // by how much, and in which run
};

/// What one run shows by itself: states that are not finite, energy gained or lost without a cause, dissipated energy
/// that comes back, momentum that changes where nothing can change it, penetration, ties that do not hold, broken
/// symmetry, a way that the closed form does not know, CPU time.
std::vector<SketchFault> faultsOfRun(const SceneSketch& sketch, const SceneRun& run);

/// All oracles: the run itself, its twins, and where accuracies are promised, runs at 1e-4 and 1e-6 against 1e-9. Each
/// oracle speaks once. `begin` hears of each run before it starts, so that one that does not end can be named.
std::vector<SketchFault> checkSketch(const SceneSketch& sketch, const std::function<void(const std::string&)>& begin);

/// The scene with as few bodies and links as still show a fault of that oracle. Takes many runs.
SceneSketch reduceSketch(const SceneSketch& sketch, const std::string& oracle);

}  // namespace cradle
