#pragma once

#include <vector>

#include "collision/mesh_feature.h"
#include "collision/separation.h"
#include "constraints/contact_rows.h"

namespace cradle {

/// A feature of a pair, as separation.h numbers them, that an active contact or a joint holds together.
struct ActiveFeature {
  std::size_t pair = 0, feature = 0;
  ContactConstraint contact;   // the constraint that holds it
  TouchedFeature onMesh = {};  // the feature of a mesh that a sphere is held on
};

/// Sets `contacts` to those of a pair, with separations <= margin (m), that are not `held`; of other pairs `held` may
/// have features too.
void findContactsBesideHeld(const ContactGeometry& geometry, std::size_t pair, const std::vector<ActiveFeature>& held,
                            const VectorX& state, double margin, std::vector<Contact>& contacts);

/// The least separation (m) of points of a pair that are not held; `margin` (m) if that is less. Where a pair turns, it
/// falls no faster than points move, but for a manifold that gets new points. `scratch` is overwritten.
double gapBesideHeld(const ContactGeometry& geometry, std::size_t pair, const std::vector<ActiveFeature>& held,
                     const VectorX& state, double margin, std::vector<Contact>& scratch);

}  // namespace cradle
