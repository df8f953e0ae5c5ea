// Power iteration with Rayleigh quotients (B. N. Parlett, "The Symmetric Eigenvalue Problem", 4.2 and 4.6) on
// W K, W the inverse masses with the constraints taken out and K the stiffnesses (or dampings) along the springs: both
// are symmetric and positive semi-definite. Quotients only grow, and are never larger than the eigenvalue.

#include "constraints/spring_modes.h"

#include <cmath>

#include "constraints/invariants.h"

namespace cradle {
namespace {

constexpr int kMaxIterations = 200;  // of the power method, which else ends by itself; bounds the cost
constexpr double kConverged = 1e-6;  // relative growth: the limits that follow are wanted to 1 %

using Coefficient = double SpringForce::*;

/// Motions are the velocities of a state whose poses are those of the instant.
class SpringResponse {
 public:
  SpringResponse(const Mechanism& mechanism, const VectorX& state)
      : mechanism_(mechanism), still_(state), solver_(mechanism.constraints, mechanism.bodies) {
    still_.tail(still_.size() - poseComponents(still_)).setZero();
    if (solver_.hasConstraints()) solver_.factorize(still_);
  }

  /// Twice the energy (kg m^2/s^2) per inertia that a coefficient's springs have in a motion.
  double quotient(const VectorX& motion, Coefficient coefficient) const {
    double sum = 0;
    for (const SpringForce& spring : mechanism_.springs) sum += part(spring, motion, coefficient);
    return sum / (2 * kineticEnergy(mechanism_.bodies, motion));
  }

  double part(const SpringForce& spring, const VectorX& motion, Coefficient coefficient) const {
    const double derivative = lengthening(spring, motion);
    return spring.*coefficient * derivative * derivative;
  }

  /// What bodies make of the forces of all springs in a motion.
  VectorX applied(const VectorX& motion, Coefficient coefficient) {
    VectorX response = still_;
    for (const SpringForce& spring : mechanism_.springs)
      pull(spring, spring.*coefficient * lengthening(spring, motion), response);
    constrain(response);
    return response;
  }

  /// What they make of one spring alone.
  VectorX pulledBy(const SpringForce& spring) {
    VectorX response = still_;
    pull(spring, 1, response);
    constrain(response);
    return response;
  }

  bool isAtRest(const VectorX& motion) const { return !(kineticEnergy(mechanism_.bodies, motion) > 0); }

 private:
  static double lengthening(const SpringForce& spring, const VectorX& motion) {
    const AttachmentMotion a = motionOf(spring.anchorA, motion), b = motionOf(spring.anchorB, motion);
    return (a.position - b.position).stableNormalized().dot(a.velocity - b.velocity);
  }

  void pull(const SpringForce& spring, double force, VectorX& response) const {
    const AttachmentMotion a = motionOf(spring.anchorA, still_), b = motionOf(spring.anchorB, still_);
    const Vec3 along = force * (a.position - b.position).stableNormalized();
    applyImpulse(mechanism_.bodies, spring.anchorA.body, a.arm, along, response);
    applyImpulse(mechanism_.bodies, spring.anchorB.body, b.arm, -along, response);
  }

  void constrain(VectorX& response) {
    if (solver_.hasConstraints()) solver_.constrainVelocities(response);
  }

  const Mechanism& mechanism_;
  VectorX still_;
  ConstraintSolver solver_;
};

/// The spring that is strongest on its own: what it moves has a part in the modes of those around it.
const SpringForce& strongest(SpringResponse& springs, const Mechanism& mechanism, Coefficient coefficient) {
  const SpringForce* found = &mechanism.springs[0];
  double most = 0;
  for (const SpringForce& spring : mechanism.springs) {
    const VectorX motion = springs.pulledBy(spring);
    const double own = springs.isAtRest(motion) ? 0 : springs.quotient(motion, coefficient);
    if (own > most) most = own, found = &spring;
  }
  return *found;
}

SpringMode largestMode(const Mechanism& mechanism, const VectorX& state, Coefficient coefficient) {
  if (mechanism.springs.empty()) return {};
  SpringResponse springs(mechanism, state);
  VectorX motion = springs.pulledBy(strongest(springs, mechanism, coefficient));
  if (springs.isAtRest(motion)) return {};
  double value = springs.quotient(motion, coefficient);
  for (int i = 0; i < kMaxIterations && value > 0; ++i) {
    motion = springs.applied(motion, coefficient);
    motion.tail(motion.size() - poseComponents(motion)) /= std::sqrt(2 * kineticEnergy(mechanism.bodies, motion));
    const double before = value;
    value = springs.quotient(motion, coefficient);
    if (value <= before * (1 + kConverged)) break;
  }

  SpringMode mode{springs.quotient(motion, &SpringForce::stiffness), springs.quotient(motion, &SpringForce::damping)};
  double most = 0;
  for (std::size_t i = 0; i < mechanism.springs.size(); ++i) {
    const double part = springs.part(mechanism.springs[i], motion, coefficient);
    if (part > most) most = part, mode.spring = i;
  }
  return mode;
}

}  // namespace

SpringMode stiffestMode(const Mechanism& mechanism, const VectorX& state) {
  return largestMode(mechanism, state, &SpringForce::stiffness);
}

SpringMode mostDampedMode(const Mechanism& mechanism, const VectorX& state) {
  return largestMode(mechanism, state, &SpringForce::damping);
}

}  // namespace cradle
