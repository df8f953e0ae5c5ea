#pragma once

#include <vector>

#include "math/types.h"

namespace cradle {

/// Impulses and velocities of contacts, components (t1, t2, n) each; n > 0 pushes apart and separates.
struct ContactSolution {
  VectorX impulses;
  VectorX velocities;     // of the contacts: G impulses + g
  double residual = 0;    // in units of the velocities: the most that any contact is off Coulomb's law
  bool converged = true;  // the residual is rounding, or 1e-12 of the largest velocity
};

/// The frictional contact problem (V. Acary, B. Brogliato, "Numerical Methods for Nonsmooth Dynamical Systems", 2008):
/// z in Coulomb's cones |z_t| <= friction z_n with u = G z + g, u_n >= 0, u_n z_n = 0, and friction opposing u_t
/// (maximum dissipation). G is the Delassus operator W = J M^-1 J^T of the contacts, symmetric
/// positive semi-definite, and often singular: contacts may be redundant, z is
/// then one of many. Impulses and velocities, or forces and accelerations: only their ratio G counts. The result does
/// not depend on the units, and on the order of contacts only by rounding. Not every problem has a solution (what is
/// wedged and cannot move), and none is always found: see `converged`. One contact takes a microsecond, a box on its
/// four corners about 20, n contacts O(n^3). A warm start: `near` may hold the impulses of a problem much like this
/// one, from which a few steps of Newton's method are tried first.
ContactSolution solveFrictionalContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                       const VectorX& near = {});

}  // namespace cradle
