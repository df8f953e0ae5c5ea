#pragma once

#include <vector>

#include "impact/contact_impulse.h"

namespace cradle {

/// A contact that takes part in an impact.
struct ImpactContact {
  Contact contact;
  ContactMaterial material;
  double restSpeed = 0;         // m/s: slower closing does not rebound
  Vec3 impulse = Vec3::Zero();  // N s, world, on B: what was applied in all
};

/// What had to be done to an impact beside its law.
struct ImpactFaults {
  double residual = 0;      // m/s: of the worst frictional contact problem that was not solved
  double scaledEnergy = 0;  // J: that the impulses found would have given
  int rounds = 0;           // that did not end the impact: contacts still close
};

/// The textbook law of simultaneous impacts: the pair that closes fastest gets its two-body impulse (Newton's
/// restitution, Coulomb's friction), again and again until no pair closes. Friction never adds energy: an impulse that
/// would is replaced by the one without friction. Throws Error(unstable) if it does not come to an end.
void resolvePairwise(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state);

/// The impulse (N s, world, on B) of one pair alone. Zero if it does not close.
Vec3 pairImpulse(const ImpactContact& impact, const ImpulseResponse& response, const VectorX& state);

}  // namespace cradle
