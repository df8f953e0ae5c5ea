#include "simulate/events/event_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "constraints/invariants.h"
#include "core/error.h"
#include "simulate/ledger_quadrature.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kShortCorrection = 1e-3;   // of the step: longest Newton step to the instant of an impact
constexpr double kSlopeRatio = 1e-6;        // of the step, to find the slope of a gap
constexpr double kMaxLengthGrowth = 2;      // of the longest of the last steps: searches far ahead are mostly in vain
constexpr double kMinLookahead = 1.0 / 64;  // of the step that the accuracy allows
constexpr double kTurnsOfAStep = 3;         // a step is stable over so many times in which friction turns a sliding
constexpr int kMaxShortSteps = 1000;        // in a row; after an event some are short
constexpr int kMaxRopeRounds = 100;         // of ropes and contacts at one instant; the others come after the next step
// Of the size: an error of constraints that is rounding, also of those about the origin, whose own are smaller still.
constexpr double kTieRounding = 1e-12;
constexpr double kMaxStepRatio = 1.0 / 8;  // of what a driven body takes to come to its like
// Of a step near a dead point, one after the other: a stage within 1e-4 rad of the point itself spoils any of them.
constexpr double kLengthsAcross[] = {1, 1.6, 2.7, 6, 15};
// s. The stages of a step amplify errors of the velocities that motors hold by its length over the time in which these
// decay, to the eighth power over 8!: 25 times that time made 5e-10 of rounding, 3 times that leaves it rounding.
constexpr double kMaxHeldStep = 3 / kMotorRelaxation;
constexpr double kSmoothRatio = 0.9;  // of the longest step in which forces of motors would be known
constexpr int kMaxDoubts = 20;        // steps for one event that the interpolant has and the step may not
constexpr int kMaxMotorRounds = 3;    // of motors and contacts; those that change each other go on in the next step

const EventRateLimit& eventRateLimitOf(const ChosenMethod& method, double accuracy, bool isTrial) {
  if (method.keepsPromise) return kLongEventRateLimit;
  if (isTrial) return kTrialEventRateLimit;
  return accuracy > kVisualAccuracy ? kVisualEventRateLimit : kEventRateLimit;
}

/// Whether two states differ by rounding alone.
bool isSame(const VectorX& a, const VectorX& b) {
  return ((a - b).array().abs() <= EventTolerances::kStateRounding * (1 + b.array().abs())).all();
}

/// Errors of orientations add up over rotations: a body that rotates by more than 100 rad in the run has a tenth of the
/// tolerance.
VectorX toleranceOf(const ChosenMethod& method, const VectorX& state, double duration) {
  VectorX tolerance = stateTolerance(bodyCount(state), method.tolerance, method.tolerance);
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    if (angularVelocity(state, body).norm() * duration > EventTolerances::kLargeRotation)
      tolerance.segment<4>(body * kPoseSize + 3) *= EventTolerances::kTurningRatio;
  return tolerance;
}

/// Whether constraints close a loop of two moving bodies or more. What is fixed or driven counts as one body.
bool isLinkage(const Mechanism& mechanism) {
  const int fixed = static_cast<int>(mechanism.bodies.size());
  const auto elementOf = [&](int body) {
    return body != kFixed && !mechanism.bodies[static_cast<std::size_t>(body)].isDriven() ? body : fixed;
  };
  std::set<std::pair<int, int>> pairs;
  for (const Constraint& constraint : mechanism.constraints)
    pairs.insert(std::minmax({elementOf(constraint.anchorA.body), elementOf(constraint.anchorB.body)}));
  return closeALoop(pairs, mechanism.bodies.size() + 1);
}

/// One Newton step to where a gap s closes that was `earlier` a time `before`: theta = -s / s' with s' = (s - earlier)
/// / before. Zero where the gap does not close, which is then rounding.
double untilClosed(double gap, double earlier, double before) {
  return earlier > gap ? gap * before / (earlier - gap) : 0;
}

}  // namespace

