#pragma once

#include <string>
#include <utility>
#include <vector>

#include "simulate/assembly.h"

namespace cradle {

/// Watches the numerical energy, by what kinetic + potential + dissipated - work changes, which no method may change by
/// more than its own error. That error is, with steps chosen by the error, what the accepted local errors can add up
/// to; with a fixed step, what the method does to a mass on the fastest spring, in parts of all energy that there was
/// to begin with, that pushes gave, or that gravity can have given on the way travelled.
class EnergyGuard {
 public:
  /// Keeps a reference to `assembly`. `start` is the state to begin with; `duration` (s) is the run's.
  EnergyGuard(const Assembly& assembly, const VectorX& start, const ChosenMethod& method, double duration);

  /// To be called after each step. Throws Error(unstable), naming time, body, what is too fast, and a step that would
  /// be safe, if the state is not finite or its energy is unexplained.
  void check(const VectorX& state, double time, double timeStep);

  /// Throws Error(unstable): steps have become too short to go on from `time`.
  [[noreturn]] void failAtShortestStep(const VectorX& state, double time) const;

  /// Throws Error(unstable): steps have stayed so short that the run would not end in any useful time.
  [[noreturn]] void failAtShortSteps(const VectorX& state, double time, double timeStep) const;

  /// Throws Error(unstable): the bodies' constraints cannot all be kept at `time`, the worst is off by `error` (m or
  /// rad).
  [[noreturn]] void failAtConstraints(const VectorX& state, double time, double error) const;

 private:
  double explainedEnergy(const VectorX& state, double timeStep);
  double firstStepEnergy(double timeStep) const;
  [[noreturn]] void fail(const VectorX& state, double time, const std::string& what, const std::string& cause) const;
  const PushForce* overwhelmingPush() const;
  std::string cause(const VectorX& state) const;
  std::string stiffCause(const VectorX& state) const;
  std::string adaptiveCause(const VectorX& state) const;
  std::string fastestBody(const VectorX& state) const;
  std::string fastestRotation(const VectorX& state) const;

  const Mechanism& mechanism_;
  const PartNames& names_;
  const std::vector<double>& radii_;  // m
  VectorX start_, calm_;              // calm: the last state whose energy was nearly all explained
  ChosenMethod method_;
  double duration_;
  double startConstant_, startEnergy_;  // J
  double mostError_ = 0;                // of the energy explained: beyond it, a fixed step has failed
  double errorSum_ = 0;                 // J: what the local errors accepted so far can have changed
  std::vector<double> excursions_;      // m: farthest that each body has been from its start
};

/// What errors of `tolerance` (of 1 m and more), rounding of places, or gaps that count as touching make of the energy
/// (J) that is summed from them: all that bodies of these radii (m) have which do not move, and more than nothing where
/// a spring is stiff.
double energyOfPlaceErrors(const Mechanism& mechanism, const std::vector<double>& radii, const VectorX& state,
                           double tolerance);

}  // namespace cradle
