#include "simulate/limit_events.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "collision/root_bracketing.h"
#include "constraints/disjoint_sets.h"
#include "constraints/invariants.h"
#include "dynamics/integrators/pose_interpolant.h"
#include "impact/impact_energy.h"
#include "impact/rope_impulse.h"
#include "math/parabola.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kTautRatio = 1e-9;       // of its size: a limit this near is reached
constexpr double kSlackRatio = 1e-6;      // of its size: a limit this far away is slack again
constexpr double kLowestRebound = 1e-6;   // of sqrt(acceleration x length): a rebound that rises by 5e-13 of the length
constexpr double kUsualAcceleration = 1;  // m/s^2: tensions are compared with what gives that before others are known
constexpr double kMinPull = 1e-11;  // of the accelerations that it is the difference of: a pull that is no rounding
constexpr int kTensionSamples = 4;  // a step: it is at most a small part of a swing
constexpr double kMinFirstSample = 1e-9;        // of a step: a rebound that is over sooner is none
constexpr double kMaxFirstSample = 1.0 / 1024;  // of a step
constexpr double kCoarsestInterval = 1.0 / 8;   // of a step, of a limit without tension: its slack is smooth
constexpr double kLimitReach = 2;       // of the way that ends go freely in a step: what contacts may make of it
constexpr double kNearRatio = 1e-3;     // of its size: limits so near take part in a step's contacts
constexpr double kPullRounding = 1e-9;  // of the speed before a pull, which rods and joints may share among them
constexpr int kMaxPullRounds = 100;     // of pulls at one instant; those left over pull after the next step

Vec3 positionAt(const Step& step, const Attachment& attachment, double fraction) {
  return poseAt(step, attachment.body, fraction) * attachment.point;
}

MotionBounds motionBounds(const Step& step, const Attachment& attachment) {
  return cradle::motionBounds(step, attachment.body, attachment.point.norm());
}

double slackAt(const RopeLimit& rope, const Step& step, double fraction, double) {
  return rope.maxLength - (positionAt(step, rope.anchorA, fraction) - positionAt(step, rope.anchorB, fraction)).norm();
}

/// `turning` is what a hinge turns by in the whole step (rad), if its rate changes evenly.
double slackAt(const JointLimit& stop, const Step& step, double fraction, double turning) {
  const double withRateOfStart = stop.rate * step.timeStep;
  return slackOf(stop, poseAt(step, stop.anchorA.body, fraction), poseAt(step, stop.anchorB.body, fraction),
                 fraction * (withRateOfStart + fraction * (turning - withRateOfStart)));
}

double turningOf(const Limit& limit, const Step& step) {
  const auto* stop = std::get_if<JointLimit>(&limit);
  return stop && stop->bound.turns ? turningTo(*stop, step.timeStep, step.state) : 0;
}

/// Bounds on the slack's derivatives, with the step as the unit of time. Of two points at distance d, -d'' is at most
/// their relative acceleration.
MotionBounds slackBounds(const RopeLimit& rope, const Step& step) {
  const MotionBounds a = motionBounds(step, rope.anchorA), b = motionBounds(step, rope.anchorB);
  return {a.speed + b.speed, a.acceleration + b.acceleration};
}

/// Of a hinge's angle: u . (w_A - w_B), and its rate. Of the way d along a slider: u . d, with |d| at most what it is
/// now and what its ends go, and the rates of u by the turning of B.
MotionBounds slackBounds(const JointLimit& stop, const Step& step) {
  const MotionBounds turnA = turnBounds(step, stop.anchorA.body), turnB = turnBounds(step, stop.anchorB.body);
  if (stop.bound.turns)
    return {stop.size * (turnA.speed + turnB.speed),
            stop.size * (turnA.acceleration + turnB.acceleration + turnB.speed * (turnA.speed + turnB.speed))};
  const MotionBounds a = motionBounds(step, stop.anchorA), b = motionBounds(step, stop.anchorB);
  const double speed = a.speed + b.speed;
  const double way = (positionAt(step, stop.anchorA, 0) - positionAt(step, stop.anchorB, 0)).norm() + speed;
  return {speed + turnB.speed * way, a.acceleration + b.acceleration + 2 * turnB.speed * speed +
                                         (turnB.acceleration + turnB.speed * turnB.speed) * way};
}

