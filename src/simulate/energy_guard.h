#pragma once

#include <string>
#include <utility>
#include <vector>

#include "dynamics/equations_of_motion.h"

namespace cradle {

/// What the guard has to know to say what went wrong in the user's words.
struct GuardNames {
  std::vector<std::string> bodies, springs;  // in the order of the mechanism
  std::string method;                        // "semi-implicit Euler"
  double stabilityLimit = 0;                 // of step x omega; 0: unstable at any step
};

/// Watches kinetic + potential + dissipated - work, which no method may change by more than its own error. A change
/// that exceeds ten times all energy that there was to begin with, or that gravity can have given on the way travelled,
/// is a blow-up.
class EnergyGuard {
 public:
  EnergyGuard(const Mechanism& mechanism, const VectorX& start, GuardNames names);

  /// Throws Error(unstable), naming time, body, spring and a step that would be safe, if the state is not finite or its
  /// energy is unexplained.
  void check(const VectorX& state, double time, double timeStep);

  /// Throws Error(unstable): steps have become too short to go on from `time`.
  [[noreturn]] void failAtShortestStep(const VectorX& state, double time) const;

  /// Throws Error(unstable): steps have stayed so short that the run would not end in any useful time.
  [[noreturn]] void failAtShortSteps(const VectorX& state, double time, double timeStep) const;

  /// Throws Error(unstable): what ties the bodies cannot all be kept at `time`, the worst is off by `error` (m or rad).
  [[noreturn]] void failAtTies(const VectorX& state, double time, double error) const;

 private:
  double firstStepEnergy(double timeStep) const;
  [[noreturn]] void fail(const VectorX& state, double time, const std::string& what, const std::string& cause) const;
  std::string cause(double timeStep) const;
  std::string stiffCause() const;
  std::pair<std::size_t, double> fastestSpring() const;

  const Mechanism& mechanism_;
  VectorX start_;
  GuardNames names_;
  double startConstant_, startEnergy_;  // J
  std::vector<double> excursions_;      // m: farthest that each body has been from its start
};

}  // namespace cradle
