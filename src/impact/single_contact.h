#pragma once

#include "math/types.h"

namespace cradle {

/// Solves the frictional contact problem (frictional_contact.h) of one contact in closed form, up to a root of one
/// variable: to rounding, in about a microsecond. G symmetric positive semi-definite. Zero if what would have to be
/// pushed cannot move.
Vec3 solveSingleContact(const Mat3& g, const Vec3& freeVelocity, double friction);

}  // namespace cradle
