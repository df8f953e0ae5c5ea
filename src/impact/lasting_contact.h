#pragma once

#include <vector>

#include "impact/contact_impulse.h"

namespace cradle {

/// A contact that lasts: what pushes and holds it.
struct LastingContact {
  Contact contact;
  double friction = 0;          // static if it sticks, dynamic if it slides
  Vec3 impulse = Vec3::Zero();  // N s, world, on B
};

/// Impulses within Coulomb's cone that stop all closing and hold what friction can hold, by projected Gauss-Seidel
/// (M. Jean, J. J. Moreau, 1987). Applied to the velocities of `state`. Returns the largest relative velocity that the
/// last sweep still changed, in m/s: how far it is from converged. O(sweeps x contacts).
double solveLastingContacts(std::vector<LastingContact>& contacts, const ImpulseResponse& response, VectorX& state);

/// Moves bodies apart until no contact overlaps, in the ratio of their inverse masses at the contact, with what ties
/// them. Positions only.
void resolveOverlaps(const ContactGeometry& geometry, const std::vector<Contact>& contacts,
                     const ImpulseResponse& response, VectorX& state);

}  // namespace cradle