EventMotion::EventMotion(IslandState& island, LimitEvents& ropes, const ChosenMethod& method, bool isTrial)
    : island_(island),
      ropes_(ropes),
      method_(method),
      tolerances_(eventTolerancesOf(eventScalesOf(island))),
      contacts_(island, ropes, tolerances_, isTrial),
      motors_(island),
      solver_(island.assembly.mechanism.constraints, island.assembly.mechanism.bodies),
      eventRateLimit_(eventRateLimitOf(method, island.scene.accuracy, isTrial)),
      tolerance_(toleranceOf(method, island.state, island.scene.duration)),
      windowStart_(island.time),
      isLinkage_(isLinkage(island.assembly.mechanism)) {
  lengths_.fill(island_.scene.duration);
  stepSize_.order = method_.order;
  island_.step.startDerivativeIsKnown = false;
  island_.findNearPairsNow(tolerances_.reach);
  ropes_.setTimeStep(0);
  island_.equations.setMotorSteps(0);
  motors_.resolve({});
  contacts_.resolve();
  applyLimitEvents();
  resolveMotors({});
  makeChanges();
  island_.requireUnsolvedPairsApart();
  if (solver_.hasConstraints()) solver_.factorize(island_.state);
  startConstraintError_ = solver_.largestError();
  // The guard starts here: overlaps and errors of constraints that time stepping left are taken out by now, and their
  // energy with them.
  if (island_.time > 0 && solver_.hasConstraints()) {
    const VectorX before = island_.state;
    project(island_.state);
    bookProjection(before, island_.assembly.mechanism, island_.state);
  }
  guard_.emplace(island_.assembly, island_.state, method_, island_.scene.duration);
}

void EventMotion::advance(double frame) {
  double& time = island_.time;
  Step& step = island_.step;
  const std::optional<KnownGaps::Closing> hidden = contacts_.nextHidden();
  const double stepEnd = std::min({island_.lastStepEnd, island_.nextChange(), contacts_.active().nextFreeDirection(),
                                   hidden ? hidden->time : INFINITY});

  // How far do bodies move until the first event?
  std::optional<Event> found = stepToFirstEvent(stepEnd);
  if (!found) return;
  Event& event = *found;
  time = step.time + step.timeStep;
  if (!event.any() && time > stepEnd - kTimeRounding * step.timeStep) time = stepEnd;
  if (!event.any() && hidden && time == hidden->time) {
    event.impact.emplace();
    event.impact->fraction = 1, event.impact->pair = hidden->pair;
  }

  // The interpolant is that of the forces that act until the event.
  if (time > frame) prepareInterpolant(island_.rightHandSide, step);
  const Mechanism& mechanism = island_.assembly.mechanism;
  contactsOfStep_ = mechanism.contacts, bodiesOfStep_ = bodiesInContact();
  supportsOfStep_ = island_.resting.supports();
  constraintsOfStep_ = mechanism.constraints, pushesOfStep_ = mechanism.pushes;
  motorsOfStep_ = mechanism.motors;

  ledgerOfStep_.reset();
  if (std::isfinite(toleranceOfWork_)) {
    prepareInterpolant(island_.rightHandSide, step);
    ledgerOfStep_ = integralOfLedger(island_.equations, mechanism, step, toleranceOfWork_);
    setLedger(*ledgerOfStep_, step, 1, step.state);
  }
  bookStep(mechanism, step);

  // Remove the drift that velocities cannot see. Then what changes at the event?
  island_.state = step.state;
  projectState();
  ropes_.followTurns(time, island_.state);
  changeForces(event);
  guard_->check(island_.state, time, step.timeStep);
  island_.requireUnsolvedPairsApart();
  if (event.any()) countEvent(event);
}

/// Takes a step that ends at the first event in it. Empty if friction jams: then none is accurate.
std::optional<EventMotion::Event> EventMotion::stepToFirstEvent(double stepEnd) {
  if (!takeStep(stepEnd)) return std::nullopt;
  Event event = stopAtFirstEvent();
  const auto stepAgain = [&] { return takeStep(stepEnd) && (event = stopAtFirstEvent(), true); };
  // Where forces change so fast that the interpolant does not tell them, the next step ends where it has an event.
  for (int i = 0; i < kMaxDoubts && event.doubtful > 0; ++i) {
    keepStartDerivative(island_.step);
    stepSize_.timeStep = event.doubtful;
    if (!stepAgain()) return std::nullopt;
  }
  while (event.any() && !isStillAccurate())
    if (!stepAgain()) return std::nullopt;
  return event;
}

