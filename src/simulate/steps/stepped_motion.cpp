#include "simulate/steps/stepped_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "constraints/invariants.h"
#include "core/error.h"
#include "dynamics/integrators/rk4.h"
#include "simulate/events/contact_features.h"
#include "simulate/events/event_location.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/rows_of_contacts.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

// Of a size: contact steps leave overlaps of a thousandth where bodies have room. [5e-3, 0.1]
constexpr double kSqueezed = 0.02;
constexpr double kShortestRatio = 1.0 / 1024;  // of a step: shorter ones are not cut for their error
constexpr double kMaxPartGrowth = 4;           // of a part of a step to the next
constexpr double kMaxConstraintErrorGrowth =
    2;  // times the error of free motion, of constraints that contradict each other
constexpr double kMinConstraintStep = 1.0 / 32;  // of a step: shorter ones are not cut for constraint errors
constexpr double kAllOfAForce = 1e-9;            // of a motor's: so much less is all of it
constexpr double kAlikeLoad = 1e-3;              // of the load of a motor: others that differ by less share its fate
constexpr int kMaxServed = 12;                   // contacts
constexpr double kSheetRatio = 0.5;  // of a body's inner radius: its largest displacement in a step beside a sheet
constexpr int kMaxImpactCuts = 2;    // events in a step: with as many, it is not cut at the next impact inside it
constexpr int kManyEvents = 16;      // in a step: beyond, time stepping alone is in use
constexpr int kMaxEvents = 10000;    // within a step

}  // namespace

SteppedMotion::SteppedMotion(IslandState& island, LimitEvents& ropes, const ChosenMethod& method)
    : island_(island),
      ropes_(ropes),
      method_(method),
      contacts_(island, method),
      guard_(island.assembly, island.state, method, island.scene.duration),
      solver_(island.assembly.mechanism.constraints, island.assembly.mechanism.bodies),
      windowStart_(island.time),
      supportsOfStep_(island.resting.supports()),
      begin_(island.time) {
  for (const Collider& collider : island.assembly.geometry.colliders) innerRadii_.push_back(innerRadius(collider));
  countSteps();
  ropes_.setTimeStep(method.timeStep);
  island_.step.startDerivativeIsKnown = false;
  island_.equations.setMotorSteps(method.timeStep);
  island_.equations.setProjecting(false);
  for (JointMotor& motor : island_.assembly.mechanism.motors)
    if (motor.hasTarget) motor.mode = JointMotor::Mode::holds;
  contacts_.resolveImpacts(island_.time, island_.state, ropes_, island_.state);
  ropes_.resolve(island_.time, island_.state);
  if (island_.makeChanges()) ropes_.resolve(island_.time, island_.state);
  island_.requireUnsolvedPairsApart();
  if (solver_.hasConstraints()) solver_.factorize(island_.state);
  startConstraintError_ = solver_.largestError();
}

void SteppedMotion::advance(double frame) {
  double& time = island_.time;
  Step& step = island_.step;
  const double stepEnd = nextStepEnd();
  if (time > windowStart_ + method_.timeStep) windowStart_ = time, eventsInWindow_ = 0;

  // How far do bodies move freely, until which event?
  tautRowsBefore_ = ropes_.tautRows();
  supportsOfStep_ = island_.resting.supports();
  holdReachedTargets();
  moveFreely(stepEnd);
  before_ = island_.state;
  bool atEvent = stopAtFirstEvent();
  atEvent = stopAtNextImpact() || atEvent;
  while (!solveContacts()) {
    shorten();
    atEvent = false;
  }
  time = step.time + step.timeStep;
  if (!atEvent && time > stepEnd - kTimeRounding * step.timeStep) time = stepEnd;

  // The interpolant is that of the forces that act until the event.
  if (time > frame) prepareInterpolant(island_.rightHandSide, step);

  // What changes at the end of the step?
  if (hasContacts_) contacts_.recordAndLetSleep(time, island_.state);
  if (hasContacts_) contactEnd_ = island_.state;
  if (atEvent || !contacts_.usesTimeSteppingOnly()) contacts_.resolveImpacts(time, before_, ropes_, island_.state);
  keepLoads(step.time);
  ropes_.resolve(time, island_.state);
  if (island_.makeChanges()) ropes_.resolve(time, island_.state);
  keepsConstraints_ = ropes_.tautRows() == tautRowsBefore_;
  guard_.check(island_.state, time, step.timeStep);
  requireRoom();
  island_.requireUnsolvedPairsApart();

  if (atEvent) countEvent();
  if (eventsInWindow_ > kManyEvents) contacts_.useTimeSteppingOnly();
  if (time >= static_cast<double>(stepNumber_ + 1) * method_.timeStep) ++stepNumber_;
}

