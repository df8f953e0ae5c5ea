#pragma once

#include <functional>
#include <vector>

#include "impact/contact_admm.h"

namespace cradle {

/// What an interior point method asks of a scaled frictional contact problem.
struct ContactOperator {
  /// G z + free.
  std::function<void(const VectorX& z, VectorX& u)> multiply;
  /// du with du = G (c - H du): `scalingBlocks` are H by contact, `c` impulses. May be factorised anew or, for the same
  /// H, kept.
  std::function<void(const std::vector<Mat3>& scalingBlocks, bool isNew, const VectorX& c, VectorX& du)> respond;
};

/// Impulses near a solution of the frictional contact problem by an interior point method: it needs about twenty
/// factorisations whether contacts are redundant or not, bodies light or heavy, and comes to about 1e-8 of the
/// velocities where friction does not couple too strongly. Stops where no contact is off Coulomb's law by more than
/// `tolerance` (scaled velocity). Returns the number of iterations.
int solveByInteriorPoint(const ScaledContacts& cones, const ContactOperator& op, double tolerance, VectorX& impulses);

}  // namespace cradle
