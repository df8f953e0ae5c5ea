#include "simulate/simulation.h"

#include <algorithm>
#include <utility>

#include "core/interruption.h"

namespace cradle {
namespace {

constexpr double kSameTime = 1e-12;  // s, relative beyond 1 s

}  // namespace

Simulation::Simulation(const Scene& scene, Assembly assembly, const ChosenMethod& method)
    : island_(scene, std::move(assembly)),
      ropes_(island_),
      solver_(island_.assembly.mechanism.constraints, island_.assembly.mechanism.bodies) {
  if (method.isAdaptive())
    motion_.emplace<EventMotion>(island_, ropes_, method);
  else
    motion_.emplace<SteppedMotion>(island_, ropes_, method);
}

const VectorX& Simulation::stateAt(double time) {
  if (auto* events = std::get_if<EventMotion>(&motion_))
    moveTo(time, *events);
  else
    moveTo(time, std::get<SteppedMotion>(motion_));
  normalizeOrientations(reported_);
  const std::vector<RigidBody>& bodies = island_.assembly.mechanism.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!bodies[i].turns) spin(static_cast<Eigen::Index>(i), time, reported_);
  return reported_;
}

template <class Motion>
void Simulation::moveTo(double time, Motion& motion) {
  const double same = kSameTime * std::max(1.0, time);
  while (island_.time < time - same) {
    throwIfInterrupted();
    if (motion.isAtRest())
      motion.restUntil(time);
    else
      motion.advance(time);
  }
  if (island_.time <= time + same)
    reported_ = island_.state;
  else
    interpolateAt(time, motion.keepsTies());
}

void Simulation::interpolateAt(double time, bool keepsTies) {
  interpolate(island_.step, (time - island_.step.time) / island_.step.timeStep, reported_);
  if (keepsTies && solver_.hasConstraints()) solver_.project(reported_);
}

/// Sets the orientation of a body whose spin is constant: the state keeps that of the start.
void Simulation::spin(Eigen::Index body, double time, VectorX& state) const {
  turnBody(state, body, time * Vec3(angularVelocity(state, body)));
}

}  // namespace cradle