/// Keeps what contacts did in the time since `begin` (s), and at its end; of a step without time with the next one.
void SteppedMotion::keepLoads(double begin) {
  if (begin > island_.time - kTimeRounding * method_.timeStep) return;
  std::vector<ContactLoad> loads = contacts_.takeLoads();
  if (!loads.empty() || !supportsOfStep_->empty())
    loads_.push_back({begin, island_.time, std::move(loads), supportsOfStep_});
  while (!loads_.empty() && loads_.front().end < island_.time - StepContacts::kContactTime - method_.timeStep)
    loads_.pop_front();
}

void SteppedMotion::addMeanLoads(double time, WrenchSum& sum) const {
  const auto loadsOf = [this](const SupportForce& support) {
    return loadOf(support.contact, support.pair, support.force, island_.assembly);
  };
  const bool isInside = time < island_.time - kTimeRounding * method_.timeStep;
  std::vector<std::pair<int, int>> atRest;  // scene bodies
  for (const SupportForce& support : isInside ? *supportsOfStep_ : *island_.resting.supports()) {
    sum.add(loadsOf(support));
    atRest.push_back(bodiesOf(island_.assembly, support.pair));
  }
  std::ranges::sort(atRest);
  const double from = std::max(time - StepContacts::kContactTime, begin_);
  const auto add = [&](const ContactLoad& load, double fraction) {
    if (!std::ranges::binary_search(atRest, std::pair(load.bodyA, load.bodyB))) sum.add(load, fraction);
  };
  for (const StepLoads& step : loads_) {
    const double share = (std::min(step.end, time) - std::max(step.begin, from)) / (time - from);
    if (!(share > 0)) continue;
    for (const ContactLoad& load : step.loads) add(load, share / (step.end - step.begin));
    for (const SupportForce& support : *step.supports) add(loadsOf(support), share);
  }
}

/// Ends the run where driven bodies press others into something, for no force keeps them apart, and where heavy ones
/// do.
void SteppedMotion::requireRoom() const {
  const Assembly& assembly = island_.assembly;
  island_.requireComparableMasses(contacts_.touching());
  if (assembly.mechanism.driven.empty()) return;
  for (const Contact& contact : contacts_.touching())
    if (contact.separation < -kSqueezed * smallestSize(contact, assembly.radii)) island_.failAtNoRoom(contact);
}

void SteppedMotion::addContactMotion(double fraction, VectorX& state) const {
  if (!hasContacts_) return;
  const VectorX& freeEnd = island_.step.state;
  const double square = fraction * fraction;
  const bool hasImpact = contacts_.hasImpact();
  for (Eigen::Index body = 0; body < bodyCount(state); ++body) {
    centerOfMass(state, body) += square * (centerOfMass(contactEnd_, body) - centerOfMass(freeEnd, body));
    const Quat turn = (orientation(contactEnd_, body) * orientation(freeEnd, body).conjugate()).normalized();
    turnBody(state, body, square * 2 * turn.vec());
    // Between the velocities before and after an impact there are none.
    if (hasImpact) continue;
    const Eigen::Index velocity = velocityOffset(state, body);
    state.segment<kVelocitySize>(velocity) +=
        fraction * (contactEnd_.segment<kVelocitySize>(velocity) - freeEnd.segment<kVelocitySize>(velocity));
  }
  // Forces of contacts are constant within the step; they change velocities in proportion to its fraction.
  // So long as velocities are those of free motion, friction has taken nothing.
  const auto [atStart, atEnd] = contacts_.frictionWork();
  if (!hasImpact) frictionEnergy(state) += fraction * atStart + square * (atEnd - atStart);
  dampingEnergy(state) += square * (dampingEnergy(contactEnd_) - dampingEnergy(freeEnd));
  pushWork(state) += square * (pushWork(contactEnd_) - pushWork(freeEnd));
}

/// Steps are counted from the run's start, so that frames whose times are theirs lie at their ends.
void SteppedMotion::countSteps() {
  stepNumber_ = static_cast<long>(std::floor(island_.time / method_.timeStep + kTimeRounding));
}

/// The end of the fixed step under way, or of all; a push that begins or ends comes first.
double SteppedMotion::nextStepEnd() const {
  double end = island_.lastStepEnd;
  const double gridEnd = static_cast<double>(stepNumber_ + 1) * method_.timeStep;
  if (gridEnd <= end - kTimeRounding * method_.timeStep) end = gridEnd;
  return std::min(end, island_.nextChange());
}

