#pragma once

#include <optional>
#include <vector>

#include "simulate/events/contact_record.h"
#include "simulate/island_state.h"

namespace cradle {

/// m: how far the centre of a sphere is inside the Voronoi region of the feature of a mesh that it touches; 0 at the
/// border, which is as wide as the mesh's rounding.
double insideVoronoiRegion(const Contact& contact, const SphereOverMesh& sphere);

/// The first contact of a sphere that leaves its feature of a mesh within the island's step.
struct FeatureChange {
  double fraction = 0;  // of the step
  std::size_t record = 0;
};
std::optional<FeatureChange> firstFeatureChange(const std::vector<ContactRecord>& records, const IslandState& island);

/// Whether a row can keep this contact of a mesh: a sphere's always; a body of another shape has to be over one flat
/// face, with room beside it. True without a mesh. `touchTolerance` in m; `frames` are those of the island's state.
bool isServedOnMesh(const ContactRecord& record, double touchTolerance, const std::vector<BodyFrame>& frames,
                    const IslandState& island);

}  // namespace cradle
