#pragma once

#include "dynamics/integrators/stages.h"

// The coefficients of DOPRI5: J. R. Dormand, P. J. Prince, "A family of embedded Runge-Kutta formulae", J. Comp. Appl.
// Math. 6, 1980; the interpolant by L. F. Shampine, 1986 (E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary
// Differential Equations I", 2nd ed., II.5 and II.6). A test holds them against the order conditions.

namespace cradle::dormand_prince5_table {

constexpr std::size_t kDerivatives = 7;  // f at 6 stages, and at the end of the step
constexpr std::size_t kEndDerivative = 6;

using Weights = DerivativeWeights<kDerivatives>;

/// Instant of each derivative, as a fraction of the step.
inline constexpr Weights kNodes = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};

/// Row i: the state at which derivative i is evaluated is the start state + h x the weighted sum of the derivatives
/// before it. Row kEndDerivative is the result of the step.
inline constexpr std::array<Weights, kDerivatives> kStages = {
    Weights{},
    Weights{1.0 / 5},
    Weights{3.0 / 40, 9.0 / 40},
    Weights{44.0 / 45, -56.0 / 15, 32.0 / 9},
    Weights{19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    Weights{9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    Weights{35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};

/// The result less that of the embedded formula of order 4, divided by h.
inline constexpr std::array<Weights, 1> kErrors = {
    Weights{71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40}};

/// What the interpolant adds to the cubic Hermite curve (Step::corrections), divided by h.
inline constexpr std::array<Weights, 1> kCorrections = {
    Weights{-12715105075.0 / 11282082432, 0, 87487479700.0 / 32700410799, -10690763975.0 / 1880347072,
            701980252875.0 / 199316789632, -1453857185.0 / 822651844, 69997945.0 / 29380423}};

}  // namespace cradle::dormand_prince5_table
