#pragma once

#include "constraints/equations_of_motion.h"
#include "dynamics/integrators/step.h"
#include "simulate/assembly.h"

namespace cradle {

/// A scene's motion in steps of one length by an integrator and nothing else: no events, no watch on the energy, and
/// constraints are projected only if wanted. For what goes wrong without.
class IslandSteps {
 public:
  /// `timeStep` in s. Throws what assembling throws.
  IslandSteps(const Scene& scene, Integrator integrate, double timeStep, bool projects);
  IslandSteps(const IslandSteps&) = delete;
  IslandSteps& operator=(const IslandSteps&) = delete;

  void advance();

  double time() const { return static_cast<double>(steps_) * timeStep_; }  // s
  const VectorX& state() const { return state_; }
  const Assembly& assembly() const { return assembly_; }

 private:
  Assembly assembly_;
  EquationsOfMotion equations_;
  RightHandSide rightHandSide_;
  Integrator integrate_;
  double timeStep_;  // s
  bool projects_;
  VectorX state_;
  Step step_;
  long steps_ = 0;
};

}  // namespace cradle
