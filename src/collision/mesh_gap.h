#pragma once

#include "collision/feature_neighbour_list.h"

namespace cradle {

/// Where two solids are nearest, or overlap deepest; in A's frame.
struct MeshGap {
  double separation = std::numeric_limits<double>::infinity();  // m, < 0: overlap
  Vec3 pointA = Vec3::Zero(), pointB = Vec3::Zero();            // m, on the surfaces
  Vec3 normal = Vec3::Zero();                                   // unit, from A to B
};

/// Signed separation of two closed surfaces. Apart: the distance, exact to rounding. Where they intersect: minus the
/// depth of the edge or vertex that is deepest inside the other solid, among those whose edges go through its surface;
/// exact while that is less than the triangles' size, continuous through 0 (to 1e-14 of the sizes), and never positive.
/// Of a sheet and a solid that it goes through: minus the way out to the side on which more of the solid is, or past
/// the sheet's border. One inside the other: minus the distance of the surfaces. Separations above `enough` (m) are not
/// looked for: then infinite. `near` is kept from call to
/// call with these surfaces; it changes nothing but the cost. O(log triangles) for pairs near in few places.
MeshGap gapBetween(const MeshPair& pair, FeatureNeighbourList& near, double enough);

}  // namespace cradle
