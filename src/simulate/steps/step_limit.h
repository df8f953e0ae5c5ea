#pragma once

#include <optional>
#include <string>
#include <vector>

#include "constraints/spring_modes.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// The motion of a mass on a spring with a method of fixed steps, found by taking such steps.
struct ModeTrial {
  double growth = 0;       // of the amplitude in a step: > 1 is unstable
  double energyError = 0;  // largest relative change of energy + dissipated during the run, if stable
};
ModeTrial tryMode(const SpringMode& mode, const ChosenMethod& method, double duration);

/// The longest step (s) with which a method is stable on a mode, to 1e-4; 0 if it gains energy at any step.
double longestStableStep(const SpringMode& mode, Integrator integrate);

/// A spring that is too stiff, or too strongly damped, for a method's fixed step.
struct StepFault {
  std::size_t spring = 0;
  std::string text;  // the frequency, the limit or the loss, and a safe step; behind the spring's name
};

/// None if the method's steps are chosen by the error, or short enough that no spring gains energy during the run.
std::optional<StepFault> stepFault(const Mechanism& mechanism, const VectorX& state, const ChosenMethod& method,
                                   double duration);

/// The spring whose oscillation loses or gains most energy by the steps alone, if that is 1 % in a period and in the
/// run. A stable step may be wrong all the same: RK4 at step x omega = 2 takes 84 % of the energy in a period.
std::optional<StepFault> energyChangeByStep(const Mechanism& mechanism, const VectorX& state,
                                            const ChosenMethod& method, double duration);

/// The largest energyError of the modes of the springs, 0 without springs: the error that a stable method may have.
double springEnergyError(const Mechanism& mechanism, const VectorX& state, const ChosenMethod& method, double duration);

}  // namespace cradle
