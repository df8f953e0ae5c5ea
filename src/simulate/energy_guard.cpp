#include "simulate/energy_guard.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "constraints/invariants.h"
#include "core/error.h"
#include "simulate/steps/step_limit.h"

namespace cradle {
namespace {

constexpr double kUnexplained = 2;       // times the energy that can be explained: nothing is left of the motion
constexpr double kMaxLocalErrors = 100;  // times their sum: they are estimates; 0.1 of it has been seen
constexpr double kPlaceRounding = 64 * std::numeric_limits<double>::epsilon();  // of a place, over a run's steps
constexpr double kClosableGap = 1e-8;       // of a size: gaps are closed that are no wider
constexpr double kFinestTolerance = 1e-13;  // of a component in a step: finer tolerances are not kept
constexpr double kCalmRatio = 0.1;          // of what stops a run: before, the motion is still the scene's own
constexpr double kSafeRotation = 0.1;     // rad a step: RK4 is then right to 1e-7 a step; slower rotations are no cause
constexpr double kOverwhelming = 1e6;     // times all weights and springs: nothing else moves its body
constexpr double kUnseenFall = 0.01;      // of a body's size: bodies that rattle at rest may have as much of energy
constexpr double kPlainAcceleration = 1;  // m/s^2: of weights where there is no gravity
constexpr double kCollapsed = 1e-3;       // of its rest length: a spring without direction
constexpr double kMaxFollowedRate = 1e6;  // 1/s, rad/s: ten million steps of kSafeRotation a second

/// What an error of 1 + |y| in each component y of a state can change of its energy (J).
double energySensitivity(const Mechanism& mechanism, const VectorX& state) {
  double sum = 1 + std::abs(dissipatedEnergy(state)) + std::abs(pushWork(state));
  for (std::size_t i = 0; i < mechanism.bodies.size(); ++i) {
    const RigidBody& body = mechanism.bodies[i];
    const Eigen::Index index = static_cast<Eigen::Index>(i);
    const double speed = linearVelocity(state, index).norm(), angularSpeed = angularVelocity(state, index).norm();
    sum += body.mass * mechanism.gravity.norm() * (1 + centerOfMass(state, index).norm());
    sum += body.mass * speed * (1 + speed) + body.inertiaTensor.norm() * angularSpeed * (1 + 2 * angularSpeed);
  }
  for (const SpringForce& spring : mechanism.springs) {
    const SpringAction action = actionOf(spring, state);
    const double momentArms = action.a.arm.norm() + action.b.arm.norm();
    sum += action.forceOnA.norm() * (2 + action.a.position.norm() + action.b.position.norm() + 2 * momentArms);
  }
  return sum;
}

/// Kinetic + potential + dissipated - work (J).
double explainedConstant(const Mechanism& mechanism, const VectorX& state) {
  return energyConstant(mechanism, state) - numericalEnergy(state);
}

/// Angle (rad) by which the line between two attachments rotates in a time.
double rotationOf(const Attachment& anchorA, const Attachment& anchorB, const VectorX& state, double time) {
  const AttachmentMotion a = motionOf(anchorA, state), b = motionOf(anchorB, state);
  const Vec3 line = a.position - b.position;
  return line.cross(a.velocity - b.velocity).norm() / line.squaredNorm() * time;
}

double angularSpeedOf(int body, const VectorX& state) {
  return body == kFixed ? 0 : angularVelocity(state, body).norm();
}

const char* const kConstraintsCause =
    "what ties it leaves no motion, or forces grow without bound: look at its rods, ropes, joints and springs there";
const char* const kNoCause =
    "no tie, spring, push or speed explains it: give the scene a coarser \"accuracy\", whose steps do not follow each "
    "contact";

const char* const kDrivenCause =
    "what is driven may leave it no room: keep it farther off, or let a spring press in its place";

}  // namespace

double energyOfPlaceErrors(const Mechanism& mechanism, const std::vector<double>& radii, const VectorX& state,
                           double tolerance) {
  double sum = 0;
  for (std::size_t i = 0; i < mechanism.bodies.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const double error = kPlaceRounding * centerOfMass(state, body).norm() + kClosableGap * radii[i];
    sum += mechanism.bodies[i].mass * mechanism.gravity.norm() * error;
  }
  for (const SpringForce& spring : mechanism.springs) {
    const SpringAction action = actionOf(spring, state);
    const double size = action.a.position.norm() + action.b.position.norm() + action.a.arm.norm() +
                        action.b.arm.norm() + spring.restLength;
    const double rounding = kPlaceRounding * size, error = std::max(rounding, tolerance * (1 + size));
    sum += action.forceOnA.norm() * rounding + spring.stiffness * error * error;
  }
  return sum;
}

EnergyGuard::EnergyGuard(const Assembly& assembly, const VectorX& start, const ChosenMethod& method, double duration)
    : mechanism_(assembly.mechanism),
      names_(assembly.names),
      radii_(assembly.radii),
      start_(start),
      calm_(start_),
      method_(method),
      duration_(duration),
      startConstant_(explainedConstant(mechanism_, start_)),
      startEnergy_(kineticEnergy(mechanism_.bodies, start_)),
      mostError_(kUnexplained * (1 + springEnergyError(mechanism_, start_, method, duration))),
      excursions_(mechanism_.bodies.size(), 0.0) {
  for (const SpringForce& spring : mechanism_.springs) startEnergy_ += actionOf(spring, start_).potential;
}

void EnergyGuard::check(const VectorX& state, double time, double timeStep) {
  if (!state.allFinite()) fail(state, time, "is not finite any more", cause(state));
  double most = mostError_ * explainedEnergy(state, timeStep);
  if (method_.isAdaptive()) {
    errorSum_ += std::max(method_.tolerance, kFinestTolerance) * energySensitivity(mechanism_, state);
    most = std::min(most, kMaxLocalErrors * errorSum_);
  }
  most += energyOfPlaceErrors(mechanism_, radii_, state, method_.isAdaptive() ? method_.tolerance : 0);
  const double change = std::abs(explainedConstant(mechanism_, state) - startConstant_);
  if (!(change <= most))
    fail(state, time, fmt::format("has energy from nowhere ({:.3g} J; {:.3g} J can be explained)", change, most),
         cause(state));
  if (change <= kCalmRatio * most) calm_ = state;
}

/// All energy (J) that there can be, and that errors are measured by.
double EnergyGuard::explainedEnergy(const VectorX& state, double timeStep) {
  const double gravity = mechanism_.gravity.norm();
  double explained = startEnergy_ + std::abs(pushWork(state)) + firstStepEnergy(timeStep);
  for (std::size_t i = 0; i < excursions_.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    excursions_[i] = std::max(excursions_[i], (centerOfMass(state, body) - centerOfMass(start_, body)).norm());
    const double unseen = method_.isAdaptive() ? 0 : kUnseenFall * radii_[i];
    explained += mechanism_.bodies[i].mass * gravity * (excursions_[i] + unseen);
  }
  return explained;
}

void EnergyGuard::failAtShortestStep(const VectorX& state, double time) const {
  fail(state, time, "cannot be followed with steps of any length", stiffCause(state));
}

void EnergyGuard::failAtShortSteps(const VectorX& state, double time, double timeStep) const {
  fail(state, time, fmt::format("needs steps of {:.3g} s, too short to reach the end of the run", timeStep),
       stiffCause(state));
}

void EnergyGuard::failAtConstraints(const VectorX& state, double time, double error) const {
  fail(state, time, fmt::format("is tied by what cannot all be kept (off by {:.3g} m or rad)", error),
       kConstraintsCause);
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
    energy += (push.force.squaredNorm() * inverseMass + push.torque.squaredNorm() * body.inverseInertia.norm()) *
              timeStep * timeStep;
  }
  for (const JointMotor& motor : mechanism_.motors)
    for (const Attachment& end : {motor.joint.anchorA, motor.joint.anchorB}) {
      if (end.body == kFixed) continue;
      const RigidBody& body = mechanism_.bodies[static_cast<std::size_t>(end.body)];
      const double turning = body.inverseInertia.norm();
      const bool turns = std::get<JointCoordinate>(motor.joint.kind).turns;
      const double mobility = turns ? turning : body.inverseMass + end.point.squaredNorm() * turning;
      energy += motor.maxForce * motor.maxForce * mobility * timeStep * timeStep;
    }
  return energy;
}