/// The rate of the lengthening at most, whatever accelerates the ends: of the distance d of two points d'' <= relative
/// acceleration + (speed across)^2 / d.
double accelerationBound(const RopeLimit& rope, const Step& step) {
  const MotionBounds bounds = slackBounds(rope, step);
  return bounds.acceleration + bounds.speed * bounds.speed / rope.maxLength;
}
double accelerationBound(const JointLimit& stop, const Step& step) {
  return slackBounds(stop, step).acceleration;
}

/// First fraction of the step at which a limit is slack by more than `least` (m): 0, or, for a limit that has just been
/// released, the first of begin, 2 begin, 4 begin, ... where it is; 1 if none.
template <class Slack>
double firstSlack(const Slack& slack, double least, double begin) {
  if (slack(0) > least) return 0;
  double fraction = begin;
  while (fraction < 1 && slack(fraction) <= (fraction < kMaxFirstSample ? 0 : least)) fraction *= 2;
  return std::min(fraction, 1.0);
}

/// Fraction of the step until which a limit that shortens at its start shortens still, whatever accelerates its ends:
/// even a rebound far shorter than the step is not over by then. It is v / (v' bound), v the speed of shortening (m a
/// step). One that hardly shortens, as nothing presses it, has not rebounded.
double firstSample(const Limit& limit, const Step& step) {
  const double speed = -motionOf(limit, step.startState).lengthening;
  if (!(speed > kRestSpeedFloor)) return kMaxFirstSample;
  const double bound = std::visit([&step](const auto& kind) { return accelerationBound(kind, step); }, limit);
  return std::clamp(speed * step.timeStep / bound, kMinFirstSample, kMaxFirstSample / 2);
}

/// J: of what drives bodies, against limits' impulses.
double workOfDriven(const std::vector<RopePull>& pulls, const VectorX& led) {
  double work = 0;
  for (const RopePull& pull : pulls) work += pull.impulse * motionOf(*pull.rope, led).lengthening;
  return work;
}

/// J: of limits' impulses.
double energyTakenBy(const std::vector<RopePull>& pulls, const VectorX& before, const VectorX& after) {
  double taken = 0;
  for (const RopePull& pull : pulls) {
    const LimitMotion from = motionOf(*pull.rope, before), to = motionOf(*pull.rope, after);
    taken +=
        energyTaken(-pull.impulse * from.direction, from.a.velocity - from.b.velocity, to.a.velocity - to.b.velocity);
  }
  return taken;
}

}  // namespace

LimitEvents::LimitEvents(IslandState& island)
    : island_(island),
      assembly_(island.assembly),
      equations_(island.equations),
      followedTime_(assembly_.startTime),
      sceneConstraints_(assembly_.mechanism.constraints.size()),
      tautRow_(assembly_.limits.size(), -1),
      isStretched_(assembly_.limits.size(), 0),
      tensionScales_(assembly_.limits.size()) {
  for (std::size_t i = 0; i < tensionScales_.size(); ++i) tensionScales_[i] = usualTension(i);
  followTurns(followedTime_, assembly_.state);
}

/// kg: of the bodies at the limit's ends.
double LimitEvents::lighterMass(std::size_t limit) const {
  double mass = INFINITY;
  const auto [a, b] = bodiesOf(assembly_.limits[limit]);
  for (const int body : {a, b})
    if (body != kFixed && !assembly_.mechanism.bodies[static_cast<std::size_t>(body)].isDriven())
      mass = std::min(mass, assembly_.mechanism.bodies[static_cast<std::size_t>(body)].mass);
  return mass;
}

/// N
double LimitEvents::usualTension(std::size_t limit) const {
  return kUsualAcceleration * lighterMass(limit);
}

