#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "render/drawn_hull.h"
#include "render/tile_mask.h"

namespace cradle {

/// Appends a hull, if it is of two spheres in pieces along it: each meets less of what is before or behind it.
void appendPieces(const DrawnHull& hull, std::vector<DrawnHull>& pieces);

/// Appends the pieces of a hull whose shadow is looked for.
void appendCaster(const DrawnHull& hull, std::vector<DrawnHull>& casters);

/// Where a caster stands in the shadow map, with what rounding may add.
PixelRectangle shadowTexels(const DrawnHull& hull, const RenderSetup& setup);

/// Where casters stand in the shadow map, with what rounding may add; none for no casters.
std::optional<PixelRectangle> shadowTexels(const std::vector<DrawnHull>& casters, const RenderSetup& setup);

}  // namespace cradle
