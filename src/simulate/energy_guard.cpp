#include "simulate/energy_guard.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "dynamics/invariants.h"

namespace cradle {
namespace {

constexpr double kUnexplained = 10;  // times the energy that can be explained: far beyond any method's error
constexpr double kSafePart = 0.5;    // of the stability limit: stable, and a few per cent accurate in frequency

}  // namespace

EnergyGuard::EnergyGuard(const Mechanism& mechanism, const VectorX& start, GuardNames names)
    : mechanism_(mechanism),
      start_(start),
      names_(std::move(names)),
      startConstant_(energyConstant(mechanism, start)),
      startEnergy_(kineticEnergy(mechanism.bodies, start)),
      excursions_(mechanism.bodies.size(), 0.0) {
  for (const SpringForce& spring : mechanism.springs) startEnergy_ += actionOf(spring, start).potential;
}

void EnergyGuard::check(const VectorX& state, double time, double timeStep) {
  if (!state.allFinite()) fail(state, time, "is not finite any more", cause(timeStep));
  const double gravity = mechanism_.gravity.norm();
  double explained = startEnergy_ + std::abs(pushWork(state)) + firstStepEnergy(timeStep);
  for (std::size_t i = 0; i < excursions_.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    excursions_[i] = std::max(excursions_[i], (centerOfMass(state, body) - centerOfMass(start_, body)).norm());
    explained += mechanism_.bodies[i].mass * gravity * excursions_[i];
  }
  const double change = std::abs(energyConstant(mechanism_, state) - startConstant_);
  if (!(change <= kUnexplained * explained))
    fail(state, time, fmt::format("has energy from nowhere ({:.3g} J of {:.3g} J explained)", change, explained),
         cause(timeStep));
}

void EnergyGuard::failAtShortestStep(const VectorX& state, double time) const {
  fail(state, time, "cannot be followed with steps of any length", stiffCause());
}

void EnergyGuard::failAtShortSteps(const VectorX& state, double time, double timeStep) const {
  fail(state, time, fmt::format("needs steps of {:.3g} s, too short to reach the end of the run", timeStep),
       stiffCause());
}

void EnergyGuard::failAtTies(const VectorX& state, double time, double error) const {
  fail(state, time, fmt::format("is tied by what cannot all be kept (off by {:.3g} m or rad)", error), cause(0));
}

/// What one step can give to bodies at rest by forces that do not depend on where they are: (F h)^2 / m. Methods of
/// order 1 have it in their error from the first step on, when nothing has moved yet.
double EnergyGuard::firstStepEnergy(double timeStep) const {
  double energy = 0;
  for (const RigidBody& body : mechanism_.bodies)
    energy += body.mass * mechanism_.gravity.squaredNorm() * timeStep * timeStep;
  for (const PushForce& push : mechanism_.pushes) {
    const RigidBody& body = mechanism_.bodies[static_cast<std::size_t>(push.point.body)];
    const double inverseMass = body.inverseMass + push.point.point.squaredNorm() * body.inverseInertia.norm();
    energy += push.force.squaredNorm() * timeStep * timeStep * inverseMass;
  }
  return energy;
}

void EnergyGuard::fail(const VectorX& state, double time, const std::string& what, const std::string& cause) const {
  std::size_t worst = 0;
  double most = -1;
  for (std::size_t i = 0; i < mechanism_.bodies.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const double energy = mechanism_.bodies[i].mass * linearVelocity(state, body).squaredNorm();
    const double size = std::isfinite(energy) ? energy : INFINITY;
    if (size > most) most = size, worst = i;
  }
  throw Error(ErrorKind::unstable, "",
              fmt::format("unstable at {:.6g} s: body \"{}\" {}; {}", time, names_.bodies[worst], what, cause));
}

/// The spring with the highest natural frequency at the start, and that (rad/s; 0 without springs).
std::pair<std::size_t, double> EnergyGuard::fastestSpring() const {
  std::pair<std::size_t, double> fastest(0, 0);
  for (std::size_t i = 0; i < mechanism_.springs.size(); ++i) {
    const double frequency = naturalFrequency(mechanism_.springs[i], mechanism_.bodies, start_);
    if (frequency > fastest.second) fastest = {i, frequency};
  }
  return fastest;
}

std::string EnergyGuard::stiffCause() const {
  const auto [spring, frequency] = fastestSpring();
  if (frequency == 0 || !mechanism_.constraints.empty()) return cause(0);
  return fmt::format(
      "spring \"{}\" (omega {:.3g} rad/s) is the fastest: give it less stiffness or damping, its bodies more mass, or "
      "take a rod in its place",
      names_.springs[spring], frequency);
}

std::string EnergyGuard::cause(double timeStep) const {
  if (timeStep == 0)
    return "what ties it leaves no motion, or forces grow without bound: look at its rods, joints and springs there";
  const auto [spring, fastest] = fastestSpring();
  const double product = timeStep * fastest;
  if (fastest == 0 || product < kSafePart * names_.stabilityLimit)
    return fmt::format("{} at a time step of {:.3g} s cannot follow it; give \"method\" a smaller \"timeStep\"",
                       names_.method, timeStep);
  if (names_.stabilityLimit == 0)
    return fmt::format(
        "spring \"{}\" (omega {:.4g} rad/s) gains energy at any step of {}; use semiImplicitEuler or rk4",
        names_.springs[spring], fastest, names_.method);
  return fmt::format(
      "spring \"{}\" has step x omega = {:.3g} s x {:.4g} rad/s = {:.3g}, the limit of {} is {:.3g}; a timeStep of "
      "{:.2g} "
      "s is safe",
      names_.springs[spring], timeStep, fastest, product, names_.method, names_.stabilityLimit,
      kSafePart * names_.stabilityLimit / fastest);
}

}  // namespace cradle
