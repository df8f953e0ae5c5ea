#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "collision/separation.h"
#include "constraints/equations_of_motion.h"
#include "simulate/steps/step_tolerances.h"

namespace cradle {

/// What a contact carries of bodies that rest.
struct SupportForce {
  Contact contact;
  ColliderPair pair;
  Vec3 force;  // N, world, on B
};

/// Bodies that lie still: nothing is computed for them until something touches them. Bodies come to rest together with
/// all that they touch or are joined to (their island), and wake together.
class RestingBodies {
 public:
  /// Keeps references to all three.
  RestingBodies(const Mechanism& mechanism, const ContactGeometry& geometry, EquationsOfMotion& equations);

  /// A body that was woken is not put to rest again for so long (s).
  void setStillTime(double stillTime) { stillTime_ = stillTime; }

  /// Brings islands to rest that are slow and that contact forces within the friction cones keep in equilibrium, given
  /// the contacts of this instant. Returns the bodies that came to rest.
  std::vector<int> letSleep(double time, const std::vector<Contact>& contacts, VectorX& state);

  /// Stops bodies that rest together from now on, as these contact forces keep them; what they still had of kinetic
  /// energy is numerical.
  void bringToRest(const std::vector<int>& bodies, VectorX& state, const std::vector<SupportForce>& supports = {});

  /// Of all bodies that rest; what is returned stays as it is when they wake.
  std::shared_ptr<const std::vector<SupportForce>> supports() const { return supports_; }

  /// Wakes the island of a body. Returns the bodies that were woken.
  std::vector<int> wake(double time, int body);

  /// Which bodies lie still, and what is known of the others.
  struct Record {
    std::vector<int> islands;       // of each body the first one that it rests with; -1: it does not rest
    std::vector<double> wakeTimes;  // s, of each body
    std::vector<SupportForce> supports;
  };
  Record record() const;

  /// Lets bodies rest as they did; none does now, and they stand still.
  void goOnFrom(const Record& record);

  bool allRest() const;
  bool anyRests() const;
  bool isResting(int body) const { return body != kFixed && equations_.isResting(static_cast<std::size_t>(body)); }

 private:
  std::vector<int> islandsOf(const std::vector<Contact>& contacts) const;
  bool isStill(double time, std::size_t body, const VectorX& state) const;
  bool isSlow(std::size_t body, const VectorX& state) const;
  std::vector<SupportForce> applySupportForces(const std::vector<Contact>& supports,
                                               const std::vector<double>& frictions, const VectorX& state,
                                               VectorX& accelerations);
  std::optional<std::vector<SupportForce>> findEquilibrium(double time, const std::vector<int>& islands, int island,
                                                           const VectorX& state);

  void setSupports(const std::vector<int>& bodies, const std::vector<SupportForce>& supports);

  const Mechanism& mechanism_;
  const ContactGeometry& geometry_;
  EquationsOfMotion& equations_;
  StepTolerances tolerances_;
  std::vector<double> sizes_;      // m: bounding radius of each moving body; radius of gyration if it does not collide
  double stillTime_ = 0;           // s
  std::vector<double> wakeTimes_;  // s, of each body's last waking
  std::vector<int> restingIsland_;
  std::shared_ptr<const std::vector<SupportForce>> supports_ = std::make_shared<std::vector<SupportForce>>();
};

}  // namespace cradle