/// Takes steps from the same state until one is as accurate as asked. False if friction jams: then none is.
bool EventMotion::takeStep(double stepEnd) {
  Step& step = island_.step;
  if (std::exchange(isContinuous_, false)) carryEndDerivative(step);
  if (stepSize_.timeStep == 0) {
    beginStep(island_.rightHandSide, island_.state, island_.time, stepEnd - island_.time, step);
    stepSize_.timeStep = firstTimeStep(island_.rightHandSide, tolerance_, step, method_.order);
  }
  while (!isTooShort()) {
    const double planned = std::min(stepSize_.timeStep, longestStep()), left = stepEnd - island_.time;
    const double length = planned >= left * (1 - kTimeRounding) ? left : planned;
    integrate(length, left);
    if (acceptStep(method_.errorNorm(step, tolerance_), step.timeStep, stepSize_)) break;
    keepStartDerivative(step);
  }
  if (areForcesUnbounded_ || isSlowAtJoint()) return false;
  toleranceOfWork_ = cradle::toleranceOfWork(method_, island_.assembly.mechanism, step);
  shortSteps_ = stepSize_.timeStep < tolerances_.shortTimeStep ? shortSteps_ + 1 : 0;
  if (shortSteps_ <= kMaxShortSteps) return true;
  if (!noteUnboundedForces()) guard_->failAtShortSteps(island_.state, island_.time, step.timeStep);
  return false;
}

/// Takes a step of a length, or one that is longer and goes across a dead point. `left` (s) is the longest.
void EventMotion::integrate(double length, double left) {
  island_.equations.setProjecting(false);
  island_.integrate(method_.integrate, length);
  isAtDeadPoint_ = false;
  if (!isLinkage_) return;
  const double error = method_.errorNorm(island_.step, tolerance_);
  if (error <= 1 && !goesFarFromConstraints()) return;
  isAtDeadPoint_ = !std::isfinite(error) || goesFarFromConstraints();
  if (integrateAcrossDeadPoint(length, left)) return;
  isAtDeadPoint_ = false;
  keepStartDerivative(island_.step);
  island_.equations.setProjecting(false);
  island_.integrate(method_.integrate, length);
}

/// Near a dead point stages that are off the manifold of the constraints have accelerations without bound; those that
/// are on it have, to rounding, those of the motion, unless they are at the point itself. Shorter steps end nearer to
/// it: where they are rejected too, longer ones are tried. False if none is accurate.
bool EventMotion::integrateAcrossDeadPoint(double length, double left) {
  island_.equations.setProjecting(true);
  for (const double factor : kLengthsAcross) {
    if (factor > 1 && !stepSize_.afterRejection) return false;
    if (factor * length > left) return false;
    keepStartDerivative(island_.step);
    island_.integrate(method_.integrate, factor * length);
    if (method_.errorNorm(island_.step, tolerance_) <= 1 && !goesFarFromConstraints()) return true;
  }
  return false;
}

/// Whether steps have become too short to go on, as friction jams.
bool EventMotion::isTooShort() {
  if (!stepSize_.afterRejection || stepSize_.timeStep >= tolerances_.shortestTimeStep) return false;
  if (!noteUnboundedForces()) guard_->failAtShortestStep(island_.state, island_.time);
  return true;
}

/// Whether rounding of the forces of a contact near a joint, and no motion, keeps steps short.
bool EventMotion::isSlowAtJoint() {
  slowSteps_ = stepSize_.timeStep < tolerances_.slowTimeStep ? slowSteps_ + 1 : 0;
  if (method_.keepsPromise || slowSteps_ <= kMaxShortSteps) return false;
  slowSteps_ = 0;
  contacts_.noteShortMomentArms(EventTolerances::kUnboundedMomentArm);
  return !contacts_.fallbackReason().empty();
}

/// Forces of a sliding contact may grow without bound, or have no finite solution, where its friction presses it
/// together (P. Painleve, 1895): velocities jump there without an impact. Forces also grow without bound where the
/// moment arm about a joint goes to zero. Time stepping, whose unknowns are impulses, goes on.
bool EventMotion::noteUnboundedForces() {
  areForcesUnbounded_ = contacts_.noteUnboundedForces();
  return areForcesUnbounded_;
}

