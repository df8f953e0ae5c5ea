#include "simulate/rope_events.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/root_bracketing.h"
#include "constraints/invariants.h"
#include "dynamics/integrators/pose_interpolant.h"
#include "impact/impact_energy.h"
#include "impact/rope_impulse.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kTautRatio = 1e-9;       // of its length: a rope this near to it is at its length
constexpr double kSlackRatio = 1e-6;      // of its length: a rope this much shorter is slack again
constexpr double kLowestRebound = 1e-6;   // of sqrt(acceleration x length): a rebound that rises by 5e-13 of the length
constexpr double kMinPull = 1e-6;         // of gravity: a pull that is no rounding
constexpr int kTensionSamples = 4;        // a step: it is at most a small part of a swing
constexpr double kMinFirstSample = 1e-9;  // of a step: a rebound that is over sooner is none
constexpr double kMaxFirstSample = 1.0 / 1024;  // of a step
constexpr double kCoarsestInterval = 1.0 / 8;   // of a step, of a rope without tension: its length is smooth
constexpr double kRopeReach = 2;         // of the way that ends go freely in a step: what contacts may make of it
constexpr double kNearRatio = 1e-3;      // of its length: ropes so near to it take part in a step's contacts
constexpr double kPullRounding = 1e-12;  // of the speed before a pull
constexpr int kMaxPullRounds = 100;      // of pulls at one instant; those left over pull after the next step

Vec3 positionAt(const Step& step, const Attachment& attachment, double fraction) {
  return poseAt(step, attachment.body, fraction) * attachment.point;
}

MotionBounds motionBounds(const Step& step, const Attachment& attachment) {
  return cradle::motionBounds(step, attachment.body, attachment.point.norm());
}

/// First fraction of the step at which a rope is slack by more than `least` (m): 0, or, for a rope that has just been
/// released, the first of begin, 2 begin, 4 begin, ... where it is; 1 if none.
template <class Slack>
double firstSlack(const Slack& slack, double least, double begin) {
  if (slack(0) > least) return 0;
  double fraction = begin;
  while (fraction < 1 && slack(fraction) <= (fraction < kMaxFirstSample ? 0 : least)) fraction *= 2;
  return std::min(fraction, 1.0);
}

/// Fraction of the step until which a rope that shortens at its start shortens still, whatever accelerates its ends:
/// even a rebound far shorter than the step is not over by then. It is v / (v' bound), v the speed of shortening (m a
/// step).
double firstSample(const RopeLimit& rope, const Step& step) {
  const double speed = -motionOf(rope, step.startState).lengthening * step.timeStep;
  if (!(speed > 0)) return kMaxFirstSample;
  const MotionBounds a = motionBounds(step, rope.anchorA), b = motionBounds(step, rope.anchorB);
  // The distance d of two points: d'' <= relative acceleration + (speed across)^2 / d.
  const double across = a.speed + b.speed;
  const double part = speed / (a.acceleration + b.acceleration + across * across / rope.maxLength);
  return std::clamp(part, kMinFirstSample, kMaxFirstSample / 2);
}

/// J: of ropes' impulses.
double energyTakenBy(const std::vector<RopePull>& pulls, const VectorX& before, const VectorX& after) {
  double taken = 0;
  for (const RopePull& pull : pulls) {
    const RopeMotion from = motionOf(*pull.rope, before), to = motionOf(*pull.rope, after);
    taken +=
        energyTaken(-pull.impulse * from.direction, from.a.velocity - from.b.velocity, to.a.velocity - to.b.velocity);
  }
  return taken;
}

}  // namespace

RopeEvents::RopeEvents(IslandState& island)
    : island_(island),
      assembly_(island.assembly),
      equations_(island.equations),
      solver_(assembly_.mechanism.constraints, assembly_.mechanism.bodies),
      sceneConstraints_(assembly_.mechanism.constraints.size()),
      tautRow_(assembly_.ropes.size(), -1),
      isStretched_(assembly_.ropes.size(), 0) {}