std::optional<LimitChange> LimitEvents::firstChange(const Step& step) {
  std::optional<LimitChange> first;
  for (std::size_t i = 0; i < assembly_.limits.size(); ++i)
    if (const auto change = changeOf(step, i, first ? first->fraction : 1)) first = change;
  if (!first) return first;
  for (std::size_t i = 0; i < assembly_.limits.size(); ++i) {
    const auto change = i == first->limit ? std::nullopt : changeOf(step, i, first->latest);
    if (change && change->fraction > first->fraction + kAtOnce) first->latest = change->fraction;
  }
  if (isTaut(first->limit))
    for (std::size_t i = 0; i < assembly_.limits.size(); ++i)
      if (isTaut(i))
        tensionScales_[i] = std::max(tension(i, step.time, step.startState),
                                     std::abs(tension(i, step.time + step.timeStep, step.state)));
  return first;
}

/// The first change of a limit before `end` (a fraction of the step).
std::optional<LimitChange> LimitEvents::changeOf(const Step& step, std::size_t limit, double end) {
  if (!isTaut(limit)) return firstReach(step, limit, end);
  const std::optional<double> fraction = firstTensionLoss(step, limit);
  return fraction && *fraction < end ? std::optional(LimitChange{*fraction, limit}) : std::nullopt;
}

/// First root in (0, `end`] of the event function maxLength - L(theta) along the step's interpolant: the limit becomes
/// taut there. A limit that starts at its full length without tension has the threshold -kTautRatio maxLength instead.
std::optional<LimitChange> LimitEvents::firstReach(const Step& step, std::size_t index, double end) const {
  const Limit& limit = assembly_.limits[index];
  const auto slack = [&, turning = turningOf(limit, step)](double fraction) {
    return std::visit([&](const auto& kind) { return slackAt(kind, step, fraction, turning); }, limit);
  };
  const MotionBounds most = std::visit([&step](const auto& kind) { return slackBounds(kind, step); }, limit);
  GapBounds bounds{most.speed, most.acceleration};
  const double least = kTautRatio * sizeOf(limit), start = slack(0);
  if (start > bounds.speed) return std::nullopt;
  const double begin = std::min(end, firstSlack(slack, least, firstSample(limit, step)));
  if (begin < end) {
    const auto fraction = firstRoot(slack, bounds, {begin, slack(begin), end, slack(end)});
    if (fraction) return LimitChange{*fraction, index};
  }
  if (start > least) return std::nullopt;
  const double threshold = std::min(0.0, start) - least;
  const auto above = [&](double fraction) { return slack(fraction) - threshold; };
  bounds.finest = kCoarsestInterval;
  const auto fraction = firstRoot(above, bounds, {0, above(0), begin, above(begin)});
  return fraction ? std::optional(LimitChange{*fraction, index, threshold}) : std::nullopt;
}

/// First fraction of the step at which the tension of a taut limit falls below zero, by a few samples of it and the
/// parabolas through them.
std::optional<double> LimitEvents::firstTensionLoss(const Step& step, std::size_t limit) {
  const auto tensionAt = [&](double fraction) {
    interpolate(step, fraction, sample_);
    return tension(limit, step.time + fraction * step.timeStep, sample_);
  };
  std::array<double, kTensionSamples + 1> samples{tension(limit, step.time, step.startState)};
  for (int i = 1; i <= kTensionSamples; ++i)
    samples[static_cast<std::size_t>(i)] = tensionAt(1.0 * i / kTensionSamples);
  return firstFall(tensionAt, samples, 1);  // further ones find rounding where nothing pulls
}

double LimitEvents::margin(const LimitChange& change, const VectorX& state) {
  if (isTaut(change.limit))
    return tension(change.limit, island_.step.time + island_.step.timeStep, state) / tensionScales_[change.limit];
  const Limit& limit = assembly_.limits[change.limit];
  const auto* stop = std::get_if<JointLimit>(&limit);
  const double slack = stop && stop->bound.turns
                           ? slackOf(*stop, poseOf(state, stop->anchorA.body), poseOf(state, stop->anchorB.body),
                                     turningTo(*stop, island_.step.timeStep, state))
                           : motionOf(limit, state).slackLength;
  return (slack - change.threshold) / sizeOf(limit);
}

/// Force (N) with which a taut limit pulls its ends together, or pushes back. Its row's multiplier pushes by multiplier
/// x distance.
double LimitEvents::tension(std::size_t limit, double time, const VectorX& state) {
  equations_.evaluate(time, state, derivative_);
  return tensionOf(assembly_.limits[limit], equations_.multipliers()[tautRow_[limit]]);
}

