#include "study/stability/discrete_collisions.h"

#include <algorithm>

namespace cradle {

DiscreteCollisions::DiscreteCollisions(const Scene& scene, Integrator integrate, double timeStep)
    : assembly_(assemble(scene, wholeScene(scene))),
      equations_(assembly_.mechanism),
      rightHandSide_(equations_.rightHandSide()),
      integrate_(integrate),
      timeStep_(timeStep),
      motions_(assembly_.mechanism.bodies.size(), 0.0),
      hasTouched_(assembly_.mechanism.bodies.size(), 0),
      state_(assembly_.state) {}

void DiscreteCollisions::step() {
  integrate_(rightHandSide_, state_, time(), timeStep_, step_);
  state_ = step_.state;
  ++steps_;
  rebound();
}

void DiscreteCollisions::rebound() {
  broadPhase_.update(state_, motions_, 0, assembly_.geometry);
  contacts_.clear();
  findContacts(assembly_.geometry, state_, 0, contacts_);
  if (contacts_.empty()) return;
  impacts_.clear();
  for (const Contact& contact : contacts_) {
    impacts_.push_back({contact, assembly_.geometry.pairs[contact.pair].material, 0, Vec3::Zero()});
    for (const int body : {contact.bodyA, contact.bodyB})
      if (body != kFixed) hasTouched_[static_cast<std::size_t>(body)] = 1;
  }
  resolvePairwise(impacts_, ImpulseResponse(assembly_.mechanism.bodies), state_);
  const bool rebounds = std::any_of(impacts_.begin(), impacts_.end(),
                                    [](const ImpactContact& impact) { return !impact.impulse.isZero(); });
  if (rebounds) ++bounces_;
}

}  // namespace cradle
