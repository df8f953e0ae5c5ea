#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "collision/contacts_beside_held.h"
#include "collision/face_below.h"
#include "collision/root_bracketing.h"
#include "dynamics/integrators/pose_interpolant.h"

namespace cradle {

/// An impact inside a step: the instant at which the gap of two features has fallen to a threshold.
struct ImpactTime {
  double fraction = 0;  // of the step, 0..1
  std::size_t pair = 0, feature = 0;
  double threshold = 0;           // m: the gap at that instant; < 0 if the features touched at the start
  bool isOfOthers = false;        // the gap is that of those points of the pair that no active contact holds
  std::optional<FaceBelow> face;  // if there is one, the gap is the height of corner number `feature` over it
};

/// The features that touch when a step begins.
struct TouchingFeatures {
  double tolerance = 0;  // m: features nearer than this touch
  // m: features that touch and are not active collide when they have closed by more than this; infinite: never
  double deadBand = std::numeric_limits<double>::infinity();
  // Active contacts, and what joints hold: these features have no impacts, other points of the same pairs have.
  const std::vector<ActiveFeature>* active = nullptr;
  // Of a step: touches that come and go within less may be passed over, but for those of sheets.
  double finest = kFinestApproach;

  const std::vector<ActiveFeature>& activeFeatures() const {
    static const std::vector<ActiveFeature> none;
    return active ? *active : none;
  }
};

/// Searches steps for the first instant at which two features come together: apart by more than the tolerance, leaving
/// each other, or touching without a load before. On the step's interpolant, with bounds on the relative motion so that
/// nothing passes through anything.
class ImpactSearch {
 public:
  /// Keeps a reference to `geometry`.
  explicit ImpactSearch(const ContactGeometry& geometry) : geometry_(geometry) {}

  /// The step's end derivative must be there (prepareInterpolant).
  std::optional<ImpactTime> first(const Step& step, const TouchingFeatures& touching);

  /// How far (m) an impact, found with the same touching features, is from happening in a state.
  double margin(const ImpactTime& impact, const TouchingFeatures& touching, const VectorX& state);

 private:
  struct Turn {
    bool isKnown = false;
    MotionBounds bounds;
  };
  friend class PairSearch;
  const MotionBounds& turnOf(const Step& step, int body);

  const ContactGeometry& geometry_;
  std::vector<Turn> turns_;     // of the moving bodies, in the step that is searched
  std::vector<char> isMoving_;  // of the same
  std::vector<std::size_t> features_;
  std::vector<Contact> contacts_;
  VectorX sample_;  // with the poses of the pair that is searched
};

}  // namespace cradle