/// Whether a body at its ends is at rest: nothing is computed for such a limit.
bool LimitEvents::rests(std::size_t limit) const {
  const auto [a, b] = bodiesOf(assembly_.limits[limit]);
  return island_.resting.isResting(a) || island_.resting.isResting(b);
}

void LimitEvents::followTurns(double time, const VectorX& state) {
  for (Limit& limit : assembly_.limits)
    if (auto* stop = std::get_if<JointLimit>(&limit); stop && stop->bound.turns)
      followTurn(*stop, time - followedTime_, state);
  followedTime_ = time;
}

bool LimitEvents::resolve(double time, VectorX& state) {
  followTurns(time, state);
  // Limits that would have to push are released, even where others go taut; impacts may have shortened some.
  std::vector<char> isReleased(tautRow_.size(), 0);
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    if (!isTaut(i) || rests(i) || tension(i, time, state) > kTautRatio * tensionScales_[i]) continue;
    release(time, i, state);
    isReleased[i] = 1;
  }

  for (std::size_t i = 0; i < tautRow_.size(); ++i)
    if (!isTaut(i) && motionOf(assembly_.limits[i], state).slackLength > kSlackRatio * sizeOf(assembly_.limits[i]))
      loosen(time, i, state);
  const bool released = std::find(isReleased.begin(), isReleased.end(), 1) != isReleased.end();
  const bool pulled = pullStretched(time, isReleased, state);
  if (pulled) followTurns(time, state);  // they turn at other rates now
  return pulled || released;
}

bool LimitEvents::pullStretched(double time, VectorX& state) {
  return pullStretched(time, std::vector<char>(tautRow_.size(), 0), state);
}

/// A pull may stretch another limit that is reached, or load it.
bool LimitEvents::pullStretched(double time, const std::vector<char>& isReleased, VectorX& state) {
  for (int round = 0; round < kMaxPullRounds; ++round) {
    const std::vector<Stretch> stretches = findStretches(time, isReleased, state);
    if (stretches.empty()) return round > 0;
    pull(time, stretches, state);
  }
  return true;
}

/// m/s^2: of the terms whose difference is a limit's acceleration, in the derivative that was evaluated last.
double LimitEvents::accelerationScale(const Limit& limit, const VectorX& state) const {
  double scale = assembly_.mechanism.gravity.norm();
  const auto [a, b] = bodiesOf(limit);
  for (const int body : {a, b}) {
    if (body == kFixed) continue;
    const double spin = angularVelocity(state, body).norm();
    scale += linearVelocity(derivative_, body).norm() +
             sizeOf(limit) * (angularVelocity(derivative_, body).norm() + spin * spin);
  }
  return scale;
}

/// Limits that are reached and still lengthen. A rebound that would end within about two steps is not resolved: the
/// limit stays taut. Smooth forces do not pull at a limit in the instant that it is released: its tension is zero to
/// rounding, of either sign, and would have it released again before time moves on.
std::vector<LimitEvents::Stretch> LimitEvents::findStretches(double time, const std::vector<char>& isReleased,
                                                             const VectorX& state) {
  std::vector<Stretch> stretches;
  bool isEvaluated = false;
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    const Limit& limit = assembly_.limits[i];
    if (isTaut(i)) continue;
    const LimitMotion motion = motionOf(limit, state);
    if (motion.slackLength > kTautRatio * sizeOf(limit) || motion.lengthening < -kRestSpeedFloor) continue;
    if (!std::exchange(isEvaluated, true)) equations_.evaluate(time, state, derivative_);
    const double acceleration = lengtheningAcceleration(limit, state, derivative_),
                 pulling = std::max(0.0, acceleration);
    const double releasing = kTautRatio * tensionScales_[i] / lighterMass(i);  // m/s^2: at less it is released
    const bool isLoaded =
        !isReleased[i] && acceleration > std::max(kMinPull * accelerationScale(limit, state), releasing);
    if (!isLoaded && motion.lengthening <= kRestSpeedFloor) continue;
    const double restSpeed =
        2 * pulling * timeStep_ + kLowestRebound * std::sqrt(pulling * sizeOf(limit)) + kRestSpeedFloor;
    const double rebound = restitutionOf(limit) * motion.lengthening;
    stretches.push_back({i, motion.lengthening, rebound > restSpeed ? rebound : 0, isLoaded});
  }
  return stretches;
}

