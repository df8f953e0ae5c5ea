#pragma once

#include <optional>
#include <vector>

#include "collision/time_of_impact.h"
#include "simulate/events/active_contacts.h"
#include "simulate/events/coming_to_rest.h"
#include "simulate/events/event_impacts.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/events/touching_contacts.h"
#include "simulate/island_state.h"
#include "simulate/limit_events.h"

namespace cradle {

/// Contacts at an event: contacts that close rebound, bodies in equilibrium come to rest, and contacts that forces
/// press together become active.
class EventContacts {
 public:
  /// Keeps references to all three. A trial is made where contacts had to be resolved by time stepping before.
  EventContacts(IslandState& island, LimitEvents& ropes, const EventTolerances& tolerances, bool isTrial);
  EventContacts(const EventContacts&) = delete;
  EventContacts& operator=(const EventContacts&) = delete;

  /// The active features and tolerances for the search for impacts in the island's step.
  TouchingFeatures touching();

  ActiveContacts& active() { return active_; }
  const ActiveContacts& active() const { return active_; }

  /// Why contacts cannot last as rows, if they can't; else empty.
  std::string_view fallbackReason() const { return active_.fallbackReason(); }
  const std::vector<int>& fallbackBodies() const { return active_.fallbackBodies(); }
  std::vector<int> sceneBodies() const { return active_.sceneBodies(); }

  /// Resolves the contacts of the island's state: impacts, then rest, then active contacts. Changes its velocities.
  /// `change` is what happens to an active contact, if anything does; `closingPair` the pair whose gap has closed.
  void resolve(const std::optional<ContactChange>& change = std::nullopt,
               const std::optional<std::size_t>& closingPair = std::nullopt);

  /// The next gap to close that is too small to be seen, if impacts have left any.
  std::optional<KnownGaps::Closing> nextHidden() const { return impacts_.nextHidden(); }

  /// Notes as a reason to fall back to time stepping that a joint leaves a touching contact hardly any moment arm, or
  /// less than `momentArm` (sizes of a body), if one does.
  void noteShortMomentArms();
  void noteShortMomentArms(double momentArm);

  /// Notes as a reason to fall back to time stepping why forces of active contacts grow without bound. False if there
  /// is no reason.
  bool noteUnboundedForces();

 private:
  void noteTippingImpacts(const std::vector<Contact>& met, const VectorX& before);
  void project();
  void recordRests(const std::vector<char>& restedBefore, double zenoTime);
  void recordLastingContacts();

  IslandState& island_;
  const EventTolerances& tolerances_;
  ConstraintSolver solver_;
  ActiveContacts active_;
  ComingToRest rest_;
  EventImpacts impacts_;
  std::vector<std::pair<int, int>> pressed_;  // scene bodies of active contacts, and of those of bodies at rest
  double shortMomentArm_;                     // sizes of a body: rows do not serve contacts that a joint leaves less
};

}  // namespace cradle
