#include "simulate/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/interruption.h"
#include "simulate/thresholds.h"

namespace cradle {

Simulation::Simulation(const Scene& scene, Assembly assembly, const ChosenMethod& method)
    : island_(scene, std::move(assembly)),
      ropes_(island_),
      solver_(island_.assembly.mechanism.constraints, island_.assembly.mechanism.bodies),
      method_(method) {
  if (method.isAdaptive())
    motion_.emplace<EventMotion>(island_, ropes_, method);
  else
    motion_.emplace<SteppedMotion>(island_, ropes_, method);
  changeMotion();
}

const VectorX& Simulation::stateAt(double time) {
  const double same = sameTime(time);
  while (island_.time < time - same) {
    throwIfInterrupted();
    advance(time);
  }
  if (island_.time <= time + same)
    reported_ = island_.state;
  else
    interpolateAt(time, keepsTies());
  normalizeOrientations(reported_);
  const std::vector<RigidBody>& bodies = island_.assembly.mechanism.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!bodies[i].turns) spin(static_cast<Eigen::Index>(i), time, reported_);
  return reported_;
}

template <class Motion>
void Simulation::advance(double time, Motion& motion) {
  if (motion.isAtRest())
    motion.restUntil(time);
  else
    motion.advance(time);
}

void Simulation::advance(double time) {
  if (auto* events = std::get_if<EventMotion>(&motion_))
    advance(time, *events);
  else
    advance(time, std::get<SteppedMotion>(motion_));
  // The step under way ends later than `time`: its interpolant is needed as it is.
  if (method_.isAdaptive()) changeMotion();
}

bool Simulation::keepsTies() const {
  if (const auto* events = std::get_if<EventMotion>(&motion_)) return events->keepsTies();
  return std::get<SteppedMotion>(motion_).keepsTies();
}

/// Steps of one length take over where events do not serve, and give back where nothing touches, or after a while; not
/// where a look is enough: trials cost more than they may save.
void Simulation::changeMotion() {
  if (const auto* events = std::get_if<EventMotion>(&motion_)) {
    const std::string_view fault = events->fault();
    if (fault.empty()) return;
    if (!promiseEnd_) endPromise(*events);
    island_.assembly.mechanism.contacts.clear();
    nextTrial_ = island_.time + trialTime_;
    trialTime_ *= 2;
    if (isLook()) method_ = contactSteps();
    motion_.emplace<SteppedMotion>(island_, ropes_, contactSteps());
    return;
  }
  const auto& steps = std::get<SteppedMotion>(motion_);
  if (!method_.isAdaptive() || steps.isAtRest()) return;
  if (!steps.isFree() && island_.time < nextTrial_) return;
  nextTrial_ = island_.time + trialTime_;
  if (steps.isFree()) trialTime_ = kTrialTime;
  if (steps.isFree() || steps.mayServeEvents()) motion_.emplace<EventMotion>(island_, ropes_, method_);
}

void Simulation::endPromise(const EventMotion& events) {
  promiseEnd_ = {island_.time, std::string(events.fault()), events.faultBodies()};
  island_.log.warn(fmt::format(
      "{}: the accuracy asked is not promised from {:.6g} s on: {} ({}); contact is resolved every {:.3g} s {}",
      island_.scene.path, island_.time, promiseEnd_->reason, namesOfBodies(promiseEnd_->bodies, island_.scene),
      kContactTimeStep, isLook() ? "to the end" : "as long as that lasts"));
}

void Simulation::interpolateAt(double time, bool keepsTies) {
  const double fraction = (time - island_.step.time) / island_.step.timeStep;
  interpolate(island_.step, fraction, reported_);
  if (const auto* steps = std::get_if<SteppedMotion>(&motion_)) steps->hold(fraction, reported_);
  if (!keepsTies || !solver_.hasConstraints()) return;
  findStill();
  solver_.leaveOut(still_);
  solver_.project(reported_);
}

/// What has not moved within the step is where its ties hold it.
void Simulation::findStill() {
  const Step& step = island_.step;
  still_.resize(island_.assembly.mechanism.bodies.size());
  for (std::size_t i = 0; i < still_.size(); ++i) {
    const Eigen::Index at = static_cast<Eigen::Index>(i) * kPoseSize;
    still_[i] = step.startState.segment<kPoseSize>(at) == step.state.segment<kPoseSize>(at);
  }
}

/// Sets the orientation of a body whose spin is constant: the state keeps that of the start.
void Simulation::spin(Eigen::Index body, double time, VectorX& state) const {
  turnBody(state, body, time * Vec3(angularVelocity(state, body)));
}

}  // namespace cradle
