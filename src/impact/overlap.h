#pragma once

#include <vector>

#include "impact/contact_impulse.h"

namespace cradle {

/// Moves bodies apart along the normals of their contacts until none overlaps, in the ratio of their inverse masses at
/// the contact, with their constraints. Positions only. Bodies whose inverse inertia is zero do not turn.
void resolveOverlaps(const ContactGeometry& geometry, const std::vector<Contact>& contacts,
                     const ImpulseResponse& response, VectorX& state);

}  // namespace cradle
