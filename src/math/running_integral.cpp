#include "math/running_integral.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "math/elementary.h"

namespace cradle {
namespace {

constexpr int kDegree = 10;      // of the integrand's polynomial
constexpr int kMaxHalvings = 8;  // a 256th of the interval: what is rougher than that has jumps
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();  // of sums of eleven terms, by their largest

/// A component a row, a column each for T_0, T_1 ... on -1..1: c_k = (2 / N) sum_j f(cos(j pi / N)) cos(j k pi / N)
/// with the first and the last term of the sum halved, and so the first and the last coefficient.
MatrixX coefficientsOf(const MatrixX& values) {
  MatrixX coefficients = MatrixX::Zero(values.rows(), kDegree + 1);
  const auto half = [](int at) { return at == 0 || at == kDegree ? 0.5 : 1; };
  for (int k = 0; k <= kDegree; ++k)
    for (int j = 0; j <= kDegree; ++j)
      coefficients.col(k) +=
          2.0 / kDegree * half(k) * half(j) * cradle::cos(j * k * std::numbers::pi / kDegree) * values.col(j);
  return coefficients;
}

/// From -1 on: the integral of T_k is T_(k+1) / (2 (k + 1)) - T_(k-1) / (2 (k - 1)), of T_0 it is T_1, of T_1 T_2 / 4.
MatrixX integrated(const MatrixX& coefficients) {
  MatrixX integral = MatrixX::Zero(coefficients.rows(), kDegree + 2);
  integral.col(1) = coefficients.col(0);
  for (int k = 1; k <= kDegree; ++k) {
    integral.col(k + 1) += coefficients.col(k) / (2 * (k + 1));
    if (k > 1) integral.col(k - 1) -= coefficients.col(k) / (2 * (k - 1));
  }
  for (int k = 1; k <= kDegree + 1; ++k) integral.col(0) -= (k % 2 == 0 ? 1 : -1) * integral.col(k);
  return integral;
}

}  // namespace

RunningIntegral::RunningIntegral(const std::function<VectorX(double)>& integrand, double from, double to,
                                 double tolerance) {
  add(integrand, from, to, tolerance, 0);
}

void RunningIntegral::add(const std::function<VectorX(double)>& integrand, double from, double to, double tolerance,
                          int halvings) {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  MatrixX values;
  for (int j = 0; j <= kDegree; ++j) {
    const VectorX value = integrand(middle + half * cradle::cos(j * std::numbers::pi / kDegree));
    if (j == 0) values.resize(value.size(), kDegree + 1);
    values.col(j) = value;
  }
  const MatrixX coefficients = coefficientsOf(values);
  // Of the two last, as an even or odd integrand lacks one. Each term T_k left out gives up to c_k half / k; those of a
  // kink, c_k like 1 / k^2, make that much together.
  const double left = half * coefficients.rightCols(2).cwiseAbs().rowwise().sum().maxCoeff();
  const double rounding = kRounding * half * values.cwiseAbs().maxCoeff();
  if (left > std::max(tolerance, rounding) && halvings < kMaxHalvings) {
    add(integrand, from, middle, tolerance / 2, halvings + 1);
    add(integrand, middle, to, tolerance / 2, halvings + 1);
    return;
  }
  const VectorX before = panels_.empty() ? VectorX::Zero(values.rows()) : upTo(from);
  panels_.push_back({from, to, before, half * integrated(coefficients)});
}

VectorX RunningIntegral::upTo(double place) const {
  const auto panel =
      std::find_if(panels_.begin(), panels_.end() - 1, [&](const Panel& one) { return place <= one.to; });
  const double x = (2 * place - panel->from - panel->to) / (panel->to - panel->from);
  double before = 1, now = x;  // T_0, T_1
  VectorX integral = panel->before + panel->coefficients.col(0);
  for (int k = 1; k <= kDegree + 1; ++k) {
    integral += now * panel->coefficients.col(k);
    before = std::exchange(now, 2 * x * now - before);
  }
  return integral;
}

}  // namespace cradle
