#pragma once

#include "collision/core.h"

namespace cradle {

/// A direction that may separate A (behind) from B (ahead).
struct SeparatingAxis {
  double separation = -std::numeric_limits<double>::infinity();  // m: gap that the normal sees, < 0: overlap
  Vec3 normal = Vec3::UnitY();                                   // unit, from A to B
};

/// The best axes of each kind. A kind is searched only for axes that see a larger gap than those of the kinds before it
/// in this order (faces of B: or as large a one).
struct SeparatingAxes {
  SeparatingAxis faceOfA, faceOfB, edges;
};

/// The separating axes of two polytopes, or of one and a segment. Where they overlap, the largest of the three
/// separations is minus the least translation that separates them, exact to rounding; where they are apart, it is at
/// most their distance. O(faces + edges that face each other), each with a walk along edges.
SeparatingAxes separatingAxes(const Core& a, const Core& b);

/// The same where an axis is known that may be the best, which most others need not be compared with: those that see no
/// more than it does less `preference` (m) need not be found.
SeparatingAxes separatingAxes(const Core& a, const Core& b, const SeparatingAxis& known, double preference);

}  // namespace cradle
