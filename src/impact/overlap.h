#pragma once

#include <vector>

#include "impact/contact_impulse.h"

namespace cradle {

/// Moves bodies apart until no contact overlaps, in the ratio of their inverse masses at the contact, with what ties
/// them. Positions only.
void resolveOverlaps(const ContactGeometry& geometry, const std::vector<Contact>& contacts,
                     const ImpulseResponse& response, VectorX& state);

}  // namespace cradle
