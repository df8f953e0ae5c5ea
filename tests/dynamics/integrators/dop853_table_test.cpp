#include "dynamics/integrators/dop853_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle::dop853_table {
namespace {

// Sums of 16 products of numbers up to 50, against 1e-16 each.
constexpr double kRounding = 1e-14;

double sumOf(const Weights& weights, int power) {
  double sum = 0;
  for (std::size_t i = 0; i < kDerivatives; ++i) sum += weights[i] * std::pow(kNodes[i], power);
  return sum;
}

double largest(const Weights& weights) {
  double most = 1;
  for (const double weight : weights) most = std::max(most, std::abs(weight));
  return most;
}

/// The weights of nodes that a sum over two stages gives: sum_i weights_i a_ij.
Weights throughStages(const Weights& weights) {
  Weights through{};
  for (std::size_t i = 0; i < kEndDerivative; ++i)
    for (std::size_t j = 0; j < i; ++j) through[j] += weights[i] * kStages[i][j];
  return through;
}

TEST(Dop853Table, EveryStageUsesOnlyRatesBeforeIt) {
  for (std::size_t i = 0; i < kDerivatives; ++i)
    for (std::size_t j = i; j < kDerivatives; ++j) EXPECT_EQ(kStages[i][j], 0) << i << " " << j;
}

TEST(Dop853Table, WeightsOfAStageAddUpToItsNode) {
  for (std::size_t i = 0; i < kDerivatives; ++i)
    EXPECT_NEAR(sumOf(kStages[i], 0), kNodes[i], kRounding * largest(kStages[i])) << i;
}

// The simplifying assumptions of the construction, II.5 (5.20): stages of order 2 from the third, 3 from the fifth.
TEST(Dop853Table, StagesIntegratePolynomials) {
  for (std::size_t i = 2; i < kDerivatives; ++i)
    EXPECT_NEAR(sumOf(kStages[i], 1), std::pow(kNodes[i], 2) / 2, kRounding * largest(kStages[i])) << i;
  for (std::size_t i = 3; i < kDerivatives; ++i)
    EXPECT_NEAR(sumOf(kStages[i], 2), std::pow(kNodes[i], 3) / 3, kRounding * largest(kStages[i])) << i;
}

// Order conditions of the bushy trees: y' = t^k is exact for k < 8, and not for k = 8.
TEST(Dop853Table, ResultIntegratesPolynomialsOfDegreeSeven) {
  for (int k = 0; k < 8; ++k) EXPECT_NEAR(sumOf(kStages[kEndDerivative], k), 1.0 / (k + 1), kRounding * 6) << k;
  EXPECT_GT(std::abs(sumOf(kStages[kEndDerivative], 8) - 1.0 / 9), 1e-8);
}

// Trees with a branch, sum_ij b_i c_i^m a_ij c_j^k = 1 / ((k + 1) (k + m + 2)) up to order k + m + 2 = 8; a third level
// in the same way.
TEST(Dop853Table, ResultFulfilsTheOrderConditionsOfBranchedTrees) {
  for (int m = 0; m <= 6; ++m) {
    Weights weights = kStages[kEndDerivative];
    for (std::size_t i = 0; i < kDerivatives; ++i) weights[i] *= std::pow(kNodes[i], m);
    const Weights second = throughStages(weights), third = throughStages(second);
    for (int k = 0; k + m + 2 <= 8; ++k)
      EXPECT_NEAR(sumOf(second, k), 1.0 / ((k + 1) * (k + m + 2)), 20 * kRounding) << m << " " << k;
    for (int k = 0; k + m + 3 <= 8; ++k)
      EXPECT_NEAR(sumOf(third, k), 1.0 / ((k + 1) * (k + 2) * (k + m + 3)), 400 * kRounding) << m << " " << k;
  }
}

// Differences between the result and formulas of order 5 and 3: they vanish on polynomials below, not above.
TEST(Dop853Table, ErrorEstimatesVanishUpToTheirOrder) {
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(sumOf(kErrors[0], k), 0, kRounding * 6) << k;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sumOf(kErrors[1], k), 0, kRounding * 6) << k;
  EXPECT_GT(std::abs(sumOf(kErrors[0], 5)), 1e-5);
  EXPECT_GT(std::abs(sumOf(kErrors[1], 3)), 1e-3);
}

// y' = (k + 1) t^k from 0 to 1, y = t^(k + 1), less the Hermite cubic through y(0) = 0, y(1) = 1, y'(0), y'(1), is what
// the corrections must say. Polynomials up to degree 7.
TEST(Dop853Table, CorrectionsMakePolynomialsOfDegreeSevenExact) {
  for (int degree = 2; degree <= 7; ++degree) {
    std::array<double, 4> c;
    for (std::size_t row = 0; row < 4; ++row) c[row] = degree * sumOf(kCorrections[row], degree - 1);
    for (const double s : {0.1, 0.35, 0.5, 0.8}) {
      const double r = 1 - s, cubic = s * s * (1 + 2 * r) - s * s * r * degree;
      const double value = cubic + s * s * r * r * (c[0] + s * (c[1] + r * (c[2] + s * c[3])));
      // Weights up to 530, times the degree.
      EXPECT_NEAR(value, std::pow(s, degree), 530 * 7 * 1e-16) << degree << " " << s;
    }
  }
}

}  // namespace
}  // namespace cradle::dop853_table
