#pragma once

#include <vector>

#include "impact/pairwise.h"
#include "simulate/events/active_contacts.h"
#include "simulate/events/impact_sequence.h"
#include "simulate/island_state.h"
#include "simulate/plan/disjoint_sets.h"
#include "simulate/rope_events.h"

namespace cradle {

/// What a contact of a sequence of impacts got in all.
struct ContactImpulse {
  std::size_t contact = 0;  // of ImpactSequence::contacts()
  double impulse = 0;       // N s, along the normal
};

/// What happens where bodies touch at an event: impacts rebound, what forces hold comes to rest, and what they press
/// together lasts.
class EventContacts {
 public:
  /// Keeps references to both. `accuracy` is the scene's. A trial is made where contacts had to be resolved otherwise.
  EventContacts(IslandState& island, RopeEvents& ropes, double accuracy, bool isTrial);

  /// What touches as the island's step begins.
  TouchingFeatures touching();

  ActiveContacts& active() { return active_; }

  /// Why contacts cannot last as rows, if they can't; else empty.
  std::string_view fallbackReason() const { return active_.fallbackReason(); }
  const std::vector<int>& fallbackBodies() const { return active_.fallbackBodies(); }
  std::vector<int> sceneBodies() const { return active_.sceneBodies(); }

  /// Farther apart (m) nothing is looked at.
  double margin() const { return reach_; }

  /// Nearer (m) is touching.
  double touchTolerance() const { return touchTolerance_; }

  /// Contacts in the island's state now: changes its velocities. `change` is what happens to an active one, if
  /// anything does; `closingPair` the pair that comes together.
  void resolve(const std::optional<ContactChange>& change = std::nullopt,
               const std::optional<std::size_t>& closingPair = std::nullopt);

  /// Notes as a reason to fall back to time stepping that a joint leaves what touches now hardly any lever, if one
  /// does.
  void noteShortMomentArms();

  /// Notes as a reason to fall back to time stepping why forces of active contacts grow without bound. False if there
  /// is no reason.
  bool noteUnboundedForces();

 private:
  void noteShortMomentArms(double lever);
  void findTouching(const std::optional<std::size_t>& closingPair);
  void findNear(const std::optional<std::size_t>& closingPair);
  void collide(const std::optional<std::size_t>& closingPair);
  std::vector<Contact> contactsInReach();
  bool isOfSphere(const Contact& contact) const;
  SequenceLimits limitsOf(const std::vector<Contact>& near, double stillSpeed);
  DisjointSets connect(const std::vector<Contact>& contacts) const;
  void strike(const ImpactSequence& sequence, double still, std::vector<ContactImpulse>& impulses);
  void strike(const DisjointSets& together, int group, const ImpactSequence& sequence,
              std::vector<ImpactContact>& ropes, std::vector<ContactImpulse>& impulses);
  void resolveImpact(std::vector<ImpactContact>& impacts);
  bool endZenoSequence(const VectorX& approach, std::vector<ImpactContact>& impacts);
  void wakeStruck(const Contact& contact);
  void letSleep();
  DisjointSets findRestGroups() const;
  bool isAnySlow() const;
  bool isSlow(std::size_t body) const;
  bool canBeInEquilibrium(const DisjointSets& groups, int group);
  bool isInEquilibrium(const DisjointSets& groups, int group, double most) const;
  void project();
  void recordRests(const std::vector<char>& restedBefore);

  IslandState& island_;
  RopeEvents& ropes_;
  double size_;                       // m: of the smallest body
  double touchTolerance_, deadBand_;  // m
  double reach_;                      // m: of the contacts that may take part in a sequence of impacts
  ActiveContacts active_;
  ConstraintSolver solver_;
  double stillPart_;       // of the speed that a body gains when it falls by its size: slower is still; and of gravity:
                           // what forces may leave of bodies at rest at the most
  double shortMomentArm_;  // sizes of a body: contacts do not serve that a joint leaves less
  double zenoTime_ = 0;    // s: how long the bounces that are left out would take
  std::vector<Contact> touching_;
  std::vector<BodyFrame> frames_;
  VectorX derivative_;
};

}  // namespace cradle
