#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// What a run of a scene did that it should not.
struct RandomSceneFigures {
  double energyScale = 0;      // J: kinetic energy and work of forces that there were at most
  double energyGain = 0;       // J: how far the mechanical energy rose above its least value so far
  double energyError = 0;      // J: largest change of mechanical energy + dissipated
  double penetration = 0;      // m
  double constraintError = 0;  // m or rad: of rods, joints, and ropes beyond their length
  double cpuSeconds = 0;       // of the integration
  bool isFinite = true;        // every number of every frame
  bool keepsAccuracy = true;   // as of SceneRun
};

/// What a run of a scene left, and what it said of itself.
struct SceneRun {
  Scene scene;
  std::vector<Frame> frames;
  bool keepsAccuracy = true;  // neither the plan nor a warning said that it is not promised or kept
  double cpuSeconds = 0;      // of the integration
};

/// Throws what simulate throws.
SceneRun runOf(const Scene& scene);

/// Whether every number of a frame is.
bool isFinite(const Frame& frame);

/// By how much (m) a rope of a frame is longer than it may be, at most; 0 if none is.
double ropeExcess(const Frame& frame, const Scene& scene);

/// Runs a scene without pushes. Throws what simulate throws.
RandomSceneFigures runRandomScene(const Scene& scene);

/// What is beyond bounds, in words; empty if all is well.
std::vector<std::string> faultsOf(const RandomSceneFigures& figures, double accuracy);

}  // namespace cradle
