#pragma once

#include "constraints/constraint_block.h"

namespace cradle {

/// Puts C = a . b = 0, without unit, into a row of `block`, for unit vectors a that turns with body A and b that turns
/// with B (in their frames, or the world's): the angle between them stays a right one. Leaves block.turnsA and turnsB.
void putOrthogonal(const Vec3& directionA, const Vec3& directionB, const ConstraintEnds& ends, std::size_t row,
                   ConstraintBlock& block);

/// Puts three rows from `firstRow` on that keep B from turning against A: of two triads that are one at `aFromB` (the
/// orientation of B as A sees it), a1 . b2 = a2 . b3 = a3 . b1 = 0. A turn about one axis has the error sin(angle) in
/// one row; where they hold, the rows are the components of the relative angular velocity.
void putSameOrientation(const Mat3& aFromB, const ConstraintEnds& ends, std::size_t firstRow, ConstraintBlock& block);

}  // namespace cradle
