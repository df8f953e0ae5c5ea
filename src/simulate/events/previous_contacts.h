#pragma once

#include <vector>

#include "simulate/events/contact_record.h"
#include "simulate/events/event_log.h"
#include "simulate/island_state.h"

namespace cradle {

/// A contact that was active until the event of now.
struct PreviousContact {
  ContactRecord record;
  ContactConstraint constraint;
  bool isSlipping = false;       // its friction gives way at this event ...
  Vec3 slipping = Vec3::Zero();  // ... and A will slide there; unit, world
};

/// The previous contact at the place of `record`, or null: the same pair, a normal within 2.6 degrees, and a point
/// within 1e-4 of a size. `frames` are those of the island's state.
const PreviousContact* previousAt(const ContactRecord& record, const std::vector<PreviousContact>& previous,
                                  const std::vector<BodyFrame>& frames, const IslandState& island);

/// Records the changes of contacts from before an event to after it: release, stick, roll or slip.
void recordContactEvents(const std::vector<PreviousContact>& previous, const std::vector<ContactRecord>& active,
                         const std::vector<BodyFrame>& frames, const IslandState& island, EventLog& log);

}  // namespace cradle
