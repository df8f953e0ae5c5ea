#pragma once

#include <memory_resource>
#include <vector>

#include "math/types.h"

namespace cradle {

/// Corners of a convex polygon in order (m), or the ends of a line.
using Points = std::pmr::vector<Vec3>;

/// Leaves the part of a polygon on the inner side of the plane outward . x = offset (m). Changes `scratch`.
void clip(Points& polygon, Points& scratch, const Vec3& outward, double offset);

/// Leaves those points of a polygon, at most so many, that span most of its area. Points that are images of each other
/// go together, so that what is left of a mirror image is one.
void thinOut(std::size_t most, Points& polygon);

}  // namespace cradle
