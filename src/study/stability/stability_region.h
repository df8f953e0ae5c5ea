#pragma once

#include <complex>
#include <string>
#include <vector>

#include "dynamics/integrators/step.h"

namespace cradle {

/// A textbook method with steps of one length, and what theory says of it.
struct FixedStepMethod {
  std::string name;   // among studyMethods()
  std::string title;  // in charts
  Integrator integrate;
  std::vector<double> stabilityPolynomial;  // R(z) of y' = lambda y, z = step x lambda, from z^0 on; empty: see below
};

/// Explicit Euler, semi-implicit Euler, RK4 and DOP853. Semi-implicit Euler treats positions and velocities each in its
/// own way, so that it has no such polynomial.
const std::vector<FixedStepMethod>& fixedStepMethods();
const FixedStepMethod& fixedStepMethod(const std::string& name);

/// Growth of y' = lambda y in a step: |R(z)|. The method needs a polynomial.
double growthOf(const FixedStepMethod& method, std::complex<double> z);

/// Growth in a step of the amplitude of x'' = -omega^2 x - 2 dampingRatio omega x', with stepOmega = step x omega: the
/// largest modulus of the eigenvalues of what the step does to (x, x').
double oscillatorGrowth(const FixedStepMethod& method, double stepOmega, double dampingRatio);

/// The least stepOmega at which that amplitude begins to grow, to 1e-10; 0 if it does at any step.
double oscillatorLimit(const FixedStepMethod& method, double dampingRatio);

/// The least h |lambda| at which decay, y' = -|lambda| y, begins to grow.
double decayLimit(const FixedStepMethod& method);

}  // namespace cradle
