#pragma once

#include "impact/contact_admm.h"
#include "impact/delassus_operator.h"

namespace cradle {

/// Impulses near a solution of the frictional contact problem by an interior point method: it needs about twenty
/// factorisations whether contacts are redundant or not, bodies light or heavy, and comes to about 1e-8 of the
/// velocities where friction does not couple too strongly. Stops where no contact is off Coulomb's law by more than
/// `tolerance` (scaled velocity). Returns the number of iterations.
int solveByInteriorPoint(const ScaledContacts& cones, const DelassusOperator& op, double tolerance, VectorX& impulses);

}  // namespace cradle