/// Whether a step that was taken again with a shorter length is accurate too: where forces change direction quickly,
/// the error estimate of the long one may be small by chance. If not, the next trial is shorter.
bool EventMotion::isStillAccurate() {
  Step& step = island_.step;
  if (mayEndAnywhere()) return true;
  const double error = method_.errorNorm(step, tolerance_);
  if (error <= 1) return true;
  acceptStep(error, step.timeStep, stepSize_);
  keepStartDerivative(step);
  return false;
}

/// s. Where impacts are frequent, steps are not planned far beyond the next one. A body that driven ones
/// hold has no error, however long a step is: changes of its contacts, ropes and stops are looked for several times in
/// a period of these.
double EventMotion::longestStep() const {
  const Mechanism& mechanism = island_.assembly.mechanism;
  double longest = std::max(kMaxLengthGrowth * *std::max_element(lengths_.begin(), lengths_.end()),
                            kMinLookahead * stepSize_.timeStep);
  if (!mechanism.contacts.empty() || ropes_.hasLimits())
    for (const DrivenBody& driven : mechanism.driven)
      longest = std::min(longest, kMaxStepRatio * timeScale(driven.motion, island_.time));
  if (motors_.anyHolds()) longest = std::min(longest, kMaxHeldStep);
  return std::min(longest, longestHeld_);
}

/// Whether the step may end on its interpolant, which is as accurate as the step: that of DOPRI5.
bool EventMotion::mayEndAnywhere() const {
  return island_.step.interpolant == InterpolantKind::degreeFour;
}

EventMotion::Event EventMotion::findFirstEvent() {
  Step& step = island_.step;
  if (mayEndAnywhere()) contacts_.active().noteEnd();
  prepareInterpolant(island_.rightHandSide, step);
  Event event;
  if (island_.mayTouch()) {
    island_.findNearPairs(tolerances_.reach);
    event.impact = island_.search.first(step, contacts_.touching());
  }
  event.rope = ropes_.firstChange(step);
  event.contact = contacts_.active().firstChange();
  event.motor = motors_.firstChange(step);
  const auto fractionOf = [](const auto& found) { return found ? found->fraction : 2; };
  const double impact = fractionOf(event.impact), rope = fractionOf(event.rope), contact = fractionOf(event.contact),
               motor = fractionOf(event.motor), first = std::min({impact, rope, contact, motor});
  if (rope > first) event.rope.reset();
  if (contact > first || event.rope) event.contact.reset();
  if (motor > first || event.rope || event.contact) event.motor.reset();
  if (impact > first || event.rope || event.contact || event.motor) event.impact.reset();
  for (const double other : {impact, rope, contact, motor})
    if (other > first) event.latest = std::min(event.latest, other);
  return event;
}

/// Cuts the step at the first event in it. The state there is that of a step of its own, as the error of the
/// interpolant would let bodies overlap; with DOPRI5 it is the interpolant's, which is as good as the step.
EventMotion::Event EventMotion::stopAtFirstEvent() {
  if (!island_.mayTouch() && !ropes_.hasLimits() && !motors_.any()) return {};
  Step& step = island_.step;
  Event event = findFirstEvent();
  const double whole = step.timeStep, latest = event.latest * whole;
  const double smooth = motors_.smoothPart();
  longestHeld_ = kSmoothRatio * smooth * whole;
  if (smooth < 1) {
    event = {};
    event.doubtful = longestHeld_;
    return event;
  }
  if (event.any() && mayEndAnywhere()) {
    cutAtEvent(event);
  } else if (event.impact) {
    if (!stopAtImpact(*event.impact)) event.impact.reset();
  } else if (event.rope) {
    endStepBefore(event.rope, latest, kRopeTolerance, event,
                  [&](const VectorX& state) { return ropes_.margin(*event.rope, state); });
  } else if (event.motor) {
    endStepBefore(event.motor, latest, EventTolerances::kEventFunction, event,
                  [&](const VectorX& state) { return motors_.margin(*event.motor, state); });
  } else if (event.contact && event.contact->kind == ContactChange::Kind::redundant) {
    keepStartDerivative(step);
    island_.integrate(method_.integrate, event.contact->fraction * whole);
  } else if (event.contact) {
    // Where forces change so fast that the interpolant does not tell them, the step itself may have no such change, or
    // only behind another one, which is searched for in a shorter step then.
    const double tolerance = EventTolerances::kEventFunction, fraction = event.contact->fraction;
    const double last = std::min(latest, event.contact->latest * whole);
    const auto end = [&] {
      return endStepAtEvent(island_, method_.integrate, {fraction * whole, last, tolerance},
                            [&](const VectorX& state) { return contacts_.active().margin(*event.contact, state); });
    };
    const std::vector<ContactConstraint> unaimed = island_.assembly.mechanism.contacts;
    const bool isAimed = event.contact->kind == ContactChange::Kind::stick && contacts_.active().aimAtStop(fraction);
    double left = end();
    if (isAimed && left > tolerance) island_.assembly.mechanism.contacts = unaimed, left = end();
    if (left > tolerance && (last < latest || latest == whole))
      event.contact.reset(), event.doubtful = fraction * whole;
  }
  if (island_.mayTouch()) lengths_[lengthIndex_++ % lengths_.size()] = step.timeStep;
  return event;
}

