#pragma once

#include <vector>

#include "impact/contact_impulse.h"

namespace cradle {

/// How contacts answer to each other's impulses, with what ties the bodies: components (t1, t2, n) of each in turn.
class ContactResponse {
 public:
  ContactResponse(const std::vector<Contact>& contacts, const ImpulseResponse& response, const VectorX& state);

  /// Velocities of B relative to A for velocities in `velocities`, or accelerations for accelerations.
  VectorX relative(const VectorX& velocities) const;

  /// Adds to velocities what impulses (N s, on B) give, or to accelerations what forces (N) do.
  void apply(const VectorX& impulses, VectorX& velocities) const;

  const MatrixX& inverseMass() const { return inverseMass_; }  // 1/kg: impulses to relative velocities

  /// The force, or impulse, on B of one contact in the world's axes.
  Vec3 vectorOf(std::size_t contact, const VectorX& impulses) const;

 private:
  const std::vector<Contact>& contacts_;
  const VectorX& places_;
  std::vector<Mat3> frames_;  // columns t1, t2, n
  std::vector<VectorX> answers_;
  MatrixX inverseMass_;
};

}  // namespace cradle
