#pragma once

#include <vector>

#include "impact/pairwise.h"
#include "simulate/islands.h"
#include "simulate/moving_island.h"

namespace cradle {

/// What happens where bodies touch at an event: impacts rebound, and what forces hold comes to rest.
class EventContacts {
 public:
  /// Keeps a reference to `island`. `accuracy` is the scene's.
  EventContacts(MovingIsland& island, double accuracy);

  /// What touches as a step begins.
  TouchingFeatures touching() const;

  /// Farther apart (m) nothing is looked at.
  double margin() const { return touchTolerance_; }

  /// Contacts in the island's state now: changes its velocities.
  void resolve();

 private:
  void findTouching();
  void collide();
  Islands findStruckTogether() const;
  void resolveImpact(std::vector<ImpactContact>& impacts);
  bool endBounces(const VectorX& approach, std::vector<ImpactContact>& impacts);
  void wakeStruck();
  void settle();
  Islands findRestGroups() const;
  bool isSlow(std::size_t body) const;
  bool isHeld(const Islands& groups, int group);
  void recordRests(const std::vector<char>& restedBefore);

  MovingIsland& island_;
  ConstraintSolver solver_;
  double stillPart_;  // of the speed that a body gains when it falls by its size: slower is still
  double touchTolerance_, deadBand_;  // m
  double restDelay_ = 0;              // s: how long the bounces that are left out would take
  std::vector<Contact> touching_;
  VectorX rate_;
};

}  // namespace cradle
