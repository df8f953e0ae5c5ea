#pragma once

#include <vector>

#include "constraints/dense_delassus.h"
#include "impact/frictional_contact.h"
#include "simulate/events/contact_record.h"
#include "simulate/island_state.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {

/// Forces and accelerations that keep Coulomb's law, but for an error of the friction of sliding contacts.
struct SlidingSolution : ContactSolution {
  double frictionError = 0;  // m/s^2: what friction lacks of that of the normal forces; large where friction jams
};

/// Whether contacts share their loads: those of faces that lie on each other without a loop (joinWithoutLoop).
bool shareLoads(const std::vector<const ContactRecord*>& records, const IslandState& island);

/// Forces (N) and relative accelerations of contacts by Coulomb's law, components (t1, t2, n) each, for bodies that
/// have the accelerations in `derivative` without them. A contact that slides has the friction -mu lambda_n d, d its
/// direction of sliding; those that slip have dynamic friction, and the others static friction. With
/// `sharesLoads` they share those as rows of active contacts do (shareLoads).
SlidingSolution solveContactForces(const std::vector<const ContactRecord*>& records,
                                   const std::vector<ContactRows>& rows, const DenseDelassus& delassus,
                                   const VectorX& derivative, bool sharesLoads);

}  // namespace cradle