/// Ends the step at a change of a limit or a motor. A change that only the interpolant has is not looked for behind the
/// next one of its kind: it is doubtful.
template <class Change>
void EventMotion::endStepBefore(std::optional<Change>& change, double latest, double tolerance, Event& event,
                                const EventFunction& margin) {
  const double whole = island_.step.timeStep, root = change->fraction * whole;
  const double last = std::min(latest, change->latest * whole);
  const double left = endStepAtEvent(island_, method_.integrate, {root, last, tolerance}, margin);
  if (left > tolerance && last < latest) change.reset(), event.doubtful = root;
}

/// Cuts the step on its interpolant.
void EventMotion::cutAtEvent(Event& event) {
  Step& step = island_.step;
  double fraction = event.impact  ? event.impact->fraction
                    : event.rope  ? event.rope->fraction
                    : event.motor ? event.motor->fraction
                                  : event.contact->fraction;
  if (event.impact) {
    const std::optional<double> closed = fractionOfImpact(*event.impact);
    if (closed)
      fraction = *closed;
    else
      event.impact.reset();
  }
  cutStep(fraction, step);
  place(island_.assembly.mechanism.driven, step.time + step.timeStep, step.state);
}

/// Where, on the interpolant, the gap of an impact closes once the state is projected: one Newton step from where it
/// closes before that. Empty if the gap is still open there.
std::optional<double> EventMotion::fractionOfImpact(const ImpactTime& impact) {
  const double fraction = impact.fraction, tolerance = tolerances_.closedGap;
  if (contacts_.active().empty() && !solver_.hasConstraints()) return fraction;
  Step& step = island_.step;
  const auto gapAt = [&](double at) {
    interpolate(step, at, step.work);
    return projectedGap(impact, step.work);
  };
  const double left = gapAt(fraction);
  if (std::abs(left) <= tolerance) return fraction;
  const double before = kSlopeRatio * fraction, correction = untilClosed(left, gapAt(fraction - before), before);
  if (std::abs(correction) <= kShortCorrection * fraction && std::abs(gapAt(fraction + correction)) <= tolerance)
    return fraction + correction;
  return left > tolerance ? std::nullopt : std::optional(fraction);
}

/// Ends the step where a gap closes. The gap s that the interpolant's error leaves is taken out by one Newton step
/// along the end derivative. The gap is that of the projected state, as contacts that close at one
/// instant are told apart by what projection would leave of it. False if the gap is still open at the instant of the
/// interpolant: no later impact has been searched for, so the step ends there without an event.
bool EventMotion::stopAtImpact(const ImpactTime& impact) {
  const auto gap = [&](const VectorX& state) { return projectedGap(impact, state); };
  Step& step = island_.step;
  const double length = impact.fraction * step.timeStep;
  keepStartDerivative(step);
  island_.integrate(method_.integrate, length);
  evaluateEndDerivative(island_.rightHandSide, step);
  const double left = gap(step.state), before = kSlopeRatio * length;
  step.work = step.state - before * step.endDerivative;
  const double correction = untilClosed(left, gap(step.work), before);
  step.work = step.state + correction * step.endDerivative;
  const double tolerance = tolerances_.closedGap;
  if (!(std::abs(correction) <= kShortCorrection * length && std::abs(gap(step.work)) <= tolerance))
    return endStepAtEvent(island_, method_.integrate, {length, length, tolerance}, gap) <= tolerance;
  std::swap(step.state, step.work);
  step.timeStep += correction;
  return true;
}

