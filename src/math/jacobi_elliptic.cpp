#include "math/jacobi_elliptic.h"

#include <cmath>
#include <numbers>

#include "core/error.h"

// Arithmetic-geometric mean and descending Landen transformation (M. Abramowitz, I. Stegun, "Handbook of Mathematical
// Functions", 16.4, 17.6), the latter on the cotangent of the amplitude as R. Bulirsch does ("Numerical calculation of
// elliptic integrals and elliptic functions", Numer. Math. 7, 1965): only products and sums of positive numbers, so
// that nothing cancels at any modulus.

namespace cradle {

JacobiElliptic::JacobiElliptic(double complementaryModulus) {
  constexpr double kLastDifference = 1e-8;  // the next one is its square, and nothing
  double arithmetic = 1, geometric = complementaryModulus, difference = 1;
  while (difference > kLastDifference) {
    CRADLE_CHECK(count_ < means_.size());
    means_[count_++] = {arithmetic, geometric};
    difference = (arithmetic - geometric) / arithmetic;
    const double product = arithmetic * geometric;
    arithmetic = (arithmetic + geometric) / 2;
    geometric = std::sqrt(product);
  }
  commonMean_ = arithmetic;
  quarterPeriod_ = std::numbers::pi / (2 * commonMean_);
}

JacobiElliptic::Values JacobiElliptic::at(const SinCos& phase) const {
  constexpr double kLinear = 1e-100;  // here sn = u, and the square of the cotangent would overflow
  if (std::fabs(phase.sin) < kLinear) return {phase.sin / commonMean_, std::copysign(1.0, phase.cos), 1};
  double cotangent = phase.cos / phase.sin, scaled = commonMean_ * cotangent, dn = 1;
  for (std::size_t i = count_; i-- > 0;) {
    const Means& mean = means_[i];
    const double square = cotangent * scaled;
    scaled *= dn;
    dn = (mean.geometric + square) / (mean.arithmetic + square);
    cotangent = scaled / mean.arithmetic;
  }
  const double sn = std::copysign(1 / std::sqrt(1 + scaled * scaled), phase.sin);
  return {sn, scaled * sn, dn};
}

double ellipticArgument(const JacobiElliptic::Values& values) {
  // u = sn R_F(cn^2, dn^2, 1), by duplication (B. Carlson, "Computing elliptic integrals by duplication", Numer. Math.
  // 33, 1979). The relative differences shrink to a quarter each time; what the series leaves out is of their sixth
  // power.
  constexpr double kDifference = 1e-3;
  double x = values.cn * values.cn, y = values.dn * values.dn, z = 1, mean = 1, dx = 1, dy = 1, dz = 1;
  while (std::fabs(dx) > kDifference || std::fabs(dy) > kDifference || std::fabs(dz) > kDifference) {
    const double rootX = std::sqrt(x), rootY = std::sqrt(y), rootZ = std::sqrt(z);
    const double lambda = rootX * rootY + rootX * rootZ + rootY * rootZ;
    x = (x + lambda) / 4, y = (y + lambda) / 4, z = (z + lambda) / 4;
    mean = (x + y + z) / 3;
    dx = (mean - x) / mean, dy = (mean - y) / mean, dz = (mean - z) / mean;
  }
  const double e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
  return values.sn * (1 + (e2 / 24 - 0.1 - 3 * e3 / 44) * e2 + e3 / 14) / std::sqrt(mean);
}

}  // namespace cradle