/// Projects the end of free motion onto the constraints and solves the contacts of the step. False if a shorter step is
/// to be taken, as contacts left too large a constraint error: they move bodies along straight lines, where light
/// bodies on long moment arms go along arcs.
bool SteppedMotion::solveContacts() {
  const double length = island_.step.timeStep;
  VectorX& state = island_.state;
  const Mechanism& mechanism = island_.assembly.mechanism;
  motorForces_ = island_.equations.motorForces();
  bookStep(mechanism, island_.step);
  state = island_.step.state;
  if (solver_.hasConstraints()) {
    solver_.project(state);
    bookProjection(island_.step.state, mechanism, state);
    if (solver_.leaveNoMotion(state, startConstraintError_))
      guard_.failAtConstraints(state, island_.step.time, solver_.largestError());
  }
  normalizeOrientations(state);
  hasContacts_ =
      !contacts_.touching().empty() && length > kTimeRounding * method_.timeStep;  // no gap closes in no time
  if (!hasContacts_) return true;
  const double free = solver_.hasConstraints() ? solver_.largestError() : 0;
  const double size = state.head(poseComponents(state)).cwiseAbs().maxCoeff();
  ropes_.giveWay(contacts_.touching());
  pushWithAllForce();
  contacts_.solveContacts(before_, length, ropes_, state);
  if (exhaustMotors()) return solveContacts();
  return contacts_.constraintError() <=
             std::max(contacts_.tolerances().constraintError(size), kMaxConstraintErrorGrowth * free) ||
         length < kMinConstraintStep * method_.timeStep;
}

/// Motors that push hold their joint's velocity from the step on in which it comes to the target. Here are those that
/// would come to it if their bodies were free: exhaustMotors finds which do not.
void SteppedMotion::holdReachedTargets() {
  Mechanism& mechanism = island_.assembly.mechanism;
  std::vector<BodyFrame> frames;
  for (JointMotor& motor : mechanism.motors) {
    if (!motor.hasTarget || motor.mode == JointMotor::Mode::holds) continue;
    if (frames.empty()) findBodyFrames(mechanism.bodies, island_.state, frames);
    const ConstraintBlock row = rowOf(motor, island_.state, frames);
    const double missing = motor.sign * (motor.targetVelocity - rateOf(row, 0, island_.state));
    if (missing <= method_.timeStep * motor.maxForce * mobilityOf(row, mechanism.bodies, frames))
      motor.mode = JointMotor::Mode::holds;
  }
}

/// Motors that have not come to their target in free motion, with all their force, hold nothing against contacts.
void SteppedMotion::pushWithAllForce() {
  std::vector<JointMotor>& motors = island_.assembly.mechanism.motors;
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const double force = motorForces_[static_cast<Eigen::Index>(i)];
    if (motors[i].mode == JointMotor::Mode::pushes || std::abs(force) < (1 - kAllOfAForce) * motors[i].maxForce)
      continue;
    motors[i].mode = JointMotor::Mode::pushes, motors[i].sign = force < 0 ? -1 : 1;
  }
}

/// Adds what contacts asked of motors that hold to their forces. The one for which that is most beyond all it has, and
/// those like it, push with that instead: true if there is one, and the step of free motion has been taken again.
bool SteppedMotion::exhaustMotors() {
  Step& step = island_.step;
  std::vector<JointMotor>& motors = island_.assembly.mechanism.motors;
  const auto load = [&](std::size_t i) {
    return std::abs(motorForces_[static_cast<Eigen::Index>(i)]) / motors[i].maxForce;
  };
  double most = 1 - kAllOfAForce;
  for (std::size_t i = 0; i < motors.size(); ++i) {
    if (motors[i].mode == JointMotor::Mode::pushes) continue;
    motorForces_[static_cast<Eigen::Index>(i)] +=
        contacts_.motorImpulses()[static_cast<Eigen::Index>(i)] / step.timeStep;
    most = std::max(most, load(i));
  }
  bool isAny = false;
  for (std::size_t i = 0; i < motors.size(); ++i) {
    if (motors[i].mode == JointMotor::Mode::pushes || load(i) < (1 - kAlikeLoad) * most || load(i) < 1 - kAllOfAForce)
      continue;
    motors[i].mode = JointMotor::Mode::pushes;
    motors[i].sign = motorForces_[static_cast<Eigen::Index>(i)] < 0 ? -1 : 1;
    isAny = true;
  }
  if (!isAny) return false;
  step.startDerivativeIsKnown = false;
  island_.integrate(method_.integrate, before_, step.timeStep);
  return true;
}

void SteppedMotion::shorten() {
  Step& step = island_.step;
  const double half = step.timeStep / 2;
  keepStartDerivative(step);
  island_.integrate(method_.integrate, before_, half);
}