/// m: how far an impact is from happening in a state, once that is projected.
double EventMotion::projectedGap(const ImpactTime& impact, const VectorX& state) {
  projected_ = state;
  project(projected_);
  return island_.search.margin(impact, contacts_.touching(), projected_);
}

/// Projects a state onto the manifold of active contacts and constraints.
void EventMotion::project(VectorX& state) {
  if (!contacts_.active().empty()) island_.equations.project(state);
  if (!solver_.hasConstraints()) return;
  solver_.exclude(island_.equations.resting());
  solver_.project(state);
}

/// Projects the island's state, and keeps motors at their targets. A state that this leaves as it was, to rounding,
/// lets the next step begin with the end derivative of this one, unless ropes may still act on it. Orientations are
/// normalised only then: the equations take their direction alone.
void EventMotion::projectState() {
  VectorX& state = island_.state;
  project(state);
  island_.equations.keepTargets(state);
  bool isTouched = false;
  if (!contacts_.active().empty() || solver_.hasConstraints()) {
    isTouched = !isSame(state, island_.step.state);
    if (!offConstraintsFrom_ && (isAtDeadPoint_ || isFarFromConstraints(state))) offConstraintsFrom_ = island_.time;
    bookProjection(island_.step.state, island_.assembly.mechanism, state);
  }
  if (solver_.hasConstraints()) requireConstraintsKept();
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    isTouched = isTouched || std::abs(orientation(state, body).squaredNorm() - 1) > EventTolerances::kUnitLength;
  if (isTouched) normalizeOrientations(state);
  isContinuous_ = !isTouched && !ropes_.hasLimits();
}

/// Whether projection would move the end of the step that was taken by more than the accuracy.
bool EventMotion::goesFarFromConstraints() {
  projected_ = island_.step.state;
  project(projected_);
  return isFarFromConstraints(projected_);
}

/// Whether projection to `state` has moved bodies by more than the accuracy, in a step with an error of a part of it.
bool EventMotion::isFarFromConstraints(const VectorX& state) const {
  const VectorX& stepped = island_.step.state;
  const Eigen::Index count = state.size() - kLedgerSize;
  const auto moved = (state - stepped).head(count).array().abs() / (1 + stepped.head(count).array().abs());
  return moved.maxCoeff() > island_.scene.accuracy;
}

/// Ends the run where constraints cannot be kept, or leave no motion: their forces are without bound, and the bodies
/// stop. The error that anchors had at the start stays.
void EventMotion::requireConstraintsKept() {
  const VectorX& state = island_.state;
  const double error = solver_.largestError(), size = state.head(poseComponents(state)).cwiseAbs().maxCoeff();
  if (error > startConstraintError_ + tolerances_.constraintError * (1 + size) ||
      solver_.leaveNoMotion(state, startConstraintError_ + kTieRounding * tolerances_.scales.size))
    guard_->failAtConstraints(state, island_.time, error);
}

/// Makes the changes of an event: impacts, active contacts, ropes, pushes.
void EventMotion::changeForces(const Event& event) {
  tautRowsBefore_ = ropes_.tautRows();
  const bool lasted = !contacts_.active().empty();
  if (event.impact || event.contact || event.rope)  // a rope may go taut as bodies meet
    contacts_.resolve(event.contact, event.impact ? std::optional(event.impact->pair) : std::nullopt);
  else
    followActive();  // those of the step: a motor may change them
  if (event.motor) resolveMotors(event.motor);
  if (!lasted && !contacts_.active().empty()) lengths_.fill(island_.scene.duration);  // no more bounces
  const bool haveLimitsChanged = applyLimitEvents();
  if (event.any() && (!event.motor || haveLimitsChanged)) resolveMotors({});
  const bool isPushed = makeChanges();
  keepsConstraints_ = ropes_.tautRows() == tautRowsBefore_;
  if (event.any() || isPushed) isContinuous_ = false;
}

