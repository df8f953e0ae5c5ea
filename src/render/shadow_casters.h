#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "render/drawn_hull.h"
#include "render/tile_mask.h"

namespace cradle {

/// Appends a hull whose shadow is looked for: a rod piece by piece, for each meets less of what is behind it.
void appendCaster(const DrawnHull& hull, std::vector<DrawnHull>& casters);

/// For how far a box must be moved along `direction`, from the least to the most and not backwards, to meet another box
/// (in lengths of `direction`); none if the first is greater.
std::pair<double, double> distancesOfOverlap(const Bounds& box, const Vec3& direction, const Bounds& other);

/// Where a caster stands in the shadow map, with what rounding may add.
PixelRectangle shadowTexels(const DrawnHull& hull, const Stage& stage);

/// Where casters stand in the shadow map, with what rounding may add; none for no casters.
std::optional<PixelRectangle> shadowTexels(const std::vector<DrawnHull>& casters, const Stage& stage);

}  // namespace cradle
