#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "collision/persistent_manifold.h"
#include "core/worker_threads.h"
#include "impact/soft_manifolds.h"
#include "impact/soft_scale.h"
#include "impact/swept_bounds.h"

namespace cradle {

/// The manifolds of all pairs that are near each other, kept from step to step.
class SoftContacts {
 public:
  /// Keeps a reference to `geometry`, whose pairs change from step to step.
  explicit SoftContacts(const ContactGeometry& geometry, const SoftScale& scale = {});

  /// To be called when geometry.pairs is a new list: manifolds of pairs that stay are kept.
  void takePairs();

  /// To be called before the first look of a step.
  void beginStep() {
    sweptBounds_.forget();
    inReach_.assign(pairs_.size(), 0);
  }

  /// The speed (m/s) at which bodies approach each other that may touch within the step, for how often they must be
  /// looked at: more than that between spheres.
  double fastestApproach(const SoftStepStart& look, WorkerThreads& threads) const;

  /// Contacts of now, and those that come about within the step or group of sub-steps. Pairs of bodies asleep stay as
  /// they are. Groups of sub-steps have the same length and margin.
  void update(const SoftStepStart& look, WorkerThreads& threads);

  std::vector<PersistentManifold>& manifolds() { return manifolds_; }
  const std::vector<PersistentManifold>& manifolds() const { return manifolds_; }
  /// The manifolds that have points and a body awake, in the order of pairs.
  const std::vector<ManifoldLink>& active() const { return active_; }

  /// Contacts among them that were not pressed in the step before and close faster than `slowest` (m/s), as pairs of
  /// colliders.
  struct Meeting {
    ColliderPair pair;
    std::int32_t manifold;
    bool isExchanged;  // the manifold's A is the pair's second
  };
  std::vector<Meeting> meetings(double slowest) const;

  /// Calls visit(pair, manifold, isExchanged) for each pair of colliders in contact, with the index of its manifold,
  /// whose A is the pair's second if it is exchanged; sleepers too.
  template <class Visit>
  void forEachContact(const Visit& visit) const {
    for (const NearPair& pair : pairs_)
      if (!pair.isEmpty) visit(geometry_.pairs[pair.pair], pair.manifold, pair.isExchanged);
  }

  /// A pair in contact, and what is known of it from the steps before.
  struct Record {
    std::uint64_t a = 0, b = 0;  // of the collider pair
    bool isAgainstPlane = false;
    float approach = 0;          // m/s, as of NearPair
    Vec3 offset = Vec3::Zero();  // m, world, from A to B when its manifold was found
    double turned = 0;           // rad, of both since then
    PersistentManifold manifold;
  };
  /// Of all pairs in contact, in the order of pairs; `poses` are those of the last look.
  std::vector<Record> record(const std::vector<MovingPose>& poses) const;

  /// To be called right after takePairs(), for poses that have not turned so far.
  void goOnFrom(const std::vector<Record>& records);

  /// Calls visit(a, b) for each two moving bodies that are in contact, sleepers too.
  template <class Visit>
  void forEachTouching(const Visit& visit) const {
    for (const NearPair& pair : pairs_)
      if (!pair.isEmpty && pair.bodyB != kFixed) visit(pair.bodyA, pair.bodyB);
  }

 private:
  /// A pair, and what is known of it from the steps before.
  struct NearPair : SoftPair {
    bool isEmpty = true;
    std::int32_t manifold = -1;
    float approach = 0;          // m/s, of a contact that was not pressed in the step before
    Vec3 offset = Vec3::Zero();  // m, from A to B when its manifold was found
    double turned = 0;           // rad, of both, then
    double clearance = -std::numeric_limits<double>::infinity();  // m: how far apart they were then, at least
  };
  void findNear(const SoftStepStart& look, WorkerThreads& threads);
  bool isInReach(std::size_t index, const SoftStepStart& look);
  void giveManifolds();
  void giveManifold(NearPair& pair);
  static double clearanceOf(const NearPair& pair, const MovingPose& a, const MovingPose& b);
  bool areNear(const NearPair& pair, const SoftStepStart& look, double reach) const;
  static double reachOf(const NearPair& pair, const SoftStepStart& look);
  static bool areFar(const NearPair& pair, const SoftStepStart& look);
  bool mayTouch(const NearPair& pair, const SoftStepStart& look) const;
  double approachOf(const NearPair& pair, const SoftStepStart& look) const;
  void updatePair(NearPair& pair, const SoftStepStart& look, std::vector<Contact>& scratch);
  static void follow(const NearPair& pair, const MovingPose& poseA, const MovingPose& poseB,
                     PersistentManifold& manifold);
  static void renew(const PredictedManifold& found, const MovingPose& poseA, const MovingPose& poseB, bool wasEmpty,
                    PersistentManifold& manifold);

  const ContactGeometry& geometry_;
  const SoftScale scale_;
  SoftManifolds generator_;
  std::vector<std::vector<Contact>> scratch_;  // of each thread
  std::vector<NearPair> pairs_, taken_;        // those of geometry.pairs as last taken; taken_: scratch
  struct BodyPair {
    int a, b;
  };
  std::vector<BodyPair> bodies_;  // of pairs_
  std::vector<char> inReach_;     // of pairs_: may come near before the step ends
  SweptBounds sweptBounds_;
  std::vector<PersistentManifold> manifolds_;
  std::vector<std::size_t> near_, nearOfPart_;  // indices into pairs_ of the last update, and how many of each part
  std::vector<ManifoldLink> active_;            // and while pairs are looked at, of all that are near
  std::vector<std::int32_t> free_;
};

}  // namespace cradle
