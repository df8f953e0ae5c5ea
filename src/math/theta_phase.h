#pragma once

#include <array>

namespace cradle {

/// The periods of Jacobi's elliptic functions: K, and K' of the complementary modulus; K' may be infinite.
struct QuarterPeriods {
  double real, imaginary;
};

/// Direction in the complex plane of Jacobi's theta function theta_4(z - i pi y / (2 K)), of nome exp(-2 pi K'/K),
/// along the real line z; y is from 0 to K'. It is an odd function of z with period pi, and the part of an elliptic
/// integral of the third kind that oscillates.
class ThetaPhase {
 public:
  struct Direction {
    double real, imaginary;  // of length 1
  };

  ThetaPhase(const QuarterPeriods& periods, double y);

  Direction at(double z) const;  // O(1)

  /// Derivative of the phase (rad) with respect to z, at z = 0.
  double slopeAtZero() const;

 private:
  Direction trigonometricSum(double z) const;
  Direction hyperbolicSum(double z) const;

  struct Term {
    double even, odd;
  };
  static constexpr std::size_t kTerms = 4;
  std::array<Term, kTerms> terms_;
  bool isHyperbolic_;
  double nome_ = 0;             // of the hyperbolic sum
  double linear_ = 0;           // rad per rad of z, in the hyperbolic sum
  double hyperbolicScale_ = 0;  // K / (2 K')
};

}  // namespace cradle
