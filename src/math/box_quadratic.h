#pragma once

#include "math/types.h"

namespace cradle {

/// The x with |x_i| <= limits_i at which x^T A x / 2 - b^T x is least: where A x - b is zero, unless x_i is at its
/// limit and would go on. A is symmetric; of a free part that it leaves open, the least is taken, and where it is not
/// positive semi-definite, x is one of the places at which these conditions hold. Where dependent rows of A contradict
/// each other, some of their x_i are at their limits; what is left of b by no more than `rounding` is no contradiction.
/// A primal active-set method (J. Nocedal, S. J. Wright, "Numerical Optimization", 2006, section 16.5). O(n^3) a change
/// of the active set, of which there are about n.
VectorX boxMinimum(const MatrixX& A, const VectorX& b, const VectorX& limits, double rounding);

}  // namespace cradle
