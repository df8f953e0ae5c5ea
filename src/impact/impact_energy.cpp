#include "impact/impact_energy.h"

#include <algorithm>
#include <cmath>

#include "constraints/invariants.h"

namespace cradle {
namespace {

// Of the velocity that an impulse gives to bodies without constraints: 90 unit roundoffs, for the sums of some tens of
// products by which a response is found.
constexpr double kResponseRounding = 1e-14;

/// Bound (J) on the rounding of the work of an impulse. Where constraints take nearly all of the impulse, it is large
/// beside the work that is left.
double roundingOf(const ImpactContact& impact, const std::vector<RigidBody>& bodies) {
  double inverseMass = 0;  // 1/kg
  for (const int body : {impact.contact.bodyA, impact.contact.bodyB})
    if (body != kFixed) inverseMass += bodies[static_cast<std::size_t>(body)].inverseMass;
  return kResponseRounding * impact.impulse.squaredNorm() * inverseMass;
}

/// J: of what drives bodies, against impacts.
double workOfDriven(const std::vector<ImpactContact>& impacts, const std::vector<RigidBody>& bodies,
                    ConstraintSolver& constraints, const VectorX& state) {
  if (std::none_of(bodies.begin(), bodies.end(), [](const RigidBody& body) { return body.isDriven(); })) return 0;
  const VectorX led = ledVelocities(bodies, constraints, state);
  double work = 0;
  for (const ImpactContact& impact : impacts) work -= impact.impulse.dot(relativeVelocity(impact.contact, led));
  return work;
}

}  // namespace

// With rows J of the constraints, let u be the others' velocities and w those of driven bodies: J_u u + J_w w = 0, and
// M u = J_u^T nu for the least energy. An impulse p with rows N is answered by mu: M du = N_u^T p + J_u^T mu, J_u du =
// 0. Then 0 = nu . J_u du = u . M du = p . N_u u + mu . J_u u. What drives bodies works against the impulse and the
// answer: -p . N_w w - mu . J_w w = -p . N_w w + mu . J_u u = -p . (N_w w + N_u u).
VectorX ledVelocities(const std::vector<RigidBody>& bodies, ConstraintSolver& constraints, const VectorX& state) {
  VectorX led = state;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!bodies[i].isDriven()) {
      const auto body = static_cast<Eigen::Index>(i);
      linearVelocity(led, body).setZero(), angularVelocity(led, body).setZero();
    }
  if (constraints.hasConstraints()) constraints.constrainVelocities(led);
  return led;
}

void bookImpact(const std::vector<ImpactContact>& impacts, const std::vector<RigidBody>& bodies,
                ConstraintSolver& constraints, const VectorX& before, VectorX& state) {
  double taken = 0, rounding = 0;
  for (const ImpactContact& impact : impacts) {
    taken +=
        energyTaken(impact.impulse, relativeVelocity(impact.contact, before), relativeVelocity(impact.contact, state));
    rounding += roundingOf(impact, bodies);
  }
  const double work = workOfDriven(impacts, bodies, constraints, state);
  pushWork(state) += work;
  const double lost = work + kineticEnergy(bodies, before) - kineticEnergy(bodies, state);
  impactEnergy(state) += std::abs(taken - lost) <= rounding ? lost : taken;
}

}  // namespace cradle
