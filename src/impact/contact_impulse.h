#pragma once

#include <vector>

#include "collision/separation.h"
#include "constraints/dense_delassus.h"

namespace cradle {

/// The diagonal block of the Delassus operator of a contact, in 1/kg, for bodies without constraints: it maps an
/// impulse on B (and its opposite on A) to the change of B's velocity relative to A there.
Mat3 delassusAt(const Contact& contact, const std::vector<RigidBody>& bodies, const VectorX& state);

/// The rows of B's velocity relative to A's at a contact along one unit direction or three, the columns (world): their
/// multipliers are impulses on B.
ConstraintBlock rowsAlong(const Eigen::Ref<const Eigen::Matrix<double, 3, Eigen::Dynamic>>& directions,
                          const Contact& contact, const VectorX& state);

class ImpulseResponse;

/// Whether joints leave a contact a moment arm of no more than about `arm` sizes of its bodies: its normal passes an
/// anchor so closely that impulses at the contact are 1 / arm times as large as those that the motion asks for.
bool hasShortMomentArm(const Contact& contact, const ImpulseResponse& response, const VectorX& state, double arm);

/// Whether the bodies' constraints let a contact neither open nor close.
bool isImmobile(const Contact& contact, const ImpulseResponse& response, const VectorX& state);

/// Erases the contacts that are immobile.
void eraseImmobile(const ImpulseResponse& response, const VectorX& state, std::vector<Contact>& contacts);

/// The response of bodies to impulses at contacts. Constraints, with the Jacobian B, respond within the same impulse:
/// in place of the inverse mass matrix M^-1 stands W = M^-1 - M^-1 B^T (B M^-1 B^T)^-1 B M^-1.
class ImpulseResponse {
 public:
  /// Keeps a reference to `bodies`, which have no constraints.
  ImpulseResponse(const std::vector<RigidBody>& bodies) : bodies_(bodies) {}

  /// Keeps references to both. The solver must be factorised for the positions at which impulses are applied.
  ImpulseResponse(const std::vector<RigidBody>& bodies, ConstraintSolver& constraints)
      : bodies_(bodies), constraints_(constraints.hasConstraints() ? &constraints : nullptr) {}

  bool areConstrained() const { return constraints_ != nullptr; }

  /// As above, with the bodies' constraints.
  Mat3 delassusAt(const Contact& contact, const VectorX& state) const;

  /// As above, as if the bodies had no constraints.
  Mat3 unconstrainedDelassusAt(const Contact& contact, const VectorX& state) const;

  /// The Delassus operator of rows of bodies at their places in `state`.
  DenseDelassus delassusOf(std::vector<ConstraintBlock> blocks, const VectorX& state) const;

  /// Applies an impulse (N s, world) to B and its opposite to A at the contact.
  void apply(const Contact& contact, const Vec3& impulseOnB, VectorX& state) const;

  /// `state` with the velocities that such an impulse gives to bodies at rest.
  VectorX responseTo(const Contact& contact, const Vec3& impulseOnB, const VectorX& state) const;

 private:
  const std::vector<RigidBody>& bodies_;
  ConstraintSolver* constraints_ = nullptr;
};

}  // namespace cradle
