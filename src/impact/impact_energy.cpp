#include "impact/impact_energy.h"

#include <cmath>

#include "constraints/invariants.h"
#include "dynamics/driven_body.h"

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

}  // namespace

void bookImpact(const std::vector<ImpactContact>& impacts, const std::vector<RigidBody>& bodies, const VectorX& before,
                VectorX& state) {
  double taken = 0, rounding = 0;
  for (const ImpactContact& impact : impacts) {
    taken +=
        energyTaken(impact.impulse, relativeVelocity(impact.contact, before), relativeVelocity(impact.contact, state));
    rounding += roundingOf(impact, bodies);
  }
  double work = 0;
  for (const auto& [contact, material, restSpeed, impulse] : impacts)
    work += powerOfDriven(bodies, contact.bodyA, contact.point, impulse, state) +
            powerOfDriven(bodies, contact.bodyB, contact.point, -impulse, state);
  pushWork(state) += work;
  const double lost = work + kineticEnergy(bodies, before) - kineticEnergy(bodies, state);
  impactEnergy(state) += std::abs(taken - lost) <= rounding ? lost : taken;
}

}  // namespace cradle