void EnergyGuard::fail(const VectorX& state, double time, const std::string& what, const std::string& cause) const {
  std::size_t worst = 0;
  double most = -1;
  for (std::size_t i = 0; i < mechanism_.bodies.size(); ++i) {
    if (mechanism_.bodies[i].isDriven()) continue;
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const double energy = mechanism_.bodies[i].mass * linearVelocity(state, body).squaredNorm();
    const double size = std::isfinite(energy) ? energy : INFINITY;
    if (size > most) most = size, worst = i;
  }
  std::string why = cause == kNoCause && !mechanism_.driven.empty() ? kDrivenCause : cause;
  if (const PushForce* push = overwhelmingPush()) {
    worst = static_cast<std::size_t>(push->point.body);
    why = fmt::format(
        "a push of {:.3g} N accelerates it by {:.3g} m/s^2: give the push less force, or the body more mass",
        push->force.norm(), push->force.norm() / mechanism_.bodies[worst].mass);
  }
  throw Error(ErrorKind::unstable, "",
              fmt::format("unstable at {:.6g} s: body \"{}\" {}; {}", time, names_.bodies[worst], what, why));
}

/// The strongest push that acts, if weights and springs are next to nothing beside it. What it does may show first in
/// bodies that its own pulls along.
const PushForce* EnergyGuard::overwhelmingPush() const {
  double others = 0;  // N
  for (const RigidBody& body : mechanism_.bodies)
    others += body.mass * std::max(mechanism_.gravity.norm(), kPlainAcceleration);
  for (const SpringForce& spring : mechanism_.springs) others += actionOf(spring, start_).forceOnA.norm();
  const PushForce* strongest = nullptr;
  double most = kOverwhelming * others;
  for (const PushForce& push : mechanism_.pushes)
    if (push.force.norm() > most) most = push.force.norm(), strongest = &push;
  return strongest;
}

