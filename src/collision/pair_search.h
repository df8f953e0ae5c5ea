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

/// The search of one pair of a step, for ImpactSearch.
class PairSearch {
 public:
  /// Keeps references to both; `pair` is an index into the geometry's.
  PairSearch(ImpactSearch& scratch, const Step& step, std::size_t pair);

  /// Puts into `best` what happens in this pair, if that is earlier.
  void search(const TouchingFeatures& touching, std::optional<ImpactTime>& best);

 private:
  void findBounds();
  double accelerationInFrame(const MotionBounds& turn, const Collider& other) const;
  void lookBlindly();
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
  bool hasSphere() const;
  bool staysOnePoint() const;
  double deadBand(const TouchingFeatures& touching) const;
  double leavingSpeed(double tolerance);
  Vec3 lowestPoint(const Vec3& planeNormal) const;
  double gap(double fraction);

  const ContactGeometry& geometry_;
  ImpactSearch& scratch_;
  const Step& step_;
  std::size_t pairIndex_, feature_ = 0;
  const ColliderPair& pair_;
  const Collider& a_;
  int bodyB_;
  RigidTransform startA_, startB_;
  GapBounds bounds_;
  std::optional<SeparatingAxisCache> apart_;          // where the second derivative of the gap has no bound
  std::optional<FaceBelow> face_;                     // below all of the other body
  const std::vector<ActiveFeature>* held_ = nullptr;  // something holds points of this feature
  double reach_ = 0;                                  // m: farther apart nothing is looked at
  double pull_ = 0;  // m: bound on the relative acceleration, with the step as the unit of time
};

}  // namespace cradle