std::optional<RopeChange> RopeEvents::firstChange(const Step& step) {
  std::optional<RopeChange> first;
  for (std::size_t i = 0; i < assembly_.ropes.size(); ++i) {
    const double end = first ? first->fraction : 1;
    if (!isTaut(i)) {
      if (const auto reached = firstReach(step, i, end)) first = reached;
    } else if (const auto fraction = firstTensionLoss(step, i); fraction && *fraction < end) {
      first = RopeChange{*fraction, i};
    }
  }
  if (first && isTaut(first->rope))
    tensionScale_ = std::max(tension(first->rope, step.time, step.startState),
                             std::abs(tension(first->rope, step.time + step.timeStep, step.state)));
  return first;
}

/// First root in (0, `end`] of the event function maxLength - L(theta) along the step's interpolant: the rope becomes
/// taut there. A rope that starts at its full length without tension has the threshold -kTautRatio maxLength instead.
std::optional<RopeChange> RopeEvents::firstReach(const Step& step, std::size_t index, double end) const {
  const RopeLimit& rope = assembly_.ropes[index];
  const auto slack = [&](double fraction) {
    return rope.maxLength -
           (positionAt(step, rope.anchorA, fraction) - positionAt(step, rope.anchorB, fraction)).norm();
  };
  // Of two points at distance d, -d'' is at most their relative acceleration.
  const MotionBounds a = motionBounds(step, rope.anchorA), b = motionBounds(step, rope.anchorB);
  GapBounds bounds{a.speed + b.speed, a.acceleration + b.acceleration};
  const double least = kTautRatio * rope.maxLength, start = slack(0);
  if (start > bounds.speed) return std::nullopt;
  const double begin = std::min(end, firstSlack(slack, least, firstSample(rope, step)));
  if (begin < end) {
    const auto fraction = firstRoot(slack, bounds, {begin, slack(begin), end, slack(end)});
    if (fraction) return RopeChange{*fraction, index};
  }
  if (start > least) return std::nullopt;
  const double threshold = std::min(0.0, start) - least;
  const auto above = [&](double fraction) { return slack(fraction) - threshold; };
  bounds.finest = kCoarsestInterval;
  const auto fraction = firstRoot(above, bounds, {0, above(0), begin, above(begin)});
  return fraction ? std::optional(RopeChange{*fraction, index, threshold}) : std::nullopt;
}

/// First fraction of the step at which the tension of a taut rope falls below zero, between a few samples of it.
std::optional<double> RopeEvents::firstTensionLoss(const Step& step, std::size_t rope) {
  double before = tension(rope, step.time, step.startState);
  for (int i = 1; i <= kTensionSamples; ++i) {
    const double fraction = static_cast<double>(i) / kTensionSamples;
    interpolate(step, fraction, sample_);
    const double after = tension(rope, step.time + fraction * step.timeStep, sample_);
    if (before > 0 && after < 0) return fraction - after / (after - before) / kTensionSamples;
    before = after;
  }
  return std::nullopt;
}

double RopeEvents::margin(const RopeChange& change, const VectorX& state) {
  if (isTaut(change.rope))
    return tension(change.rope, island_.step.time + island_.step.timeStep, state) / tensionScale_;
  const RopeLimit& rope = assembly_.ropes[change.rope];
  return (motionOf(rope, state).slackLength - change.threshold) / rope.maxLength;
}

/// Force (N) with which a taut rope pulls its ends together. Its row's multiplier pushes by multiplier x distance.
double RopeEvents::tension(std::size_t rope, double time, const VectorX& state) {
  equations_.evaluate(time, state, derivative_);
  return -equations_.multipliers()[tautRow_[rope]] * assembly_.ropes[rope].maxLength;
}

/// Whether a body at its ends is at rest: nothing is computed for such a rope.
bool RopeEvents::rests(std::size_t rope) const {
  const RopeLimit& limit = assembly_.ropes[rope];
  return island_.resting.isResting(limit.anchorA.body) || island_.resting.isResting(limit.anchorB.body);
}

