#pragma once

#include <vector>

#include "collision/separation.h"
#include "dynamics/constraint_forces.h"

namespace cradle {

/// The 3x3 matrix that maps an impulse on B (and its opposite on A) at the contact to the change of B's velocity
/// relative to A there, in 1/kg, for bodies that nothing ties.
Mat3 inverseMassAt(const Contact& contact, const std::vector<RigidBody>& bodies, const VectorX& state);

class ImpulseResponse;

/// Whether what ties the bodies holds a contact whose inverse mass along its normal is `inverseMass` (1/kg): it can
/// neither open nor close.
bool isImmobile(const Contact& contact, const ImpulseResponse& response, const VectorX& state, double inverseMass);

/// Whether joints leave a contact a lever of hardly more than `lever`, in sizes of its bodies: its normal goes by an
/// anchor so near that impulses there are 1 / lever times as large as those that the motion asks for.
bool hasShortLever(const Contact& contact, const ImpulseResponse& response, const VectorX& state, double lever);

/// Erases those that are immobile.
void eraseImmobile(const ImpulseResponse& response, const VectorX& state, std::vector<Contact>& contacts);

/// How bodies answer to impulses at contacts. What ties them answers within the same impulse: W = M^-1 - M^-1 B^T
/// (B M^-1 B^T)^-1 B M^-1 stands in place of M^-1, B the rows of their constraints.
class ImpulseResponse {
 public:
  /// Keeps a reference to `bodies`, which nothing ties.
  ImpulseResponse(const std::vector<RigidBody>& bodies) : bodies_(bodies) {}

  /// Keeps references to both. The solver must be factorised for the positions at which impulses are applied.
  ImpulseResponse(const std::vector<RigidBody>& bodies, ConstraintSolver& constraints)
      : bodies_(bodies), constraints_(constraints.hasConstraints() ? &constraints : nullptr) {}

  bool areTied() const { return constraints_ != nullptr; }

  /// As above, with what ties the bodies.
  Mat3 inverseMassAt(const Contact& contact, const VectorX& state) const;

  /// As above, as if nothing tied the bodies.
  Mat3 untiedInverseMassAt(const Contact& contact, const VectorX& state) const;

  /// Applies an impulse (N s, world) to B and its opposite to A at the contact.
  void apply(const Contact& contact, const Vec3& impulseOnB, VectorX& state) const;

  /// `state` with the velocities that such an impulse gives to bodies at rest.
  VectorX answerTo(const Contact& contact, const Vec3& impulseOnB, const VectorX& state) const;

 private:
  const std::vector<RigidBody>& bodies_;
  ConstraintSolver* constraints_ = nullptr;
};

}  // namespace cradle