/// s: the longest step in which no body near a sheet, which it may touch already, comes to its other side.
double SteppedMotion::longestBesideSheets() const {
  const ContactGeometry& geometry = island_.assembly.geometry;
  double longest = INFINITY;
  for (const ColliderPair& pair : geometry.pairs) {
    if (pair.againstPlane) continue;
    const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
    const bool isOnB = b.kind() == ColliderKind::mesh && b.mesh->isSheet;
    if (!isOnB && !(a.kind() == ColliderKind::mesh && a.mesh->isSheet)) continue;
    const Collider& solid = isOnB ? a : b;
    const double speed = linearVelocity(island_.state, solid.body).norm() +
                         solid.boundingRadius * angularVelocity(island_.state, solid.body).norm();
    longest = std::min(longest, kSheetRatio * innerRadii_[isOnB ? pair.a : pair.b] / speed);
  }
  return longest;
}

/// Takes a step of free motion to `stepEnd`, or a fraction of it where springs, ropes or rotations are too fast for the
/// whole.
void SteppedMotion::moveFreely(double stepEnd) {
  Step& step = island_.step;
  double length = std::min({stepEnd - island_.time, longest_, longestBesideSheets()});
  island_.integrate(method_.integrate, length);
  if (method_.tolerance == 0) return;
  prepareInterpolant(island_.rightHandSide, step);
  while (!(rk4Error(step, motionComponents(step.state)) <= method_.tolerance) &&
         length > kShortestRatio * method_.timeStep) {
    length /= 2;
    keepStartDerivative(step);
    island_.integrate(method_.integrate, length);
    prepareInterpolant(island_.rightHandSide, step);
  }
  longest_ = kMaxPartGrowth * length;
}

/// Cuts the step at the first event in it. Impacts of pairs that touch already are found with their contacts
/// (stopAtNextImpact): free motion does not tell them.
bool SteppedMotion::stopAtFirstEvent() {
  if (!island_.mayTouch() && !ropes_.hasLimits()) return false;
  Step& step = island_.step;
  prepareInterpolant(island_.rightHandSide, step);
  island_.findNearPairs(contacts_.tolerances().margin());
  contacts_.begin(island_.time, before_, step.state, step.timeStep);
  std::vector<ColliderPair>& pairs = island_.assembly.geometry.pairs;
  const std::vector<ColliderPair> all = pairs;
  pairs = contacts_.pairsWithoutContact();
  TouchingFeatures touching{contacts_.tolerances().touch};
  touching.finest = StepTolerances::kFinestTouch;
  const auto impact = contacts_.usesTimeSteppingOnly() ? std::nullopt : island_.search.first(step, touching);
  const auto change = ropes_.firstChange(step);
  const double whole = step.timeStep;
  if (impact && !(change && change->fraction < impact->fraction)) {
    endStepAtEvent(island_, method_.integrate, {impact->fraction * whole, whole, contacts_.tolerances().closedGap},
                   [&](const VectorX& state) { return island_.search.margin(*impact, {}, state); });
  } else if (change) {
    endStepAtEvent(island_, method_.integrate, {change->fraction * whole, whole, kRopeTolerance},
                   [&](const VectorX& state) { return ropes_.margin(*change, state); });
  }
  pairs = all;
  return impact || change;
}

/// Cuts the step at the next impact inside it of bodies whose other contacts last.
bool SteppedMotion::stopAtNextImpact() {
  Step& step = island_.step;
  if (eventsInWindow_ >= kMaxImpactCuts) return false;
  const double part = contacts_.nextImpact(before_, step.state, step.timeStep);
  if (part > 1) return false;
  const double length = part * step.timeStep;
  keepStartDerivative(step);
  island_.integrate(method_.integrate, length);
  return true;
}

bool SteppedMotion::isAtRest() const {
  return island_.resting.allRest() && island_.time < island_.nextChange();
}

bool SteppedMotion::mayServeEvents() const {
  std::vector<Contact> touching = contacts_.touching();
  findFeatures(island_.assembly.geometry, island_.state, eventTolerancesOf(eventScalesOf(island_)).leaving, touching);
  return std::ssize(touching) <= kMaxServed && std::all_of(touching.begin(), touching.end(), canLast);
}

void SteppedMotion::restUntil(double time) {
  const double begin = island_.time;
  island_.time = std::min(time, island_.nextChange());
  supportsOfStep_ = island_.resting.supports();
  keepLoads(begin);
  countSteps();
  if (island_.makeChanges()) ropes_.resolve(island_.time, island_.state);
}

void SteppedMotion::countEvent() {
  if (++eventsInWindow_ <= kMaxEvents) return;
  throw Error(
      ErrorKind::limit, "",
      fmt::format("more than {} impacts, pulls of ropes and hits of stops within {:.3g} s at {:.6g} s, at last of "
                  "{}; lower a restitution of 1 between bodies that cannot separate, weaken what presses joints "
                  "against their stops, or take a smaller \"timeStep\"",
                  kMaxEvents, method_.timeStep, island_.time,
                  namesOfBodies(island_.log.latestBodies(), island_.scene)));
}

}  // namespace cradle
