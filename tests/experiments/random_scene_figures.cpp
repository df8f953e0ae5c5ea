#include "experiments/random_scene_figures.h"

#include <algorithm>
#include <cmath>

#include "experiments/tie_error.h"
#include "simulate/plan/plan_text.h"
#include "simulate/simulate.h"
#include "study/drift_meter.h"

namespace cradle {
namespace {

// Times the accuracy. A step's error is a tenth of it: a hundred of them a run, of random signs, make up one of speeds,
// and energy has their square. Frames between steps, which end where ties and contacts hold, have less than one.
constexpr double kMaxEnergyErrors = 2, kMaxPlaceErrors = 1;
// Steps of one length promise no accuracy, but that pictures are right. What they gain is RK4's with springs and ropes;
// what errors lose is of order 1 in steps in which something strikes: g times the change of speed times a step; ropes
// are drawn too long by what contact does to speeds of 20 m/s within a step of 1/960 s; penetration is as in piles.
constexpr double kSteppedGain = 3e-4, kSteppedError = 5e-3;                  // of the energy
constexpr double kSteppedTieError = 20. / 960, kSteppedPenetration = 0.005;  // m

}  // namespace

bool isFinite(const Frame& frame) {
  const auto finite = [](const BodyState& state) {
    return state.position.allFinite() && state.orientation.coeffs().allFinite() && state.linearVelocity.allFinite() &&
           state.angularVelocity.allFinite();
  };
  return std::all_of(frame.states.begin(), frame.states.end(), finite) && std::isfinite(energyConstantOf(frame));
}

double ropeExcess(const Frame& frame, const Scene& scene) {
  const std::vector<RigidTransform> places = placesIn(frame, scene);
  double excess = 0;
  for (const Rope& rope : scene.ropes)
    excess = std::max(excess, distanceOfEnds(rope.anchorA, rope.anchorB, places) - rope.maxLength);
  return excess;
}

SceneRun runOf(const Scene& scene) {
  SceneRun run{scene, {}};
  const auto listen = [&](const std::string& text) {
    for (const char* end : {"not promised", "not kept"})
      if (text.find(end) != std::string::npos) run.keepsAccuracy = false;
  };
  listen(accuracyPromised(planOf(scene)));
  const SimulationSink sink{[&](const Frame& frame) { run.frames.push_back(frame); }, [](const Event&) {}, listen};
  run.cpuSeconds = simulate(scene, sink).cpuSeconds;
  return run;
}

RandomSceneFigures runRandomScene(const Scene& scene) {
  const auto [ran, frames, keepsAccuracy, cpuSeconds] = runOf(scene);
  RandomSceneFigures figures;
  figures.keepsAccuracy = keepsAccuracy, figures.cpuSeconds = cpuSeconds;

  const Assembly assembly = assemble(scene, wholeScene(scene));
  DriftMeter meter(assembly);
  double least = mechanicalEnergy(frames[0]);
  for (const Frame& frame : frames) {
    const double energy = mechanicalEnergy(frame);
    figures.isFinite = figures.isFinite && isFinite(frame);
    figures.energyScale = std::max(
        {figures.energyScale, frame.energy.kinetic, std::abs(frame.energy.potential - frames[0].energy.potential)});
    figures.energyGain = std::max(figures.energyGain, energy - least);
    figures.energyError =
        std::max(figures.energyError, std::abs(energyConstantOf(frame) - energyConstantOf(frames[0])));
    figures.constraintError =
        std::max({figures.constraintError, constraintError(frame, scene), ropeExcess(frame, scene)});
    least = std::min(least, energy);
    meter.add(frame);
  }
  figures.penetration = meter.penetration();
  return figures;
}

std::vector<std::string> faultsOf(const RandomSceneFigures& figures, double accuracy) {
  const bool keeps = figures.keepsAccuracy;
  const double mostEnergy = kMaxEnergyErrors * accuracy, mostPlace = kMaxPlaceErrors * accuracy;
  const double gain = figures.energyGain / figures.energyScale, error = figures.energyError / figures.energyScale;
  std::vector<std::string> faults;
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) faults.push_back(what);
  };
  require(figures.isFinite, "not finite");
  require(gain <= (keeps ? mostEnergy : kSteppedGain), fmt::format("gains {:.2g} of its energy", gain));
  require(error <= (keeps ? mostEnergy : kSteppedError), fmt::format("balance of energy off by {:.2g} of it", error));
  require(figures.penetration <= (keeps ? mostPlace : kSteppedPenetration),
          fmt::format("penetration {:.2g} m", figures.penetration));
  require(figures.constraintError <= (keeps ? mostPlace : kSteppedTieError),
          fmt::format("ties off by {:.2g} m or rad", figures.constraintError));
  return faults;
}

}  // namespace cradle
