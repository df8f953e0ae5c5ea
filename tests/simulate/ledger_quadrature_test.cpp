#include "simulate/ledger_quadrature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "constraints/invariants.h"

namespace cradle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

RigidBody evenBody(double mass) {
  return makeRigidBody({mass, Vec3::Zero(), 0.1 * mass * Mat3::Identity()});
}

VectorX stillState(Eigen::Index bodies) {
  VectorX state = VectorX::Zero(stateSize(bodies));
  for (Eigen::Index body = 0; body < bodies; ++body) setOrientation(state, body, Quat::Identity());
  return state;
}

/// A step in which everything stays as `state` has it, ready to be interpolated.
Step stillStep(const VectorX& state, double time, double timeStep) {
  Step step;
  step.time = time, step.timeStep = timeStep;
  step.startState = step.state = state;
  step.startDerivative = step.endDerivative = VectorX::Zero(state.size());
  step.hasEndDerivative = true;
  return step;
}

/// A body that goes along x as 1 + a t + b t^2 / 2, which is what its step has between its ends, on a damper to the
/// origin, pushed by a force.
struct DampedBody {
  static constexpr double kSpeed = 2, kRate = 3, kDamping = 0.7, kPush = 5, kLength = 0.5;  // a, b; N s/m, N, s
  Mechanism mechanism;
  EquationsOfMotion equations{mechanism};
  Step step = stillStep(stillState(1), 4, kLength);

  DampedBody() {
    mechanism.bodies = {evenBody(2)};
    mechanism.springs = {{{0, Vec3::Zero()}, {kFixed, Vec3::Zero()}, 0, kDamping, 0}};
    mechanism.pushes = {{{0, Vec3::Zero()}, Vec3(kPush, 0, 0)}};
    const double end = kSpeed + kRate * kLength;
    centerOfMass(step.startState, 0).x() = 1, linearVelocity(step.startState, 0).x() = kSpeed;
    centerOfMass(step.state, 0).x() = 1 + wayIn(kLength), linearVelocity(step.state, 0).x() = end;
    centerOfMass(step.startDerivative, 0).x() = kSpeed, centerOfMass(step.endDerivative, 0).x() = end;
    linearVelocity(step.startDerivative, 0).x() = linearVelocity(step.endDerivative, 0).x() = kRate;
    dampingEnergy(step.startState) = 0.25, pushWork(step.startState) = -0.5;
  }
  static double wayIn(double time) { return time * (kSpeed + kRate * time / 2); }
};

// Damping takes c v^2, of the integral c ((a + b t)^3 - a^3) / (3 b), and a force gives itself times the way. Nothing
// else of the ledger changes.
TEST(LedgerQuadrature, AddsWhatDampersTakeAndForcesGive) {
  DampedBody at;
  for (const double tolerance : {1e-9, kInfinity}) {
    const RunningIntegral ledger = integralOfLedger(at.equations, at.mechanism, at.step, tolerance);
    for (const double fraction : {0.0, 0.6, 1.0}) {
      VectorX state = VectorX::Constant(at.step.state.size(), 7);
      setLedger(ledger, at.step, fraction, state);
      const double time = fraction * DampedBody::kLength, speed = DampedBody::kSpeed + DampedBody::kRate * time;
      const double damped =
          DampedBody::kDamping * (std::pow(speed, 3) - std::pow(DampedBody::kSpeed, 3)) / (3 * DampedBody::kRate);
      constexpr double kRounding = 1e-14;  // J, of some J
      EXPECT_NEAR(dampingEnergy(state), 0.25 + damped, kRounding) << fraction;
      EXPECT_NEAR(pushWork(state), -0.5 + DampedBody::kPush * DampedBody::wayIn(time), kRounding) << fraction;
      dampingEnergy(state) = pushWork(state) = 7;
      EXPECT_EQ(state, VectorX::Constant(state.size(), 7));
    }
  }
}

// A body is driven up and down three times in the step, on a spring to one that stays. The drive's work is what the
// spring stores, k (d - L)^2 / 2, whatever the step says of the driven body's place.
TEST(LedgerQuadrature, FollowsWhatIsDrivenAtItsTimes) {
  Mechanism mechanism;
  mechanism.bodies = {evenBody(2), drivenRigidBody()};
  mechanism.springs = {{{0, Vec3::Zero()}, {1, Vec3::Zero()}, 20, 0, 0.8}};
  const OscillatingMotion motion{{Quat::Identity(), Vec3(0, 2, 0)}, Vec3::UnitY(), 0.5, 3, 0.4};
  add(1, motion, mechanism.driven);
  EquationsOfMotion equations(mechanism);
  const Step step = stillStep(stillState(2), 0.25, 1);
  const auto stored = [&](double time) {
    const double length = 2 + 0.5 * std::sin(2 * std::numbers::pi * 3 * time + 0.4);
    return 20.0 / 2 * (length - 0.8) * (length - 0.8);
  };
  const double fraction = 0.9, work = stored(0.25 + fraction) - stored(0.25);
  VectorX state = step.state;
  setLedger(integralOfLedger(equations, mechanism, step, 1e-9), step, fraction, state);
  EXPECT_NEAR(pushWork(state), work, 1e-9);
  setLedger(integralOfLedger(equations, mechanism, step, kInfinity), step, fraction, state);
  EXPECT_GT(std::abs(pushWork(state) - work), 1e-3);  // one polynomial does not follow three periods
}

/// A method of the tolerance 1e-6 that takes the length of a step for its error norm, if it is asked for that of the
/// work alone.
ChosenMethod methodOfKnownError() {
  ChosenMethod method;
  method.tolerance = 1e-6;
  method.errorNorm = [](const Step& step, const VectorX& tolerance) {
    const bool isOfWork = pushWork(tolerance) == 1 && tolerance.array().isFinite().count() == 1;
    return isOfWork ? step.timeStep : std::numeric_limits<double>::quiet_NaN();
  };
  return method;
}

// The tolerance is that of steps times the work, 3 J, and the kinetic energy, 2 kg (2 m/s)^2 / 2. A norm n means an
// error of n (1 + the larger work of both ends, 5 J).
TEST(ToleranceOfWork, IsThatOfStepsWhereTheirSumIsLessExact) {
  Mechanism mechanism;
  mechanism.bodies = {evenBody(2), drivenRigidBody()};
  add(1, OscillatingMotion{}, mechanism.driven);
  Step step = stillStep(stillState(2), 0, 0);
  linearVelocity(step.state, 0) = Vec3(0, 0, 2), pushWork(step.state) = -3, pushWork(step.startState) = -5;
  const double tolerance = 1e-6 * (3 + 4);
  for (const double part : {0.99, 1.01}) {
    step.timeStep = part * tolerance / (1 + 5);
    const double found = toleranceOfWork(methodOfKnownError(), mechanism, step);
    if (part < 1)
      EXPECT_EQ(found, kInfinity);
    else
      EXPECT_NEAR(found, tolerance, 1e-20);
  }
  step.timeStep = 1;
  mechanism.contacts.resize(1);
  EXPECT_LT(toleranceOfWork(methodOfKnownError(), mechanism, step), 1);
  mechanism.contacts[0].motion = ContactMotion::sliding;
  EXPECT_EQ(toleranceOfWork(methodOfKnownError(), mechanism, step), kInfinity);
  mechanism.contacts.clear(), mechanism.driven.clear();
  EXPECT_EQ(toleranceOfWork(methodOfKnownError(), mechanism, step), kInfinity);
}

}  // namespace
}  // namespace cradle
