#include "simulate/ledger_quadrature.h"

#include <algorithm>
#include <cmath>

#include "constraints/invariants.h"
#include "dynamics/driven_body.h"

namespace cradle {
namespace {

constexpr double kWorkRatio = 1;  // of the tolerance of a step: an error in it hides none of the motion's

}  // namespace

double toleranceOfWork(const ChosenMethod& method, const Mechanism& mechanism, const Step& step) {
  const auto slides = [](const ContactConstraint& contact) { return contact.motion == ContactMotion::sliding; };
  const auto works = [](const JointMotor& motor) {
    return motor.mode == JointMotor::Mode::holds && motor.targetVelocity != 0;
  };
  if (mechanism.driven.empty() && std::none_of(mechanism.motors.begin(), mechanism.motors.end(), works))
    return INFINITY;
  if (std::any_of(mechanism.contacts.begin(), mechanism.contacts.end(), slides)) return INFINITY;
  const double tolerance =
      kWorkRatio * method.tolerance * (std::abs(pushWork(step.state)) + kineticEnergy(mechanism.bodies, step.state));
  // The error norm of the work alone: |error| / (tolerance x (1 + |work|)).
  VectorX ofWork = VectorX::Constant(step.state.size(), INFINITY);
  pushWork(ofWork) = 1;
  const double size = std::max(std::abs(pushWork(step.startState)), std::abs(pushWork(step.state)));
  const double error = method.errorNorm(step, ofWork) * (1 + size);
  return error <= tolerance ? INFINITY : tolerance;
}

RunningIntegral integralOfLedger(EquationsOfMotion& equations, const Mechanism& mechanism, const Step& step,
                                 double tolerance) {
  VectorX sample, rates;
  const auto ratesAt = [&](double part) -> VectorX {
    interpolate(step, part, sample);
    place(mechanism.driven, step.time + part * step.timeStep, sample);
    equations.evaluate(step.time + part * step.timeStep, sample, rates);
    return step.timeStep * rates.tail<kLedgerSize>();
  };
  return {ratesAt, 0, 1, tolerance};
}

void setLedger(const RunningIntegral& integral, const Step& step, double fraction, VectorX& state) {
  VectorX ledger = step.startState.tail<kLedgerSize>() + integral.upTo(fraction);
  dampingEnergy(state) = dampingEnergy(ledger), pushWork(state) = pushWork(ledger);
}

}  // namespace cradle
