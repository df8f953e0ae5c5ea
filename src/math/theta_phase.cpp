#include "math/theta_phase.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "math/angle_reduction.h"
#include "math/elementary.h"

// theta_4(z | tau) = 1 + 2 sum (-1)^n q^(n^2) cos 2nz, q = exp(i pi tau), tau = 2 i K'/K, or by Jacobi's imaginary
// transformation, up to a real factor, exp(z^2 / (i pi tau)) theta_2(z / tau | -1/tau) (E. Whittaker, G. Watson, "A
// Course of Modern Analysis", 21.11 and 21.51). The first converges fast for K' > K/2, the second for K' < K/2; neither
// has more than four terms, and in neither does the sum come near zero.

namespace cradle {
namespace {

using std::numbers::pi;

/// z minus the nearest multiple of pi.
double nearestHalfTurn(double z) {
  const ReducedAngle reduced = reduceAngle(z);
  const double rest = reduced.remainder + reduced.tail;
  if (reduced.quarterTurns % 2 == 0) return rest;
  return rest > 0 ? rest - pi / 2 : rest + pi / 2;
}

}  // namespace

ThetaPhase::ThetaPhase(const QuarterPeriods& periods, double y) : isHyperbolic_(periods.imaginary < periods.real / 2) {
  if (isHyperbolic_) {
    hyperbolicScale_ = periods.real / (2 * periods.imaginary);
    linear_ = y / (2 * periods.imaginary);
    nome_ = exp(-pi * hyperbolicScale_);
    for (std::size_t n = 0; n < kTerms; ++n) {
      const SinCos angle = sinCos(static_cast<double>(2 * n + 1) * pi / 2 * linear_);
      terms_[n] = {angle.cos, -angle.sin};
    }
    return;
  }
  terms_[0] = {1, 0};
  double sign = -1;
  for (std::size_t n = 1; n < kTerms; ++n, sign = -sign) {
    // q^(n^2) exp(+- pi n y / K): one exponent, for y and K' may both be large.
    const auto order = static_cast<double>(n);
    const double growing = exp(-pi * order * (2 * order * periods.imaginary - y) / periods.real);
    const double falling = exp(-pi * order * (2 * order * periods.imaginary + y) / periods.real);
    terms_[n] = {sign * (growing + falling), sign * (growing - falling)};
  }
}

ThetaPhase::Direction ThetaPhase::at(double z) const {
  const Direction sum = isHyperbolic_ ? hyperbolicSum(nearestHalfTurn(z)) : trigonometricSum(z);
  const double length = std::sqrt(sum.real * sum.real + sum.imaginary * sum.imaginary);
  return {sum.real / length, sum.imaginary / length};
}

ThetaPhase::Direction ThetaPhase::trigonometricSum(double z) const {
  const SinCos once = sinCos(z);
  const double sine = 2 * once.sin * once.cos, cosine = (once.cos - once.sin) * (once.cos + once.sin);
  Direction sum{1, 0}, multiple{1, 0};  // multiple: of the angle 2 n z
  for (std::size_t n = 1; n < kTerms; ++n) {
    multiple = {multiple.real * cosine - multiple.imaginary * sine, multiple.imaginary * cosine + multiple.real * sine};
    sum.real += terms_[n].even * multiple.real;
    sum.imaginary += terms_[n].odd * multiple.imaginary;
  }
  return sum;
}

// Divided by exp(|z| K / (2 K')), so that nothing overflows: term n is p^(n^2 + n) times the hyperbolic cosine and sine
// of (2 n + 1) |z| K / (2 K').
ThetaPhase::Direction ThetaPhase::hyperbolicSum(double z) const {
  const double distance = std::fabs(z);
  const double falling = exp(-2 * hyperbolicScale_ * distance);
  const double growing = exp(-2 * hyperbolicScale_ * (pi / 2 - distance));  // times the nome
  Direction sum{0, 0};
  double fallingPower = falling, growingPower = 1;
  double nomePower = 1, step = nome_;  // p^(n^2), p^(2 n + 1)
  double nomeOnce = 1;                 // p^n
  for (const Term& term : terms_) {
    const double up = nomePower * growingPower, down = nomePower * nomeOnce * fallingPower;
    sum.real += term.even * (up + down);
    sum.imaginary += term.odd * (up - down);
    nomePower *= step;
    step *= nome_ * nome_;
    nomeOnce *= nome_;
    growingPower *= growing;
    fallingPower *= falling;
  }
  const SinCos turn = sinCos(linear_ * distance);
  const Direction turned{sum.real * turn.cos - sum.imaginary * turn.sin,
                         sum.real * turn.sin + sum.imaginary * turn.cos};
  return {turned.real, z < 0 ? -turned.imaginary : turned.imaginary};
}

double ThetaPhase::slopeAtZero() const {
  double real = 0, slope = 0, weight = 1, step = nome_ * nome_;
  for (std::size_t n = 0; n < kTerms; ++n) {
    const auto order = static_cast<double>(n);
    const double factor = isHyperbolic_ ? (2 * order + 1) * hyperbolicScale_ : 2 * order;
    real += weight * terms_[n].even;
    slope += weight * terms_[n].odd * factor;
    if (isHyperbolic_) {  // p^(n^2 + n)
      weight *= step;
      step *= nome_ * nome_;
    }
  }
  return linear_ + slope / real;
}

}  // namespace cradle
