#pragma once

#include <vector>

#include "impact/contact_impulse.h"

namespace cradle {

/// World from the axes (t1, t2, n) of a contact: a rotation with the contact's normal as its third column.
Mat3 contactAxes(const Vec3& normal);

/// Contacts as a frictional contact problem (frictional_contact.h): impulses and velocities by components (t1, t2, n),
/// and the dense Delassus operator between them, in which the bodies' constraints take part. O(contacts^2 + contacts x
/// bodies).
class DenseContactProblem {
 public:
  /// `response` must be ready for the positions in `state`. Keeps a reference to `contacts`.
  DenseContactProblem(const std::vector<Contact>& contacts, const ImpulseResponse& response, const VectorX& state);

  /// The Delassus operator, in 1/kg.
  const MatrixX& delassus() const { return delassus_; }

  /// Whether the bodies' constraints let a contact neither open nor close.
  bool isImmobile(std::size_t contact) const { return isImmobile_[contact] != 0; }

  /// The inverse mass along a contact's normal in parts of what it were without constraints: about (arm / size)^2 where
  /// a joint holds the body near the contact.
  double leverage(std::size_t contact) const { return leverages_[contact]; }

  /// Velocities (m/s) of all contacts, of bodies at the places of the start that move as in `velocities`, a state.
  VectorX velocitiesIn(const VectorX& velocities) const;

  /// An impulse's components (N s) in the world's axes.
  Vec3 worldImpulse(std::size_t contact, const VectorX& impulses) const {
    return axes_[contact] * impulses.segment<3>(3 * static_cast<Eigen::Index>(contact));
  }

  /// Adds to the velocities in `state` what the impulses give.
  void apply(const VectorX& impulses, VectorX& state) const;

 private:
  const std::vector<Contact>& contacts_;
  VectorX places_;
  std::vector<Mat3> axes_;
  std::vector<VectorX> impulseResponses_;  // velocities that a unit impulse gives, three for each contact
  MatrixX delassus_;
  std::vector<char> isImmobile_;
  std::vector<double> leverages_;
};

}  // namespace cradle
