#include "impact/impact_energy.h"

namespace cradle {

void bookImpact(const std::vector<ImpactContact>& impacts, const VectorX& before, VectorX& state) {
  double taken = 0;
  for (const ImpactContact& impact : impacts)
    taken +=
        energyTaken(impact.impulse, relativeVelocity(impact.contact, before), relativeVelocity(impact.contact, state));
  impactEnergy(state) += taken;
}

}  // namespace cradle
