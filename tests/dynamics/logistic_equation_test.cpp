#include <gtest/gtest.h>

#include <array>

#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"

// y' = 6 y - 0.007 y^2 from y = 10 in steps of 0.5: small enough for a calculator. The expected values are exact
// rationals, rounded to 20 digits. At the equilibrium 6000/7 the slope is -6, so that h x slope = -3 is beyond the
// limits of both methods, 2 and 2.785.

namespace cradle {
namespace {

constexpr double kTimeStep = 0.5;
constexpr double kEquilibrium = 6000.0 / 7;

/// The equation, which notes every rate that a method asks for.
RightHandSide logistic(std::vector<double>* rates = nullptr) {
  return {[rates](double, const VectorX& y, VectorX& rate) {
            rate = VectorX::Constant(1, 6 * y[0] - 0.007 * y[0] * y[0]);
            if (rates) rates->push_back(rate[0]);
          },
          nullptr, 0};
}

std::vector<double> stepsOf(Integrator integrate, double start, int count) {
  const RightHandSide rightHandSide = logistic();
  Step step;
  std::vector<double> values = {start};
  for (int i = 0; i < count; ++i) {
    integrate(rightHandSide, VectorX::Constant(1, values.back()), i * kTimeStep, kTimeStep, step);
    values.push_back(step.state[0]);
  }
  return values;
}

// One evaluation rounds terms below 3600 + 3600 at most: 4 x 2^-53 x 3600 = 1.6e-12 if y were 857, and a hundredth of
// that at the values below 142 of the first step. A stage passes the error of the one before on by h |f'| <= 3.
constexpr double kOneStepRounding = 1e-12;
// Each step multiplies what the ones before left: by at most 1 + h f'(0) = 4 for Euler, R(3) = 16.4 for RK4 while y is
// small and by less than 2 near the end. Steps 2 and 3 add a few 1e-13 each: 16 x 16 x 1e-13 at most.
constexpr double kSixStepsRounding = 1e-10;

TEST(LogisticEquation, ExplicitEulersFirstStepIsThatOfPencilAndPaper) {
  EXPECT_NEAR(stepsOf(explicitEuler, 10, 1)[1], 793.0 / 20, kOneStepRounding);
}

TEST(LogisticEquation, Rk4sFourRatesAndItsFirstStepAreThoseOfPencilAndPaper) {
  std::vector<double> rates;
  Step step;
  rk4(logistic(&rates), VectorX::Constant(1, 10), 0, kTimeStep, step);
  ASSERT_EQ(rates.size(), 4u);
  EXPECT_NEAR(rates[0], 59.3, kOneStepRounding);
  EXPECT_NEAR(rates[1], 144.636035625, kOneStepRounding);
  EXPECT_NEAR(rates[2], 262.0394747150491322509765625, kOneStepRounding);
  EXPECT_NEAR(rates[3], 706.912459874450928853386449959, kOneStepRounding);
  EXPECT_NEAR(step.state[0], 141.630290046212432779611631247, kOneStepRounding);
}

TEST(LogisticEquation, FurtherStepsOfBothMethodsAreTheirOwn) {
  constexpr std::array kEuler = {
      39.65, 153.09757125, 530.35425287072910703, 1136.9522940996739717, 23.497359693905505362, 92.05699808157530886};
  constexpr std::array kRk4 = {141.63029004621243278, 648.60187280154227887, 651.92165362429259892,
                               652.11412349679621478, 652.12788324384224344, 652.12887794826703559};
  const std::vector<double> euler = stepsOf(explicitEuler, 10, 6), rungeKutta = stepsOf(rk4, 10, 6);
  for (std::size_t i = 0; i < kEuler.size(); ++i) {
    EXPECT_NEAR(euler[i + 1], kEuler[i], kSixStepsRounding) << i;
    EXPECT_NEAR(rungeKutta[i + 1], kRk4[i], kSixStepsRounding) << i;
  }
}

// A step too long need not blow up: RK4 looks converged, at 652.13 instead of 857.14.
TEST(LogisticEquation, Rk4SettlesAtAValueThatIsNoSolution) {
  const std::vector<double> values = stepsOf(rk4, 10, 60);
  EXPECT_NEAR(values[60], 652.13, 0.005);
  EXPECT_NEAR(values[60], values[59], 1e-12 * values[60]);
  EXPECT_GT(6 * values[60] - 0.007 * values[60] * values[60], 900);  // where y' is far from 0
}

// From slightly beside the equilibrium both leave it, by the factors 1 + z = -2 and R(z) = 1.375 of z = -3 a step. The
// velocityProduct of y' adds 1e-6 x 0.007 h / 2, relative; rounding of 857, 1.1e-13, a few times, is 5e-7 of the
// offset.
TEST(LogisticEquation, BothMethodsLeaveTheEquilibriumAtThisStep) {
  const double offset = 1e-6;
  EXPECT_NEAR((stepsOf(explicitEuler, kEquilibrium + offset, 1)[1] - kEquilibrium) / offset, -2, 1e-6);
  EXPECT_NEAR((stepsOf(rk4, kEquilibrium + offset, 1)[1] - kEquilibrium) / offset, 1.375, 1e-6);
}

}  // namespace
}  // namespace cradle
