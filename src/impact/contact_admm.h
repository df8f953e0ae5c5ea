#pragma once

// The alternating direction method of multipliers (ADMM) on the frictional contact problem with De Saxce's correction:
// J. Carpentier, Q. Le Lidec, L. Montaut, "From compliant to rigid contact simulation: a unified and efficient
// approach", 2024.

#include <algorithm>
#include <vector>

#include "impact/friction_cone.h"
#include "math/types.h"

namespace cradle {

/// A frictional contact problem whose impulses and velocities are scaled so that each contact has about inverse mass 1:
/// light and heavy bodies then converge together.
struct ScaledContacts {
  VectorX free;                   // velocities without impulses
  std::vector<double> frictions;  // by contact
};

/// The state of the iteration: also its warm start, with the end of a similar problem.
struct AdmmIterate {
  VectorX impulses;    // y, in the cones
  VectorX velocities;  // z, in the duals of the cones, De Saxce's correction included
  VectorX unbounded;   // x, impulses outside the cones that give these velocities
  double penalty = 0;  // rho, a scaled inverse mass
  double primalResidual = 0, dualResidual = 0;
};

/// Iterates `count` times. `solveShifted(b)` replaces b by (G + (penalty + proximal) I)^-1 b. Changes no penalty.
template <class SolveShifted>
void iterateAdmm(const ScaledContacts& cones, double proximal, const SolveShifted& solveShifted, int count,
                 AdmmIterate& at) {
  const Eigen::Index contacts = std::ssize(cones.frictions);
  for (int k = 0; k < count; ++k) {
    at.unbounded = at.velocities - cones.free + at.penalty * at.impulses + proximal * at.unbounded;
    for (Eigen::Index i = 0; i < contacts; ++i) {
      const double friction = cones.frictions[static_cast<std::size_t>(i)];
      at.unbounded[3 * i + 2] -= friction * at.velocities.segment<2>(3 * i).norm();
    }
    solveShifted(at.unbounded);
    at.primalResidual = at.dualResidual = 0;
    for (Eigen::Index i = 0; i < contacts; ++i) {
      const double friction = cones.frictions[static_cast<std::size_t>(i)];
      const Vec3 x = at.unbounded.segment<3>(3 * i), before = at.impulses.segment<3>(3 * i);
      const Vec3 y = projectOnCone(x - at.velocities.segment<3>(3 * i) / at.penalty, friction);
      at.impulses.segment<3>(3 * i) = y;
      at.velocities.segment<3>(3 * i) -= at.penalty * (x - y);
      at.primalResidual = std::max(at.primalResidual, (x - y).cwiseAbs().maxCoeff());
      at.dualResidual = std::max(at.dualResidual, at.penalty * (y - before).cwiseAbs().maxCoeff());
    }
  }
}

/// The penalty with which both residuals fall together, from `least` to `largest` (S. Boyd et al., "Distributed
/// optimization and statistical learning via the alternating direction method of multipliers", 2011, section 3.4.1).
inline double balancedPenalty(const AdmmIterate& at, double least, double largest) {
  constexpr double kUnbalanced = 10;  // ratio of the residuals that is let be: the mu of (3.13) there
  constexpr double kChange = 4;       // of the penalty, the tau of (3.13), which has 2: a penalty may begin 1e4 off
  if (at.primalResidual > kUnbalanced * at.dualResidual) return std::min(kChange * at.penalty, largest);
  if (at.dualResidual > kUnbalanced * at.primalResidual) return std::max(at.penalty / kChange, least);
  return at.penalty;
}

}  // namespace cradle