/// Why steps have to be so short.
std::string EnergyGuard::stiffCause(const VectorX& state) const {
  double fastest = 0;
  std::size_t spring = 0;
  for (std::size_t i = 0; i < mechanism_.springs.size(); ++i) {
    const double frequency = naturalFrequency(mechanism_.springs[i], mechanism_.bodies, start_);
    if (frequency > fastest) fastest = frequency, spring = i;
  }
  if (fastest == 0 || !mechanism_.constraints.empty()) return cause(state);
  return fmt::format(
      "spring \"{}\" (omega {:.3g} rad/s) is the fastest: give it less stiffness or damping, its bodies more mass, or "
      "take a rod in its place",
      names_.springs[spring], fastest);
}

std::string EnergyGuard::cause(const VectorX& state) const {
  if (!method_.isAdaptive())
    if (const auto fault = stepFault(mechanism_, calm_, method_, duration_))
      return fmt::format("spring \"{}\" {}", names_.springs[fault->spring], fault->text);
  for (std::size_t i = 0; i < mechanism_.springs.size(); ++i) {
    const SpringForce& spring = mechanism_.springs[i];
    const double length = (motionOf(spring.anchorA, calm_).position - motionOf(spring.anchorB, calm_).position).norm();
    if (length < kCollapsed * spring.restLength)
      return fmt::format("spring \"{}\" is {:.2g} m long, and has no direction at length 0: keep its ends apart",
                         names_.springs[i], length);
  }
  if (method_.isAdaptive()) return adaptiveCause(state);
  for (const VectorX* moment : {&calm_, &state}) {  // a start at rest shows nothing yet
    const std::string fastest = fastestRotation(*moment);
    if (!fastest.empty()) return fastest;
  }
  return fmt::format("{} at a time step of {:.3g} s cannot follow it; give \"method\" a smaller \"timeStep\"",
                     method_.name, method_.timeStep);
}

/// Why steps that are chosen by the error do not go on. Ties are not to blame where a body began faster than any steps
/// can follow.
std::string EnergyGuard::adaptiveCause(const VectorX& state) const {
  const bool isTied = !mechanism_.constraints.empty();
  std::string fast = fastestBody(start_);
  if (fast.empty() && !isTied) fast = fastestBody(state.allFinite() ? state : calm_);
  if (!fast.empty()) return fast;
  return isTied || !mechanism_.springs.empty() ? kConstraintsCause : kNoCause;
}

/// The body that spins, or passes its own size, most often in a second, if that is too often.
std::string EnergyGuard::fastestBody(const VectorX& state) const {
  double most = kMaxFollowedRate;
  std::string what;
  for (std::size_t i = 0; i < mechanism_.bodies.size(); ++i) {
    const double spin = angularSpeedOf(static_cast<int>(i), state);
    const double speed = linearVelocity(state, static_cast<Eigen::Index>(i)).norm();
    const double passes = radii_[i] > 0 ? speed / radii_[i] : 0;
    if (!(std::max(spin, passes) > most)) continue;
    most = std::max(spin, passes);
    what =
        fmt::format("body \"{}\" {}", names_.bodies[i],
                    spin >= passes ? fmt::format("spins at {:.3g} rad/s: give it less of a spin", spin)
                                   : fmt::format("moves at {:.3g} m/s, {:.3g} times its size in a second: give it less "
                                                 "speed, or what drives it less force",
                                                 speed, passes));
  }
  return what;
}

/// The rod, joint or body that rotates farthest in a step, if that is too far.
std::string EnergyGuard::fastestRotation(const VectorX& state) const {
  const double step = method_.timeStep;
  double most = kSafeRotation;
  std::string what;
  const auto consider = [&](double angle, const std::string& name) {
    if (angle > most) most = angle, what = name;
  };
  for (std::size_t i = 0; i < mechanism_.constraints.size(); ++i) {
    const auto& [anchorA, anchorB, kind] = mechanism_.constraints[i];
    const double angle =
        std::holds_alternative<RodConstraint>(kind)
            ? rotationOf(anchorA, anchorB, state, step)
            : step * std::max(angularSpeedOf(anchorA.body, state), angularSpeedOf(anchorB.body, state));
    consider(angle, i < names_.constraints.size() ? names_.constraints[i] : "a taut rope");
  }
  for (std::size_t i = 0; i < mechanism_.bodies.size(); ++i)
    consider(angularSpeedOf(static_cast<int>(i), state) * step, fmt::format("body \"{}\"", names_.bodies[i]));
  if (what.empty()) return what;
  return fmt::format(
      "{} turns by {:.3g} rad in a step of {:.3g} s, too far for {}; rk4 with a timeStep of {:.2g} s can follow", what,
      most, step, method_.name, kSafeRotation / most * step);
}

}  // namespace cradle
