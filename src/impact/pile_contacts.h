#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "collision/box_pair.h"
#include "collision/contact_manifold.h"
#include "collision/separation.h"
#include "core/worker_threads.h"

namespace cradle {

/// Where and how fast a moving body is.
struct MovingPose {
  Vec3 position;         // m, world, of the centre of mass
  Mat3 rotation;         // worldFromBody
  Vec3 linearVelocity;   // m/s, at the end of the step if nothing touches
  Vec3 angularVelocity;  // rad/s
  double radius = 0;     // m, about the centre of mass
  int version = 0;       // changes when the body has moved farther than a manifold may be kept
  bool isAsleep = false;
};

/// The manifolds of all pairs that are near each other, kept from step to step.
class PileContacts {
 public:
  /// Keeps a reference to `geometry`, whose pairs change from step to step.
  explicit PileContacts(const ContactGeometry& geometry);

  /// To be called when geometry.pairs is a new list: manifolds of pairs that stay are kept.
  void takePairs();

  /// Contacts of now, and those that come about within the step. Pairs of bodies asleep stay as they are.
  void update(const std::vector<MovingPose>& poses, const VectorX& state, double timeStep, WorkerThreads& threads);

  std::vector<ContactManifold>& manifolds() { return manifolds_; }
  /// The manifolds that have points and a body awake, in the order of pairs.
  const std::vector<std::int32_t>& active() const { return active_; }

 private:
  struct BoxShape {
    Vec3 center;  // m, from the centre of mass, body's frame
    Mat3 axes;
    Vec3 halfSize;
  };
  static std::array<Vec3, ContactPatch::kMostPoints> noPoints() {
    std::array<Vec3, ContactPatch::kMostPoints> points;
    points.fill(Vec3::Zero());
    return points;
  }
  /// What a manifold was found from.
  struct Origin {
    int versionA = -1, versionB = -1;
    Vec3 localNormal = Vec3::UnitY();  // in A's frame
    std::array<Vec3, ContactPatch::kMostPoints> localA = noPoints(), localB = noPoints();
  };
  struct PairState {
    std::int32_t manifold = -1;
    bool isNear = false;
  };

  void updatePair(std::size_t pair, const std::vector<MovingPose>& poses, const VectorX& state, double timeStep);
  bool isNear(const ColliderPair& pair, const std::vector<MovingPose>& poses, double timeStep) const;

  const ContactGeometry& geometry_;
  std::vector<std::optional<BoxShape>> boxes_;  // of each collider
  std::vector<ColliderPair> pairs_;             // those that pairStates_ belong to
  std::vector<PairState> pairStates_;
  std::vector<ContactManifold> manifolds_;
  std::vector<Origin> origins_;
  std::vector<std::int32_t> free_;
  std::vector<std::int32_t> active_;
  std::vector<double> shocks_;
};

}  // namespace cradle