bool RopeEvents::resolve(double time, VectorX& state) {
  // Ropes that would have to push are released, even where others go taut; impacts may have shortened some.
  std::vector<char> isReleased(tautRow_.size(), 0);
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    if (!isTaut(i) || rests(i) || tension(i, time, state) > kTautRatio * tensionScale_) continue;
    release(time, i, state);
    isReleased[i] = 1;
  }

  for (std::size_t i = 0; i < tautRow_.size(); ++i)
    if (!isTaut(i) && motionOf(assembly_.ropes[i], state).slackLength > kSlackRatio * assembly_.ropes[i].maxLength)
      loosen(time, i, state);
  const bool released = std::find(isReleased.begin(), isReleased.end(), 1) != isReleased.end();
  return pullStretched(time, isReleased, state) || released;
}

bool RopeEvents::pullStretched(double time, VectorX& state) {
  return pullStretched(time, std::vector<char>(tautRow_.size(), 0), state);
}

/// A pull may stretch another rope that is at its length, or load it.
bool RopeEvents::pullStretched(double time, const std::vector<char>& isReleased, VectorX& state) {
  for (int round = 0; round < kMaxPullRounds; ++round) {
    const std::vector<Stretch> stretches = findStretches(time, isReleased, state);
    if (stretches.empty()) return round > 0;
    pull(time, stretches, state);
  }
  return true;
}

/// Ropes at their length that still lengthen. A rebound that would end within about two steps is not resolved: the rope
/// stays taut. Smooth forces do not pull at a rope in the instant that it is released: its tension is zero to rounding,
/// of either sign, and would have it released again before time moves on.
std::vector<RopeEvents::Stretch> RopeEvents::findStretches(double time, const std::vector<char>& isReleased,
                                                           const VectorX& state) {
  std::vector<Stretch> stretches;
  bool isEvaluated = false;
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    const RopeLimit& rope = assembly_.ropes[i];
    if (isTaut(i)) continue;
    const RopeMotion motion = motionOf(rope, state);
    if (motion.slackLength > kTautRatio * rope.maxLength || motion.lengthening < -kRestSpeedFloor) continue;
    if (!std::exchange(isEvaluated, true)) equations_.evaluate(time, state, derivative_);
    const double acceleration = lengtheningAcceleration(rope, state, derivative_),
                 pulling = std::max(0.0, acceleration);
    const bool isLoaded = !isReleased[i] && acceleration > kMinPull * assembly_.mechanism.gravity.norm();
    if (!isLoaded && motion.lengthening <= kRestSpeedFloor) continue;
    const double restSpeed =
        2 * pulling * timeStep_ + kLowestRebound * std::sqrt(pulling * rope.maxLength) + kRestSpeedFloor;
    const double rebound = rope.restitution * motion.lengthening;
    stretches.push_back({i, motion.lengthening, rebound > restSpeed ? rebound : 0, isLoaded});
  }
  return stretches;
}

/// All ropes that are stretched at this instant pull at once. One that does not rebound becomes a rod if smooth forces
/// pull at it; else what drags at it (friction) is resolved step by step.
void RopeEvents::pull(double time, const std::vector<Stretch>& stretches, VectorX& state) {
  std::vector<RopePull> pulls;
  for (const Stretch& stretch : stretches) {
    const RopeLimit& rope = assembly_.ropes[stretch.rope];
    for (const int body : {rope.anchorA.body, rope.anchorB.body}) island_.wake(body);
    pulls.push_back({&rope, stretch.reboundSpeed});
  }
  const VectorX before = state;
  if (solver_.hasConstraints()) solver_.factorize(state);
  applyPulls(pulls, assembly_.mechanism.bodies, solver_, state);
  impactEnergy(state) += energyTakenBy(pulls, before, state);
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const auto& [rope, speed, reboundSpeed, isLoaded] = stretches[i];
    const bool rebounds = reboundSpeed > 0;
    const double lengthening = motionOf(assembly_.ropes[rope], state).lengthening;
    if (lengthening < -(reboundSpeed + kRestSpeedFloor + kPullRounding * speed)) continue;  // others pulled it short
    if (!isStretched_[rope] || rebounds) record(time, EventKind::taut, rope, pulls[i].impulse, state);
    isStretched_[rope] = !rebounds;
    if (!rebounds && isLoaded) tautRow_[rope] = 0;
  }
  rebuildConstraints();
  if (solver_.hasConstraints()) {
    solver_.factorize(state);
    solver_.constrainVelocities(state);
  }
  bookNumerical(energyConstant(assembly_.mechanism, before), assembly_.mechanism, state);
}

