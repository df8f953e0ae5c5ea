#pragma once

#include <vector>

#include "collision/separation.h"
#include "constraints/contact_rows.h"

namespace cradle {

/// A contact as rows: where its surfaces are, and how they move relative to each other.
struct ContactRows {
  ContactConstraint constraint;
  ContactKinematics place;
  ConstraintBlock block;  // two rows along the surfaces, then the gap's
};

/// Surfaces that cannot last are taken as a corner on a face: good for one instant.
ContactRows rowsOf(const Contact& contact, const VectorX& state, const std::vector<BodyFrame>& frames);

/// The rows of a contact that lasts, where its bodies have come to `state`.
ContactRows rowsOf(const ContactConstraint& constraint, const VectorX& state, const std::vector<BodyFrame>& frames);

/// Whether a contact can last: its kinematics are those of a sphere or corner on a face, a corner or a sphere, of a
/// sphere on a straight line, of two lines that cross, or of a disc's rim on a face.
bool canLast(const Contact& contact);

/// Moves a contact of `before` with its bodies, which are at `state` now, where `frames` are theirs; its separation
/// stays. Returns the derivative (m/s^2, world) of B's velocity relative to A's there if the bodies kept theirs; zero
/// if the contact cannot last, and goes along with the mean of its bodies.
Vec3 followContact(const VectorX& before, const VectorX& state, const std::vector<BodyFrame>& frames, Contact& contact);

/// The rows of all, in turn.
std::vector<ConstraintBlock> blocksOf(const std::vector<ContactRows>& contacts);

}  // namespace cradle
