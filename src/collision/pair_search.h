#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "collision/face_below.h"
#include "collision/root_bracketing.h"
#include "collision/separating_axis_cache.h"
#include "collision/time_of_impact.h"

namespace cradle {

/// Height (m) of a corner of one collider, with the sphere around it, over a face of the other.
double heightOfCorner(const FaceBelow& face, std::size_t corner, const std::pair<const Collider&, RigidTransform>& a,
                      const std::pair<const Collider&, RigidTransform>& b);

/// The search for the first impact of one pair in a step, for ImpactSearch.
class PairSearch {
 public:
  /// Keeps references to both; `pair` is an index into the geometry's.
  PairSearch(ImpactSearch& scratch, const Step& step, std::size_t pair);

  /// Puts the first impact of this pair into `best`, if it is earlier than that.
  void search(const TouchingFeatures& touching, std::optional<ImpactTime>& best);

 private:
  bool mayTurnDown();
  void findBounds();
  double accelerationInFrame(const MotionBounds& turn, const Collider& other) const;
  void useSpeedBoundAlone();
  void findFace();
  void searchCorners(const TouchingFeatures& touching, std::optional<ImpactTime>& best);
  void searchFeature(double start, const TouchingFeatures& touching, std::optional<ImpactTime>& best);
  void searchTurningAboutPin(const TouchingFeatures& touching, std::optional<ImpactTime>& best);
  void searchHeldRim(const TouchingFeatures& touching, std::optional<ImpactTime>& best);
  void searchTouching(double start, const TouchingFeatures& touching, std::optional<ImpactTime>& best);
  void searchFrom(double from, double gapFrom, double threshold, std::optional<ImpactTime>& best);
  bool isCornerHeld(const TouchingFeatures& touching, const Collider& upper) const;
  bool isFlush(const TouchingFeatures& touching, const Collider& upper) const;
  bool isHeld(const TouchingFeatures& touching) const;
  bool hasOneContact() const;
  bool hasSheet() const;
  bool hasSphere() const;
  bool staysOnePoint() const;
  double closingAcceleration() const;
  double deadBand(const TouchingFeatures& touching) const;
  bool isBounce(double speed) const;
  double gapRounding() const;
  double leavingSpeed(double tolerance);
  Vec3 lowestPoint(const Vec3& planeNormal) const;
  double gap(double fraction, double enough = INFINITY);

  const ContactGeometry& geometry_;
  ImpactSearch& scratch_;
  const Step& step_;
  std::size_t pairIndex_, feature_ = 0;
  const ColliderPair& pair_;
  const Collider& a_;
  int bodyB_;
  RigidTransform startA_, startB_;
  GapBounds bounds_;
  std::optional<SeparatingAxisCache> apart_;          // for convex pairs whose gap has no bound on its acceleration
  std::optional<FaceBelow> face_;                     // face of one body below all of the other one
  const std::vector<ActiveFeature>* held_ = nullptr;  // if points of this feature are held: all that are
  double reach_ = 0;                                  // m: gaps that are larger need not be known
  double maxAcceleration_ = 0;  // m: bound on the relative acceleration, with the step as the unit of time
};

}  // namespace cradle