/// A rope closes as a contact where it lengthens. An impulse along the line of both ends has the same effect wherever
/// on that line it acts: at end A for both bodies.
ImpactContact RopeEvents::contactOf(const RopeLimit& rope, const VectorX& state) {
  const RopeMotion motion = motionOf(rope, state);
  Contact contact;
  contact.bodyA = rope.anchorA.body, contact.bodyB = rope.anchorB.body;
  contact.point = motion.a.position, contact.normal = motion.direction;
  contact.separation = motion.slackLength;
  return {contact, {rope.restitution, 0, 0}, 0, Vec3::Zero()};
}

std::vector<const RopeLimit*> RopeEvents::withinReach(const VectorX& before, const VectorX& state,
                                                      double length) const {
  std::vector<const RopeLimit*> ropes;
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    const RopeLimit& rope = assembly_.ropes[i];
    if (isTaut(i) || rests(i)) continue;
    const RopeMotion from = motionOf(rope, before), to = motionOf(rope, state);
    const auto speed = [](const RopeMotion& motion) { return motion.a.velocity.norm() + motion.b.velocity.norm(); };
    if (from.slackLength > kRopeReach * length * std::max(speed(from), speed(to)) + kNearRatio * rope.maxLength)
      continue;
    ropes.push_back(&rope);
  }
  return ropes;
}

std::vector<ImpactContact> RopeEvents::beginImpact(const VectorX& state) {
  std::vector<ImpactContact> impacts;
  members_.clear();
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    const RopeLimit& rope = assembly_.ropes[i];
    const RopeMotion motion = motionOf(rope, state);
    if (!isTaut(i) && motion.slackLength > kTautRatio * rope.maxLength) continue;
    members_.push_back({i, isTaut(i)});
    tautRow_[i] = -1;
    impacts.push_back(contactOf(rope, state));
    impacts.back().contact.separation = 0;
  }
  rebuildConstraints();
  return impacts;
}

void RopeEvents::endImpact(double time, const std::vector<ImpactContact>& impacts, const VectorX& state) {
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const auto [rope, wasTaut] = members_[k];
    const RopeMotion motion = motionOf(assembly_.ropes[rope], state);
    const double speed = motion.a.velocity.norm() + motion.b.velocity.norm();
    const bool shortens = motion.lengthening < -(kRestSpeedFloor + kPullRounding * speed);
    const double impulse = impacts[k].impulse.norm();
    if (wasTaut && shortens) loosen(time, rope, state);
    if (wasTaut && !shortens) tautRow_[rope] = 0;
    if (wasTaut || impulse == 0) continue;
    record(time, EventKind::taut, rope, impulse, state);
    isStretched_[rope] = !shortens;
  }
  rebuildConstraints();
}

void RopeEvents::release(double time, std::size_t rope, const VectorX& state) {
  tautRow_[rope] = -1;
  rebuildConstraints();
  loosen(time, rope, state);
}

void RopeEvents::loosen(double time, std::size_t rope, const VectorX& state) {
  if (isStretched_[rope]) record(time, EventKind::slack, rope, 0, state);
  isStretched_[rope] = false;
}

void RopeEvents::rebuildConstraints() {
  Constraints& constraints = assembly_.mechanism.constraints;
  constraints.resize(sceneConstraints_);
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    if (!isTaut(i)) continue;
    const RopeLimit& rope = assembly_.ropes[i];
    tautRow_[i] = rowCount(constraints);
    constraints.push_back({rope.anchorA, rope.anchorB, RodConstraint{rope.maxLength}});
  }
}

void RopeEvents::record(double time, EventKind kind, std::size_t rope, double impulse, const VectorX& state) {
  const RopeMotion motion = motionOf(assembly_.ropes[rope], state);
  const auto [a, b] = assembly_.ropeBodies[rope];
  island_.log.record({time, kind, a, b, motion.a.position, -motion.direction, impulse});
}

}  // namespace cradle
