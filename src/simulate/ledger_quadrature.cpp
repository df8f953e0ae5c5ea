#include "simulate/ledger_quadrature.h"

#include <algorithm>
#include <cmath>

#include "constraints/invariants.h"
#include "dynamics/driven_body.h"
#include "math/gauss_legendre.h"

namespace cradle {
namespace {

constexpr double kWorkRatio = 1;  // of the tolerance of a step: an error in it hides none of the motion's

}  // namespace

double toleranceOfWork(const ChosenMethod& method, const Mechanism& mechanism, const Step& step) {
  const auto slides = [](const ContactConstraint& contact) { return contact.motion == ContactMotion::sliding; };
  if (mechanism.driven.empty() || std::any_of(mechanism.contacts.begin(), mechanism.contacts.end(), slides))
    return INFINITY;
  const double tolerance =
      kWorkRatio * method.tolerance * (std::abs(pushWork(step.state)) + kineticEnergy(mechanism.bodies, step.state));
  // The error norm of the work alone: |error| / (tolerance x (1 + |work|)).
  VectorX ofWork = VectorX::Constant(step.state.size(), INFINITY);
  pushWork(ofWork) = 1;
  const double size = std::max(std::abs(pushWork(step.startState)), std::abs(pushWork(step.state)));
  const double error = method.errorNorm(step, ofWork) * (1 + size);
  return error <= tolerance ? INFINITY : tolerance;
}

void integrateLedger(EquationsOfMotion& equations, const Mechanism& mechanism, const Step& step, double fraction,
                     double tolerance, VectorX& state) {
  VectorX sample, rates;
  const auto ratesAt = [&](double part) -> VectorX {
    interpolate(step, part, sample);
    place(mechanism.driven, step.time + part * step.timeStep, sample);
    equations.evaluate(step.time + part * step.timeStep, sample, rates);
    return rates.tail<kLedgerSize>();
  };
  const double length = step.timeStep;
  VectorX ledger = step.startState.tail<kLedgerSize>(), known;
  if (fraction == 1) known = (step.state.tail<kLedgerSize>() - ledger) / length;
  ledger += length * integralOf(ratesAt, 0, fraction, tolerance / length, known);
  dampingEnergy(state) = dampingEnergy(ledger), pushWork(state) = pushWork(ledger);
}

}  // namespace cradle