/// All limits that are stretched at this instant pull at once. One that does not rebound becomes a constraint if smooth
/// forces pull at it; else what drags at it (friction) is resolved step by step.
void LimitEvents::pull(double time, const std::vector<Stretch>& stretches, VectorX& state) {
  std::vector<RopePull> pulls;
  for (const Stretch& stretch : stretches) {
    const Limit& limit = assembly_.limits[stretch.limit];
    const auto [a, b] = bodiesOf(limit);
    island_.wake(a), island_.wake(b);
    pulls.push_back({&limit, stretch.reboundSpeed});
  }
  const VectorX before = state;
  ConstraintSolver solver(assembly_.mechanism.constraints, assembly_.mechanism.bodies);
  if (solver.hasConstraints()) solver.factorize(state);
  applyPulls(pulls, assembly_.mechanism.bodies, solver, state);
  impactEnergy(state) += energyTakenBy(pulls, before, state);
  if (!assembly_.mechanism.driven.empty())
    pushWork(state) += workOfDriven(pulls, ledVelocities(assembly_.mechanism.bodies, solver, before));
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const auto& [limit, speed, reboundSpeed, isLoaded] = stretches[i];
    const bool rebounds = reboundSpeed > 0;
    const double lengthening = motionOf(assembly_.limits[limit], state).lengthening;
    if (lengthening < -(reboundSpeed + kRestSpeedFloor + kPullRounding * speed)) continue;  // others pulled it short
    if (!isStretched_[limit] || rebounds) record(time, EventKind::taut, limit, pulls[i].impulse, state);
    isStretched_[limit] = !rebounds;
    if (!rebounds && isLoaded) tautRow_[limit] = 0, tensionScales_[limit] = usualTension(limit);
  }
  bookNumerical(energyConstant(assembly_.mechanism, before), assembly_.mechanism, state);
  rebuildConstraints();
  if (!solver.hasConstraints()) return;
  const VectorX pulled = state;
  solver.factorize(state);
  solver.constrainVelocities(state);
  bookProjection(pulled, assembly_.mechanism, state);
}

/// A limit closes as a contact where it lengthens. An impulse along the line of both ends has the same effect wherever
/// on that line it acts: at end A for both bodies.
ImpactContact LimitEvents::contactOf(const Limit& limit, const VectorX& state) {
  const LimitMotion motion = motionOf(limit, state);
  Contact contact;
  std::tie(contact.bodyA, contact.bodyB) = bodiesOf(limit);
  contact.point = motion.a.position, contact.normal = motion.direction;
  contact.separation = motion.slackLength;
  return {contact, {restitutionOf(limit), 0, 0}, 0, Vec3::Zero()};
}

std::vector<const Limit*> LimitEvents::withinReach(const VectorX& before, const VectorX& state, double length) const {
  std::vector<const Limit*> limits;
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    const Limit& limit = assembly_.limits[i];
    if (isTaut(i) || rests(i)) continue;
    const LimitMotion from = motionOf(limit, before), to = motionOf(limit, state);
    const auto speed = [](const LimitMotion& motion) { return motion.a.velocity.norm() + motion.b.velocity.norm(); };
    if (from.slackLength > kLimitReach * length * std::max(speed(from), speed(to)) + kNearRatio * sizeOf(limit))
      continue;
    limits.push_back(&limit);
  }
  return limits;
}

std::vector<ImpactContact> LimitEvents::beginImpact(const VectorX& state) {
  std::vector<ImpactContact> impacts;
  members_.clear();
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    const Limit& limit = assembly_.limits[i];
    const LimitMotion motion = motionOf(limit, state);
    if (!isTaut(i) && motion.slackLength > kTautRatio * sizeOf(limit)) continue;
    members_.push_back({i, isTaut(i)});
    tautRow_[i] = -1;
    impacts.push_back(contactOf(limit, state));
    impacts.back().contact.separation = 0;
  }
  rebuildConstraints();
  return impacts;
}

