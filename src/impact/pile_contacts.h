#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "collision/contact_manifold.h"
#include "collision/separation.h"
#include "core/worker_threads.h"

namespace cradle {

constexpr double kContactMargin = 5e-3;  // m: contacts are known before bodies touch

/// Where and how fast a moving body is.
struct MovingPose {
  Vec3 position = Vec3::Zero();         // m, world, of the centre of mass
  Mat3 rotation = Mat3::Identity();     // worldFromBody
  Vec3 linearVelocity = Vec3::Zero();   // m/s, world
  Vec3 angularVelocity = Vec3::Zero();  // rad/s, world
  double radius = 0;                    // m, of the collider about the centre of mass
  int version = 0;                      // changes when the body has moved farther than a manifold may be kept
  bool isAsleep = false;
};

/// The manifolds of all pairs that are near each other, kept from step to step.
class PileContacts {
 public:
  /// Keeps a reference to `geometry`, whose pairs change from step to step.
  explicit PileContacts(const ContactGeometry& geometry);

  /// To be called when geometry.pairs is a new list: manifolds of pairs that stay are kept.
  void takePairs();

  /// The speed (m/s) at which bodies approach each other that may touch within the time (s), for how often they must be
  /// looked at: a part of it between balls.
  double fastestApproach(const std::vector<MovingPose>& poses, double time, WorkerThreads& threads) const;

  /// Contacts of now, and those that come about within the step. Pairs of bodies asleep stay as they are. `state` holds
  /// the same poses.
  void update(const std::vector<MovingPose>& poses, const VectorX& state, double timeStep, WorkerThreads& threads);

  std::vector<ContactManifold>& manifolds() { return manifolds_; }
  const std::vector<ContactManifold>& manifolds() const { return manifolds_; }
  /// The manifolds that have points and a body awake, in the order of pairs.
  const std::vector<std::int32_t>& active() const { return active_; }

  /// Contacts among them that were not pressed in the step before and close faster than `slowest` (m/s), as pairs of
  /// colliders.
  struct Meeting {
    ColliderPair pair;
    std::int32_t manifold;
    bool isExchanged;  // the manifold's A is the pair's second
  };
  std::vector<Meeting> meetings(double slowest) const;

  /// The first body of each body's group of bodies in contact, among those awake.
  const std::vector<int>& islands(const std::vector<MovingPose>& poses);

 private:
  struct BoxShape {
    Vec3 center;  // m, from the centre of mass, body's frame; world if fixed
    Mat3 axes;
    Vec3 halfSize;
  };
  /// A pair with a moving body first, and what is known of it from the step before.
  struct NearPair {
    std::size_t pair = 0;    // index into geometry.pairs
    std::size_t shapeA = 0;  // collider
    std::size_t shapeB = 0;  // collider or plane
    int bodyA = kFixed, bodyB = kFixed;
    int versionA = -1, versionB = -1;  // of the bodies when its manifold was found
    std::int32_t manifold = -1;
    bool againstPlane = false, isExchanged = false, isNear = false, isEmpty = true;
    double approach = 0;  // m/s, of a contact that was not pressed in the step before
  };
  /// A manifold's points in their bodies' frames.
  struct Anchors {
    Vec3 normal = Vec3::UnitY();  // in A's
    std::array<Vec3, ContactPatch::kMostPoints> onA{}, onB{};
  };

  static std::optional<BoxShape> boxOf(const Collider& collider);
  NearPair nearPairOf(std::size_t pair) const;
  void giveManifolds();
  bool mayTouch(const NearPair& pair, const std::vector<MovingPose>& poses, double time) const;
  double approachOf(const NearPair& pair, const std::vector<MovingPose>& poses, double time) const;
  void updatePair(NearPair& pair, const std::vector<MovingPose>& poses, const VectorX& state, double timeStep,
                  std::vector<Contact>& scratch);
  ContactPatch patchOf(const NearPair& pair, const MovingPose& poseA, const MovingPose& poseB, double timeStep) const;
  ContactPatch patchOfAnyShapes(const NearPair& pair, const VectorX& state, double reach,
                                std::vector<Contact>& scratch) const;
  bool isFast(const NearPair& pair) const;
  void follow(const MovingPose& poseA, const MovingPose& poseB, const Anchors& anchors, ContactPatch& patch) const;
  void renew(const ContactPatch& patch, const MovingPose& poseA, const MovingPose& poseB, bool wasEmpty,
             ContactManifold& manifold, Anchors& anchors) const;

  const ContactGeometry& geometry_;
  std::vector<std::optional<BoxShape>> boxes_;  // of each collider
  std::vector<char> isFast_;                    // of each collider: a ball or a box
  std::vector<std::vector<Contact>> scratch_;   // of each thread
  std::vector<ColliderPair> listed_;            // geometry.pairs as last taken
  std::vector<NearPair> pairs_, taken_;         // taken_: scratch
  std::vector<ContactManifold> manifolds_;
  std::vector<Anchors> anchors_;
  std::vector<std::int32_t> free_, active_;
  std::vector<int> islands_;
};

}  // namespace cradle