/// Lets pushes begin and end: what was in equilibrium may not be any more. True if there were any.
bool EventMotion::makeChanges() {
  if (!island_.makeChanges()) return false;
  contacts_.resolve();
  applyLimitEvents();
  resolveMotors({});
  return true;
}

/// Motors, and what their other forces change of contacts, ropes and stops; what that does to motors in turn.
void EventMotion::resolveMotors(const std::optional<MotorChange>& change) {
  bool isOther = motors_.resolve(change);
  for (int round = 0; isOther && round < kMaxMotorRounds; ++round) {
    contacts_.resolve();
    applyLimitEvents();
    isOther = motors_.resolve({});
  }
}

/// Follows active contacts along a step without an event.
void EventMotion::followActive() {
  if (const std::optional<double> turningTime = contacts_.active().followSliding()) {
    isContinuous_ = false;
    stepSize_.timeStep = std::min(stepSize_.timeStep, kTurnsOfAStep * *turningTime);
  }
  if (!method_.keepsPromise) contacts_.noteShortMomentArms();
}

/// Limits, contacts and motors in turn: each may load or release the others. True if any limit changes.
bool EventMotion::applyLimitEvents() {
  int round = 0;
  for (; round < kMaxRopeRounds && ropes_.resolve(island_.time, island_.state); ++round) {
    contacts_.resolve();
    motors_.resolve({});
  }
  return round > 0;
}

bool EventMotion::isAtRest() const {
  return island_.mayTouch() && island_.resting.allRest() && island_.time < island_.nextChange();
}

void EventMotion::restUntil(double time) {
  island_.time = std::min(time, island_.nextChange());
  makeChanges();
  isContinuous_ = false;
}

void EventMotion::countEvent(const Event& event) {
  if (island_.time > windowStart_ + eventRateLimit_.window) windowStart_ = island_.time, eventsInWindow_ = 0;
  const bool isFailure = event.contact && event.contact->kind == ContactChange::Kind::redundant;
  const bool takesNoTime = event.contact && island_.step.timeStep < tolerances_.shortestTimeStep;
  changesWithoutTime_ = takesNoTime ? changesWithoutTime_ + 1 : 0;
  eventsInWindow_ += isFailure ? eventRateLimit_.ofAFailure : 1;
  if (method_.keepsPromise && eventsInWindow_ > eventRateLimit_.most) failAtManyEvents();
}

/// A promise without such a condition is not given up: the run ends instead.
void EventMotion::failAtManyEvents() const {
  throw Error(
      ErrorKind::limit, "",
      fmt::format("more than {} impacts, pulls of ropes and changes of contacts, stops and motors in {:.3g} s at "
                  "{:.6g} s, at last of {}; lower a restitution near 1, damp what jerks at ropes, or weaken "
                  "what presses joints against their stops",
                  eventRateLimit_.most, eventRateLimit_.window, island_.time,
                  namesOfBodies(fallbackBodies(), island_.scene)));
}

/// Whether steps or changes of contacts follow each other without time: forces grow without bound, or contacts that
/// carry load in the frictional contact problem would have to pull in the equations of motion, or stop to slide at
/// once.
bool EventMotion::isJammed() const {
  return areForcesUnbounded_ || changesWithoutTime_ > kEventRateLimit.most;
}

std::string_view EventMotion::fallbackReason() const {
  if (method_.keepsPromise) return isJammed() ? contacts_.fallbackReason() : std::string_view();
  if (eventsInWindow_ > eventRateLimit_.most) return eventRateLimit_.reason;
  return contacts_.fallbackReason();
}

std::vector<int> EventMotion::fallbackBodies() const {
  if (!contacts_.fallbackReason().empty()) return contacts_.fallbackBodies();
  // Changes of redundant contacts and of motors name none: there may have been no others.
  if (!island_.log.latestBodies().empty()) return island_.log.latestBodies();
  const std::vector<int> touching = contacts_.sceneBodies();
  return touching.empty() ? island_.assembly.sceneBodies : touching;
}

}  // namespace cradle
