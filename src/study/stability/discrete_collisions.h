#pragma once

#include <vector>

#include "collision/broad_phase.h"
#include "impact/pairwise.h"
#include "simulate/assembly.h"

namespace cradle {

/// Collisions as textbooks begin with them: steps of one length, at whose ends bodies that overlap and close rebound
/// pair by pair, wherever they are by then. What lies between two ends is not seen. It does not stand among the ways in
/// which scenes are simulated: charts show it failing.
class DiscreteCollisions {
 public:
  /// All bodies of the scene, which nothing ties. `timeStep` in s.
  DiscreteCollisions(const Scene& scene, Integrator integrate, double timeStep);
  DiscreteCollisions(const DiscreteCollisions&) = delete;
  DiscreteCollisions& operator=(const DiscreteCollisions&) = delete;

  void step();

  const Assembly& assembly() const { return assembly_; }
  const VectorX& state() const { return state_; }
  double time() const { return static_cast<double>(steps_) * timeStep_; }  // s
  long bounces() const { return bounces_; }                                // steps that ended with an impact
  bool hasTouched(int body) const { return hasTouched_[static_cast<std::size_t>(body)] != 0; }  // at a step's end

 private:
  void rebound();

  Assembly assembly_;
  EquationsOfMotion equations_;
  RightHandSide rightHandSide_;
  Integrator integrate_;
  double timeStep_;  // s
  BroadPhase broadPhase_;
  std::vector<double> motions_;  // m, that the list of near pairs is for: none, it is made anew
  std::vector<Contact> contacts_;
  std::vector<ImpactContact> impacts_;
  std::vector<char> hasTouched_;
  VectorX state_;
  Step step_;
  long steps_ = 0, bounces_ = 0;
};

}  // namespace cradle
