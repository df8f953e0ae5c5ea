#pragma once

#include <optional>
#include <vector>

#include "sampling/bump_changes.h"
#include "scene/scene.h"
#include "simulate/assembly.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// How far a motion was from a wish.
struct WishOutcome {
  double distance = 0;  // rad of UpWish, else m; >= 0
  /// Whether it is strictly met: a direction is within 45 degrees of up (of a box the face on top), a centre of mass is
  /// in the box, bodies touched each other.
  bool isMet = false;
};

/// Looks at a motion as it is simulated, and tells what came of the wishes of its scene.
class WishWatch {
 public:
  /// Throws Error(scene) if a contact is wished of bodies that can have none. Keeps a reference to `scene`, which has
  /// passed refuseUnsupported.
  explicit WishWatch(const Scene& scene);

  /// Frames in order of time.
  void note(const Frame& frame);
  void note(const Event& event);
  void note(const LastingContact& contact) { noteContact(contact.bodyA, contact.bodyB); }

  /// One a wish, of the frames nearest to their times.
  const std::vector<WishOutcome>& outcomes() const { return outcomes_; }

  /// Whether it is to be told of lasting contacts.
  bool asksForContacts() const;

 private:
  struct ContactSearch {
    std::size_t wish = 0;
    ColliderPair pair;
  };
  ContactSearch searchFor(std::size_t wish, const ContactWish& contact) const;
  void noteContact(int bodyA, int bodyB);
  void noteGap(const ContactSearch& search, const VectorX& state);
  const BodyState& stateOfBody(const Frame& frame, int body) const;
  double distanceOf(const Wish& wish, const Frame& frame) const;

  const Scene& scene_;
  Assembly assembly_;
  std::vector<ContactSearch> searches_;
  std::vector<WishOutcome> outcomes_;
  std::vector<double> timeErrors_;  // s: how far the frame of each outcome is from the time of its wish
};

/// Log of the weight of a motion among those of its scene: minus half the sum of squares of distances, in deviations.
double logLikelihood(const std::vector<Wish>& wishes, const std::vector<WishOutcome>& outcomes);

/// What came of the wishes of a scene that was simulated for them alone.
struct WishedMotion {
  std::vector<WishOutcome> outcomes;
  double logLikelihood = 0;  // -infinity if the run became unstable: it cannot be, and meets nothing
  ImpactCounts impacts = {};
};

/// Those of a motion that is none.
std::vector<WishOutcome> unmet(std::size_t wishes);

/// Simulates a scene that has passed refuseUnsupported. Throws what simulating throws, but Error(unstable).
WishedMotion simulateWishes(const Scene& scene);

bool areAllMet(const std::vector<WishOutcome>& outcomes);

}  // namespace cradle
