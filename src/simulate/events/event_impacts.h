#pragma once

#include <optional>
#include <vector>

#include "constraints/disjoint_sets.h"
#include "impact/frictional_impact.h"
#include "impact/pairwise.h"
#include "simulate/events/coming_to_rest.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/events/impact_sequence.h"
#include "simulate/events/known_gaps.h"
#include "simulate/events/touching_contacts.h"
#include "simulate/island_state.h"
#include "simulate/limit_events.h"

namespace cradle {

/// Impacts at an event: contacts that close rebound, and so do contacts that these make close, in the order of their
/// gaps. Ropes at their length take part.
class EventImpacts {
 public:
  /// Keeps references to all five. `constraints` must be factorised for the island's state at each call, and is so
  /// after it.
  EventImpacts(IslandState& island, LimitEvents& ropes, ConstraintSolver& constraints, ComingToRest& rest,
               const EventTolerances& tolerances)
      : island_(island),
        ropes_(ropes),
        constraints_(constraints),
        rest_(rest),
        tolerances_(tolerances),
        knownGaps_(island, tolerances) {}

  /// Resolves the impacts of the contacts in `touching`; `closingPair` is the pair whose gap an event has closed.
  /// Changes velocities of the island's state, and by rounding positions; wakes struck bodies, records impacts and
  /// books their energy. Leaves in `touching` the contacts that touch after that and do not close. Returns the Zeno
  /// time (s): how long the rebounds that were left out would take.
  double resolve(const std::optional<std::size_t>& closingPair, std::vector<Contact>& touching);

  /// The next gap to close that is too small to be seen, if impacts have left any.
  std::optional<KnownGaps::Closing> nextHidden() const { return knownGaps_.nextHidden(); }

 private:
  /// The impulse of a contact in all impacts of a sequence.
  struct ContactImpulse {
    std::size_t contact = 0;  // of ImpactSequence::contacts()
    double impulse = 0;       // N s, along the normal
  };
  static void addImpulse(std::size_t contact, double impulse, std::vector<ContactImpulse>& impulses);
  std::vector<Contact> contactsInReach(const std::vector<Contact>& touching);
  bool isOfSphere(const Contact& contact) const;
  bool isApart(const Contact& contact, const SequenceLimits& limits) const;
  void useKnownGaps(const std::vector<Contact>& near, SequenceLimits& limits) const;
  SequenceLimits limitsOf(const std::vector<Contact>& near, double stillSpeed);
  DisjointSets findImpactIslands(const std::vector<Contact>& contacts) const;
  double resolveNext(const ImpactSequence& sequence, double still, std::vector<ContactImpulse>& impulses);
  double resolveIsland(const DisjointSets& islands, int island, const ImpactSequence& sequence, double still,
                       std::vector<ImpactContact>& ropes, std::vector<ContactImpulse>& impulses);
  double resolveWithBumps(std::size_t contacts, std::vector<ImpactContact>& impacts, double still);
  double resolveImpact(std::vector<ImpactContact>& impacts, double still);
  bool resolveByThoseThatClose(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, double still,
                               ImpactFaults& faults);
  void requireRoom(const VectorX& approach, const std::vector<ImpactContact>& impacts, std::size_t contacts) const;
  double endZenoSequence(const VectorX& approach, std::vector<ImpactContact>& impacts);

  IslandState& island_;
  LimitEvents& ropes_;
  ConstraintSolver& constraints_;
  ComingToRest& rest_;
  const EventTolerances& tolerances_;
  KnownGaps knownGaps_;  // after the last impacts
};

}  // namespace cradle
