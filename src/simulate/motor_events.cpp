#include "simulate/motor_events.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "constraints/invariants.h"
#include "math/parabola.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr int kTrials = 3;   // at the least of what is left
constexpr int kSamples = 4;  // a step, as of the tensions of ropes
// Of all the force: where a fourth difference of samples is beyond it, neither they nor the interpolant tell what is
// between them. That of a cosine is there where they are 1/48 of a period apart.
constexpr double kRough = 3e-4;
constexpr double kRoughRatio = 0.02;  // of the least of what is left: there, larger differences are no matter
// Of the largest velocity in a step: so far past its target a motor has come to it. One that leaves it again at once is
// at it to within rounding, on either side.
constexpr double kPastTarget = 1e-9;
constexpr double kTogether =
    10;  // times what is left of the first: others that miss no more come to their targets with it
constexpr double kAtItsEnd = 1e-6;  // of all the force: what is as near to it is at its end

}  // namespace

bool MotorEvents::any() const {
  const std::vector<JointMotor>& motors = island_.assembly.mechanism.motors;
  return std::any_of(motors.begin(), motors.end(), [](const JointMotor& motor) { return motor.hasTarget; });
}

bool MotorEvents::anyHolds() const {
  const std::vector<JointMotor>& motors = island_.assembly.mechanism.motors;
  return std::any_of(motors.begin(), motors.end(),
                     [](const JointMotor& motor) { return motor.hasTarget && motor.mode == JointMotor::Mode::holds; });
}

bool MotorEvents::rests(std::size_t motor) const {
  const Constraint& joint = island_.assembly.mechanism.motors[motor].joint;
  return island_.resting.isResting(joint.anchorA.body) || island_.resting.isResting(joint.anchorB.body);
}

double MotorEvents::velocity(std::size_t motor, const VectorX& state) {
  findBodyFrames(island_.assembly.mechanism.bodies, state, frames_);
  return rateOf(rowOf(motors()[motor], state, frames_), 0, state);
}

double MotorEvents::marginAt(std::size_t index, double time, const VectorX& state) {
  const JointMotor& motor = motors()[index];
  if (motor.mode == JointMotor::Mode::pushes)
    return kPastTarget + motor.sign * (motor.targetVelocity - velocity(index, state)) / scales_[index];
  island_.equations.evaluate(time, state, derivative_);
  const auto at = static_cast<Eigen::Index>(index);
  forceLeft_ = 1 - std::abs(island_.equations.motorForces()[at]) / motor.maxForce;
  return std::min(forceLeft_, 1 - island_.equations.motorContradictions()[at]);
}

double MotorEvents::smoothPart() const {
  return roughness_ > 0 ? std::sqrt(std::sqrt(1 / roughness_)) : INFINITY;
}

double MotorEvents::margin(const MotorChange& change, const VectorX& state) {
  return marginAt(change.motor, island_.step.time + island_.step.timeStep, state);
}

std::optional<MotorChange> MotorEvents::firstChange(const Step& step) {
  std::optional<MotorChange> first;
  std::vector<double> fractions;
  roughness_ = 0;
  for (std::size_t i = 0; i < motors().size(); ++i) {
    const JointMotor& motor = motors()[i];
    if (!motor.hasTarget || motor.maxForce == 0 || rests(i)) continue;
    scales_[i] = std::max({std::abs(motor.targetVelocity - velocity(i, step.startState)),
                           std::abs(motor.targetVelocity - velocity(i, step.state)), std::abs(motor.targetVelocity)});
    if (scales_[i] == 0) scales_[i] = 1;
    const auto margin = [&](double fraction) {
      interpolate(step, fraction, sample_);
      return marginAt(i, step.time + fraction * step.timeStep, sample_);
    };
    std::array<double, kSamples + 1> samples, forces;
    for (std::size_t k = 0; k <= kSamples; ++k) {
      samples[k] = k > 0 ? margin(static_cast<double>(k) / kSamples) : marginAt(i, step.time, step.startState);
      forces[k] = forceLeft_;
    }
    const auto& [a, b, c, d, e] = forces;
    if (motor.mode == JointMotor::Mode::holds) {
      const double known = std::max(kRough, kRoughRatio * *std::min_element(forces.begin(), forces.end()));
      roughness_ = std::max(roughness_, std::abs(a - 4 * b + 6 * c - 4 * d + e) / known);
    }
    const std::optional<double> found = firstFall(margin, samples, kTrials);
    if (!found) continue;
    fractions.push_back(*found);
    if (!first || *found < first->fraction) first = MotorChange{*found, i};
  }
  for (const double fraction : fractions)
    if (fraction > first->fraction + kAtOnce) first->latest = std::min(first->latest, fraction);
  return first;
}

/// Motors of wheels on one road come to their targets together: all that miss theirs by no more than the search for the
/// instant of one has left it to miss.
std::vector<char> MotorEvents::reachedWith(std::size_t first) {
  const auto missing = [this](std::size_t i) {
    return std::abs(motors()[i].targetVelocity - velocity(i, island_.state));
  };
  std::vector<char> reached(motors().size(), 0);
  for (std::size_t i = 0; i < motors().size(); ++i) {
    const double left = std::max(missing(first) / scales_[first], kPastTarget) * scales_[i];
    reached[i] = i == first || (motors()[i].hasTarget && !rests(i) && missing(i) <= kTogether * left);
  }
  return reached;
}

bool MotorEvents::resolve(const std::optional<MotorChange>& change) {
  if (!any()) return false;
  // Its velocity is at the target, to within what the search for the instant leaves.
  const bool isReached = change && motors()[change->motor].mode == JointMotor::Mode::pushes;
  std::vector<char> reached;
  if (isReached) reached = reachedWith(change->motor);
  const VectorX forces = island_.equations.possibleMotorForces(island_.time, island_.state, reached);
  const VectorX& mobilities = island_.equations.motorMobilities();
  bool isOther = false;
  for (std::size_t i = 0; i < motors().size(); ++i) {
    JointMotor& motor = motors()[i];
    if (!motor.hasTarget || rests(i)) continue;
    const Eigen::Index at = static_cast<Eigen::Index>(i);
    const double missing = std::abs(motor.targetVelocity - velocity(i, island_.state));
    const bool isOff = (reached.empty() || !reached[i]) && missing > settledSpeed(motor, mobilities[at]);
    // At the end of its force a motor holds no more, and one that has pushed goes on, to within rounding.
    const bool isChange = change && change->motor == i && motor.mode == JointMotor::Mode::holds;
    const bool goesOn = motor.mode == JointMotor::Mode::pushes && forces[at] * motor.sign > 0;
    const double most = (isChange || goesOn ? 1 - kAtItsEnd : 1) * motor.maxForce;
    const JointMotor before = motor;
    const bool pushes = isOff || std::abs(forces[at]) >= most;
    motor.mode = pushes ? JointMotor::Mode::pushes : JointMotor::Mode::holds;
    if (pushes) motor.sign = forces[at] < 0 ? -1 : 1;
    isOther = isOther || motor.mode != before.mode || (pushes && motor.sign != before.sign);
  }
  const double before = kineticEnergy(island_.assembly.mechanism.bodies, island_.state);
  island_.equations.keepTargets(island_.state);
  pushWork(island_.state) += kineticEnergy(island_.assembly.mechanism.bodies, island_.state) - before;
  return isOther;
}

}  // namespace cradle
