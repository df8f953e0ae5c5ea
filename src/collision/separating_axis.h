#pragma once

#include "collision/core.h"

namespace cradle {

/// A direction that may separate A (behind) from B (ahead).
struct SeparatingAxis {
  double separation = -std::numeric_limits<double>::infinity();  // m: gap that the normal sees, < 0: overlap
  Vec3 normal = Vec3::UnitY();                                   // unit, from A to B
};

/// The best axes of each kind, as far as they are better than those before them here.
struct SeparatingAxes {
  SeparatingAxis faceOfA, faceOfB, edges;
};

/// Of two polytopes, or one and a segment. The largest of the three separations is exact where they overlap, the least
/// translation that separates them; apart it is at most the distance. O(faces + edges that face each other), each with
/// a walk along edges.
SeparatingAxes separatingAxes(const Core& a, const Core& b);

}  // namespace cradle
