#include "simulate/events/event_tolerances.h"

#include <cmath>

#include "dynamics/integrators/step_size.h"
#include "simulate/plan/plan.h"
#include "simulate/thresholds.h"

namespace cradle {

EventScales eventScalesOf(const IslandState& island) {
  return {island.scene.accuracy, island.scene.duration, island.assembly.smallestSize,
          island.assembly.mechanism.gravity.norm()};
}

EventTolerances eventTolerancesOf(const EventScales& scales) {
  using Tolerances = EventTolerances;
  const double size = scales.size, accuracy = scales.accuracy;
  const bool isVisual = accuracy > kVisualAccuracy;
  EventTolerances made;
  made.scales = scales;
  made.touch = size * (isVisual ? Tolerances::kVisualTouchRatio : Tolerances::kTouchRatio);
  made.deadBand = Tolerances::kDeadBandRatio * size;
  made.reach = size * std::clamp(Tolerances::kReachRatio * accuracy, Tolerances::kTouchRatio,
                                 isVisual ? Tolerances::kMaxVisualReachRatio : Tolerances::kMaxReachRatio);
  made.closingPairGap = Tolerances::kClosingPairRatio * size;
  made.closedGap = Tolerances::kClosedGapRatio * made.touch;
  made.leaving = Tolerances::kLeavingRatio * made.touch;
  made.slowSliding = std::max(kSlowestSliding, Tolerances::kSlowSlidingRatio * accuracy);
  const double longest = std::min(scales.duration, Tolerances::kLongRun);
  made.shortTimeStep = Tolerances::kShortTimeStepRatio * longest;
  made.shortestTimeStep = kShortestTimeStep * longest;
  const double fall = std::min(longest, std::sqrt(size / scales.gravity));
  made.slowTimeStep = Tolerances::kSlowTimeStepRatio * fall;
  made.rateTime = Tolerances::kRateTimeRatio * fall;
  made.reboundRatio = std::max({Tolerances::kOpeningRatio, Tolerances::kBounceOfAccuracy * accuracy,
                                Tolerances::kBounceOfSquare * accuracy * accuracy});
  made.restRatio = std::min(Tolerances::kMaxRestRatio, accuracy);
  made.constraintError = std::max(Tolerances::kMinConstraintError, Tolerances::kConstraintErrorRatio * accuracy);
  return made;
}

double EventTolerances::minOpeningSpeed(double l) const {
  return kOpeningRatio * std::sqrt(scales.gravity * l) + kRestSpeedFloor;
}

double EventTolerances::maxRestSpeed(double l) const {
  return kRestSpeedFloor + restRatio * std::sqrt(scales.gravity * l);
}

double EventTolerances::minSlidingAcceleration(double friction) const {
  const double time = scales.duration;
  return friction * std::min(kCreepRatio, kCreepOfAccuracy * time * time * scales.accuracy);
}

double EventTolerances::stillAcceleration(double largest, double residual) const {
  const double seen = std::max(scales.accuracy / (10 * scales.duration * scales.duration), kResidualFactor * residual);
  return std::clamp(seen, kMinStillRatio * largest, kStillRatio * largest);
}

}  // namespace cradle
