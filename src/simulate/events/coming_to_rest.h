#pragma once

#include <optional>
#include <vector>

#include "constraints/constraint_forces.h"
#include "constraints/disjoint_sets.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/island_state.h"
#include "simulate/limit_events.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {

/// Rest at events. Bodies that are still, and that forces within the friction cones keep so, are put to rest with all
/// that they touch or are joined to; nothing is computed for them until an impact or a push wakes them.
class ComingToRest {
 public:
  /// Keeps references to all; `constraints` must be factorised for the island's state at each call.
  ComingToRest(IslandState& island, const LimitEvents& limits, ConstraintSolver& constraints,
               const EventTolerances& tolerances)
      : island_(island), limits_(limits), constraints_(constraints), tolerances_(tolerances) {}

  /// Whether a body that does not rest is still.
  bool isAnySlow() const;

  /// Puts groups of bodies to rest that are still and in equilibrium; wakes the others.
  void letSleep(const std::vector<Contact>& touching);

  /// Wakes the bodies of a contact that an impact has set in motion, with all that rest with them.
  void wakeStruck(const Contact& contact);

 private:
  double sizeOf(std::size_t body) const;  // m: its radius, or that of gyration if it does not collide
  bool isSlow(std::size_t body) const;
  DisjointSets findRestGroups(const std::vector<Contact>& touching) const;
  struct Group {
    int number;
    const std::vector<int>& bodies;
    const std::vector<std::size_t>& contacts;  // of those that touch
  };
  /// What bodies do without contacts, in the state and with the motors that the island has now.
  struct FreeMotion {
    VectorX derivative;
    std::vector<BodyFrame> frames;
  };
  FreeMotion freeMotion() const;
  bool pushTowardsTargets(const DisjointSets& groups, int group);
  std::optional<std::vector<SupportForce>> findEquilibrium(const std::vector<Contact>& touching,
                                                           const DisjointSets& groups, const Group& group,
                                                           FreeMotion& motion);
  bool doLimitsHold(const std::vector<ContactRows>& contacts, const VectorX& impulses,
                    const std::vector<BodyFrame>& frames, const DisjointSets& groups, int group);
  bool isInEquilibrium(const VectorX& derivative, const Group& group, double most) const;

  IslandState& island_;
  const LimitEvents& limits_;
  ConstraintSolver& constraints_;
  const EventTolerances& tolerances_;
};

}  // namespace cradle
