#pragma once

#include <vector>

#include "constraints/constraint_forces.h"
#include "simulate/events/contact_record.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/events/previous_contacts.h"
#include "simulate/island_state.h"

namespace cradle {

/// The input of a classification.
struct ClassificationInput {
  const std::vector<Contact>& touching;          // at the island's state
  const std::vector<PreviousContact>& previous;  // active until now
  const std::vector<BodyFrame>& frames;          // of the island's state
  bool isReleasing = false;  // one of `previous` carries nothing any more, and symmetric ones with it
  const EventTolerances& tolerances;
};

/// Its result.
struct ClassifiedContacts {
  std::vector<ContactRecord> active;  // those that carry load, in the order of `touching`
  std::vector<ContactRecord> idle;    // those that carry none and do not open, in the same order
  ContactFallback fallback;           // why rows do not serve, if they don't
};

/// Which of the touching contacts carry load, and whether each sticks or slides: Coulomb's problem on accelerations,
/// for each group of bodies that contacts and constraints join (F. Pfeiffer, C. Glocker, "Multibody Dynamics with
/// Unilateral Contacts", 1996). Contacts between bodies that all rest, and contacts that open, are no part of it.
/// Contacts that slide already keep their direction, and their friction follows their normal forces. `constraints` must
/// be factorised for the island's state. Of `island`, the equations are evaluated and unsolved contacts are logged; its
/// state and its active contacts stay as they are.
ClassifiedContacts classifyContacts(const ClassificationInput& input, ConstraintSolver& constraints,
                                    IslandState& island);

}  // namespace cradle
