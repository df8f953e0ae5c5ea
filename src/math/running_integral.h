#pragma once

#include <functional>
#include <vector>

#include "math/types.h"

namespace cradle {

/// The integral of a vector from the beginning of an interval to any place in it: of the polynomial of degree 10
/// through the integrand at the extremes of a Chebyshev polynomial (C. W. Clenshaw, A. R. Curtis 1960), eleven
/// evaluations; on halves of the interval, and halves of these, where its last coefficients would give more than the
/// tolerance.
class RunningIntegral {
 public:
  /// Evaluates the integrand. `tolerance` is that of each component, anywhere in the interval.
  RunningIntegral(const std::function<VectorX(double)>& integrand, double from, double to, double tolerance);

  VectorX upTo(double place) const;

 private:
  /// A part of the interval with one polynomial.
  struct Panel {
    double from, to;
    VectorX before;        // the integral up to `from`
    MatrixX coefficients;  // of the integral from there on, in Chebyshev polynomials: a column each
  };
  void add(const std::function<VectorX(double)>& integrand, double from, double to, double tolerance, int halvings);

  std::vector<Panel> panels_;
};

}  // namespace cradle