void LimitEvents::endImpact(double time, const std::vector<ImpactContact>& impacts, const VectorX& state) {
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const auto [limit, wasTaut] = members_[k];
    const LimitMotion motion = motionOf(assembly_.limits[limit], state);
    const double speed = motion.a.velocity.norm() + motion.b.velocity.norm();
    const bool shortens = motion.lengthening < -(kRestSpeedFloor + kPullRounding * speed);
    const double impulse = impacts[k].impulse.norm();
    if (wasTaut && shortens) loosen(time, limit, state);
    if (wasTaut && !shortens) tautRow_[limit] = 0;
    if (wasTaut || impulse == 0) continue;
    record(time, EventKind::taut, limit, impulse, state);
    isStretched_[limit] = !shortens;
  }
  rebuildConstraints();
}

void LimitEvents::giveWay(const std::vector<Contact>& touching) {
  if (touching.empty() || !hasLimits()) return;
  const std::vector<RigidBody>& bodies = assembly_.mechanism.bodies;
  const auto isDriven = [&](int body) { return body != kFixed && bodies[static_cast<std::size_t>(body)].isDriven(); };
  const auto moves = [&](int body) { return body != kFixed && !isDriven(body); };
  DisjointSets clusters(bodies);
  for (const Constraint& tie : assembly_.mechanism.constraints) clusters.join(tie.anchorA.body, tie.anchorB.body);
  // By the first body of a cluster: whether one of it touches anything, and whether one touches, or is tied to, what is
  // driven.
  std::vector<char> touches(bodies.size(), 0), isLed(bodies.size(), 0);
  const auto note = [&](int body, int other, bool areTouching) {
    if (!moves(body)) return;
    const std::size_t cluster = static_cast<std::size_t>(clusters.islandOf(body));
    if (areTouching) touches[cluster] = 1;
    if (isDriven(other)) isLed[cluster] = 1;
  };
  for (const Constraint& tie : assembly_.mechanism.constraints)
    note(tie.anchorA.body, tie.anchorB.body, false), note(tie.anchorB.body, tie.anchorA.body, false);
  for (const Contact& contact : touching)
    note(contact.bodyA, contact.bodyB, true), note(contact.bodyB, contact.bodyA, true);
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    if (!isTaut(i)) continue;
    const bool isStop = std::holds_alternative<JointLimit>(assembly_.limits[i]);
    const auto [a, b] = bodiesOf(assembly_.limits[i]);
    for (const int body : {a, b}) {
      if (!moves(body)) continue;
      const std::size_t cluster = static_cast<std::size_t>(clusters.islandOf(body));
      if (touches[cluster] && (isStop || isLed[cluster])) tautRow_[i] = -1;
    }
  }
  rebuildConstraints();
}

void LimitEvents::release(double time, std::size_t limit, const VectorX& state) {
  tautRow_[limit] = -1;
  rebuildConstraints();
  loosen(time, limit, state);
}

void LimitEvents::loosen(double time, std::size_t limit, const VectorX& state) {
  if (isStretched_[limit]) record(time, EventKind::slack, limit, 0, state);
  isStretched_[limit] = false;
}

void LimitEvents::rebuildConstraints() {
  Constraints& constraints = assembly_.mechanism.constraints;
  constraints.resize(sceneConstraints_);
  for (std::size_t i = 0; i < tautRow_.size(); ++i) {
    if (!isTaut(i)) continue;
    tautRow_[i] = rowCount(constraints);
    constraints.push_back(constraintOf(assembly_.limits[i]));
  }
}

/// Normals go from a to b: along a rope, and where A strikes a stop of B the way in which it does.
void LimitEvents::record(double time, EventKind kind, std::size_t limit, double impulse, const VectorX& state) {
  const LimitMotion motion = motionOf(assembly_.limits[limit], state);
  const auto [a, b] = assembly_.limitBodies[limit];
  if (std::holds_alternative<JointLimit>(assembly_.limits[limit])) {
    kind = kind == EventKind::taut ? EventKind::impact : EventKind::release;
    island_.log.record({time, kind, a, b, motion.a.position, motion.direction, impulse});
  } else {
    island_.log.record({time, kind, a, b, motion.a.position, -motion.direction, impulse});
  }
}

}  // namespace cradle
