#pragma once

#include <vector>

#include "math/types.h"

namespace cradle {

/// Finds fixed points x = f(x) where x_next = f(x) comes near slowly, or not at all (D. G. Anderson, "Iterative
/// procedures for nonlinear integral equations", Journal of the ACM 12, 1965). Of a linear f of n numbers it is there
/// after n + 1 evaluations.
class AndersonMixing {
 public:
  /// Where to evaluate f next, after it was `image` at `x`.
  VectorX next(const VectorX& x, const VectorX& image);

 private:
  std::vector<VectorX> points_, steps_;  // the last x, and f(x) - x there
};

}  // namespace cradle
