#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dynamics/spring_modes.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// What a method with a fixed step makes of a mass on a spring, found by letting it take steps there.
struct ModeTrial {
  double growth = 0;       // of the amplitude in a step: > 1 is unstable
  double energyError = 0;  // largest change of energy + dissipated during the run, in parts of the energy, if stable
};
ModeTrial tryMode(const SpringMode& mode, const ChosenMethod& method, double duration);

/// The longest step (s) with which a method is stable on a mode, to 1e-4; 0 if it gains energy at any step.
double longestStableStep(const SpringMode& mode, Integrator integrate);

/// A spring that is too stiff, or too strongly damped, for a method's fixed step.
struct StepFault {
  std::size_t spring = 0;
  std::string text;  // what is too fast, the limit or the loss, and the step that is safe
};

/// None if the method's steps are chosen by the error, or short enough that no spring gains energy during the run.
std::optional<StepFault> stepFault(const Mechanism& mechanism, const VectorX& state, const ChosenMethod& method,
                                   double duration);

/// A stable step may be wrong all the same: RK4 at step x omega = 2 takes 84 % of a swing's energy in a period. The
/// spring whose swing loses or gains most by the steps alone, if that is 1 % of the energy in a period and in the run.
std::optional<StepFault> energyChangeByStep(const Mechanism& mechanism, const VectorX& state,
                                            const ChosenMethod& method, double duration);

/// The largest energyError of the modes of the springs: what may be expected of a method that is stable; 0 without.
double springEnergyError(const Mechanism& mechanism, const VectorX& state, const ChosenMethod& method, double duration);

}  // namespace cradle
