#pragma once

#include "math/types.h"

namespace cradle {

/// lambda with 0 <= lambda perp A lambda + b >= 0, A symmetric positive semi-definite. Direct: exact to rounding after
/// finitely many pivots. A may be singular: lambda is then one of many, A lambda is the same for all. Rows that no
/// lambda can satisfy are left as they are. Throws Error(unstable) if rounding keeps it from coming to an end.
/// O(pivots x size^3), as many pivots as about the size.
VectorX solveLinearComplementarity(const MatrixX& a, const VectorX& b);

}  // namespace cradle
