#pragma once

#include <vector>

#include "impact/delassus_operator.h"

namespace cradle {

/// Impulses and velocities of contacts, components (t1, t2, n) each; n > 0 pushes apart and separates.
struct ContactSolution {
  VectorX impulses;
  VectorX velocities;     // of the contacts: G impulses + g
  double residual = 0;    // in units of the velocities: the most that any contact is off Coulomb's law
  bool converged = true;  // the residual is what was asked for
  long iterations = 0;    // of ADMM and of the interior point method
};

/// A warm start: where an iteration begins, and where it ended: impulses (N s) and velocities (m/s) of the contacts by
/// components (t1, t2, n), De Saxce's correction included, and the penalty (in scaled units; 0: none known).
struct WarmStart {
  VectorX impulses, velocities;
  double penalty = 0;
};

/// The frictional contact problem (V. Acary, B. Brogliato, "Numerical Methods for Nonsmooth Dynamical Systems", 2008):
/// z in Coulomb's cones |z_t| <= friction z_n with u = G z + g, u_n >= 0, u_n z_n = 0, and friction opposing u_t
/// (maximum dissipation). G is the Delassus operator W = J M^-1 J^T of the contacts, symmetric
/// positive semi-definite, and often singular: contacts may be redundant, z is
/// then one of many. Impulses and velocities, or forces and accelerations: only their ratio G counts. The result does
/// not depend on the units, and on the order of contacts only by rounding. Not every problem has a solution (what is
/// wedged and cannot move), and none is always found: see `converged`, which asks for a residual of rounding, or 1e-12
/// of the largest velocity. One contact takes a microsecond, a box on its four corners about 20, n contacts O(n^3).
/// `near` may hold the impulses of a problem much like this one, from which a few steps of Newton's method are tried
/// first.
ContactSolution solveFrictionalContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                       const VectorX& near = {});

/// The same for contacts some of which slide already: forces and accelerations, in place of impulses and velocities.
/// Those with a direction that is not zero, of unit length, have the friction z_t = -friction z_n direction; the others
/// obey Coulomb's law. Newton's method from the forces `near`: from those that are as symmetric as the problem it leads
/// to such a solution, where friction has several. Not converged where there is none (friction jams, P. Painleve,
/// 1895), or where `near` is too far from it.
ContactSolution solveSlidingContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                    const std::vector<Eigen::Vector2d>& directions, const VectorX& near);

/// One of both, the former without `directions`, for the contacts of one face, which share its load as those do that
/// give way equally: with forces that follow loads without a jump, and stick as long as any can hold them. Where such a
/// solution is not found, as above. Without `near` it is sought from forces that keep all contacts closed, and all that
/// stick where they are.
ContactSolution solveSharedContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                   const std::vector<Eigen::Vector2d>& directions, const VectorX& near);

/// The same problem of any form of G, to a residual of `tolerance` (m/s), or of ten times that where the first methods
/// fail; if nothing leads there, the best that was found. Leaves in `start` where it ended.
ContactSolution solveFrictionalContact(const DelassusOperator& G, const VectorX& g,
                                       const std::vector<double>& frictions, double tolerance, WarmStart& start);

}  // namespace cradle
