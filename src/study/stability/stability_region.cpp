// E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", IV.2: a Runge-Kutta method turns y' = lambda y
// into y1 = R(h lambda) y0. An oscillator's lambda are -zeta omega +- i omega sqrt(1 - zeta^2), both real beyond
// critical damping. What semi-implicit Euler does to (x, h x') is the matrix ((1 - z^2, 1 - 2 zeta z), (-z^2,
// 1 - 2 zeta z)), z = h omega, with the damper's force from the start of the step.

#include "study/stability/stability_region.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/dop853_table.h"
#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/semi_implicit_euler.h"

namespace cradle {
namespace {

constexpr double kLongest = 20;            // step x omega: beyond the limits of all methods
constexpr double kScan = 1e-3;             // of step x omega: gaps in stability that are narrower are not seen
constexpr double kGrowthRounding = 1e-12;  // of growth

/// R of DOP853 from its tableau: the stages of y' = lambda y are polynomials in z, Y_i = 1 + z sum_j a_ij Y_j.
std::vector<double> dop853Polynomial() {
  using dop853_table::kEndDerivative;
  std::vector<std::vector<double>> stages;
  for (std::size_t i = 0; i <= kEndDerivative; ++i) {
    std::vector<double> stage(kEndDerivative + 1, 0.0);
    stage[0] = 1;
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t power = 1; power <= kEndDerivative; ++power)
        stage[power] += dop853_table::kStages[i][j] * stages[j][power - 1];
    stages.push_back(stage);
  }
  return stages.back();
}

double semiImplicitGrowth(double z, double dampingRatio) {
  const double trace = 2 - z * z - 2 * dampingRatio * z, determinant = 1 - 2 * dampingRatio * z;
  const double discriminant = trace * trace / 4 - determinant;
  return discriminant < 0 ? std::sqrt(determinant) : std::abs(trace) / 2 + std::sqrt(discriminant);
}

/// The least z at which `growth` is above 1, found by steps and bisection; 0 if it is at once.
template <class Growth>
double limitOf(const Growth& growth) {
  const auto grows = [&](double z) { return growth(z) > 1 + kGrowthRounding; };
  double stable = 0, unstable = kScan;
  while (unstable < kLongest && !grows(unstable)) stable = unstable, unstable += kScan;
  if (stable == 0) return 0;
  while (unstable - stable > 1e-11) {
    const double middle = (stable + unstable) / 2;
    (grows(middle) ? unstable : stable) = middle;
  }
  return stable;
}

}  // namespace

const std::vector<FixedStepMethod>& fixedStepMethods() {
  static const std::vector<FixedStepMethod> methods = {
      {"explicitEuler", "explicit Euler", explicitEuler, {1, 1}},
      {"semiImplicitEuler", "semi-implicit Euler", semiImplicitEuler, {}},
      {"rk4", "RK4", rk4, {1, 1, 1.0 / 2, 1.0 / 6, 1.0 / 24}},
      {"dop853FixedStep", "DOP853, fixed step", dop853, dop853Polynomial()}};
  return methods;
}

const FixedStepMethod& fixedStepMethod(const std::string& name) {
  const auto& methods = fixedStepMethods();
  const auto found =
      std::find_if(methods.begin(), methods.end(), [&](const FixedStepMethod& method) { return method.name == name; });
  CRADLE_CHECK(found != methods.end());
  return *found;
}

double growthOf(const FixedStepMethod& method, std::complex<double> z) {
  CRADLE_CHECK(!method.stabilityPolynomial.empty());
  std::complex<double> value = 0;
  for (auto coefficient = method.stabilityPolynomial.rbegin(); coefficient != method.stabilityPolynomial.rend();
       ++coefficient)
    value = value * z + *coefficient;
  return std::abs(value);
}

double oscillatorGrowth(const FixedStepMethod& method, double stepOmega, double dampingRatio) {
  if (method.stabilityPolynomial.empty()) return semiImplicitGrowth(stepOmega, dampingRatio);
  const std::complex<double> root = std::sqrt(std::complex<double>(dampingRatio * dampingRatio - 1, 0));
  return std::max(growthOf(method, stepOmega * (-dampingRatio + root)),
                  growthOf(method, stepOmega * (-dampingRatio - root)));
}

double oscillatorLimit(const FixedStepMethod& method, double dampingRatio) {
  return limitOf([&](double z) { return oscillatorGrowth(method, z, dampingRatio); });
}

double decayLimit(const FixedStepMethod& method) {
  return limitOf([&](double z) { return growthOf(method, -z); });
}

}  // namespace cradle
