#pragma once

#include <functional>

#include "math/types.h"

namespace cradle {

/// The integral of a vector over [from, to], by the formula of Gauss and Legendre with six nodes, exact for polynomials
/// of degree 11; on halves of an interval, and halves of these, where it differs from the whole by more than
/// `tolerance` in any component. With an infinite tolerance one formula, six evaluations. `known` is the integral as
/// found in another way; one formula that differs from it by no more is enough.
VectorX integralOf(const std::function<VectorX(double)>& integrand, double from, double to, double tolerance,
                   const VectorX& known = {});

}  // namespace cradle
