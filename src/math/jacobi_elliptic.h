#pragma once

#include <array>
#include <cstddef>

#include "math/elementary.h"

namespace cradle {

/// Jacobi's elliptic functions sn, cn, dn of one modulus k, for any real argument u.
class JacobiElliptic {
 public:
  struct Values {
    double sn, cn, dn;
  };

  /// k' = sqrt(1 - k^2), from 1e-145 to 1: near k = 1 it says what k cannot. O(log log 1/k').
  explicit JacobiElliptic(double complementaryModulus);

  /// K: sn and cn have the period 4 K, dn has 2 K.
  double quarterPeriod() const { return quarterPeriod_; }

  /// The values at u = K / (pi/2) phase, from the sine and cosine of the phase. O(log log 1/k').
  Values at(const SinCos& phase) const;

 private:
  struct Means {
    double arithmetic, geometric;
  };
  std::array<Means, 16> means_;  // of 1 and k'; 13 are needed for k' = 1e-145
  std::size_t count_ = 0;
  double commonMean_;
  double quarterPeriod_;
};

/// The argument u, within one quarter period of 0, at which Jacobi's functions have these values; cn >= 0, dn >= 0, not
/// both 0. Exact to rounding also where cn and dn are tiny.
double ellipticArgument(const JacobiElliptic::Values& values);

}  // namespace cradle
