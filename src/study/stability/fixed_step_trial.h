#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "study/stability/maps.h"
#include "study/stability/stability_region.h"
#include "trajectory/trajectory.h"

namespace cradle {

constexpr long kTrialSteps = 300;         // at least: a growth of 1 % a step is then one of 20
constexpr double kFirstTrialStep = 0.07;  // x omega: where the search for a limit begins

/// A scene of a JSON text without meshes.
Scene sceneOfText(const std::string& text);

/// What a scene did in steps of one length, as `cradle simulate` has it.
struct FixedStepTrial {
  bool isUnstable = false;  // it was stopped: not finite, or energy from nowhere
  std::vector<Frame> frames;
};

/// How a trial goes: `frames` frames beside that of the start, each `stepsAFrame` steps after the one before.
struct TrialLength {
  double timeStep = 0;  // s
  long stepsAFrame = 1, frames = 1;
};
FixedStepTrial tryFixedSteps(Scene& scene, const FixedStepMethod& method, const TrialLength& length);

/// The longest step (s) that is stable, to 1e-3 of it, found by trials alone: doubled from `first` on, then bisected. 0
/// if already that is not.
double measuredLimit(const std::function<bool(double timeStep)>& isStable, double first);

/// Whether the scene goes through `steps` steps of that length (s) without being stopped.
bool isStableFor(Scene& scene, const FixedStepMethod& method, double timeStep, long steps);

/// The cells of a panel, each by a trial of its own. `done` is told of each row, 0..1.
std::vector<double> cellsOf(const StabilityMap& map, const std::function<double(double x, double y)>& trial,
                            const MapProgress& done);

/// Adds a panel for each of fixedStepMethods().
void addPanels(StabilityMap& map, const std::function<MapPanel(const FixedStepMethod&, const MapProgress&)>& make,
               const MapProgress& progress);

/// `count` values from end to end of an axis, for boundaries that need others than the cells have.
std::vector<double> someOf(const Axis& axis, int count);

}  // namespace cradle
