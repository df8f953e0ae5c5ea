#pragma once

#include <vector>

#include "impact/contact_impulse.h"

namespace cradle {

/// World from the axes (t1, t2, n) of a contact: a rotation with the contact's normal as its third column.
Mat3 contactAxes(const Vec3& normal);

/// The Delassus operator of contacts of bodies that may have constraints, dense: impulses (on B) and velocities (of B
/// relative to A) by components (t1, t2, n).
class ContactDelassus {
 public:
  /// `response` must be ready for the positions in `state`.
  ContactDelassus(const std::vector<Contact>& contacts, const ImpulseResponse& response, const VectorX& state);

  /// In 1/kg.
  const MatrixX& matrix() const { return delassus_.matrix(); }

  /// Whether the bodies' constraints let a contact neither open nor close.
  bool isImmobile(std::size_t contact) const {
    return delassus_.isImmobile(3 * static_cast<Eigen::Index>(contact) + 2);
  }

  /// Ratio of the inverse mass along a contact's normal to that without constraints: about (arm / size)^2 where a joint
  /// holds the body near the contact.
  double mobility(std::size_t contact) const;

  /// Velocities (m/s) of all contacts, of bodies at the places of the start that move as in `velocities`, a state.
  VectorX velocitiesIn(const VectorX& velocities) const { return delassus_.velocities(velocities); }

  /// An impulse's components (N s) in the world's axes.
  Vec3 worldImpulse(std::size_t contact, const VectorX& impulses) const {
    return axes_[contact] * impulses.segment<3>(3 * static_cast<Eigen::Index>(contact));
  }

  /// Adds to the velocities in `state` what the impulses give.
  void apply(const VectorX& impulses, VectorX& state) const { delassus_.apply(impulses, state); }

 private:
  std::vector<Mat3> axes_;
  DenseDelassus delassus_;
};

}  // namespace cradle
