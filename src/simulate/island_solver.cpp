#include "simulate/island_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "constraints/invariants.h"
#include "core/error.h"
#include "core/interruption.h"
#include "simulate/ledger_quadrature.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kFallRatio = 1.0 / 300;  // of sqrt(size / g), in which a body falls by half its size
constexpr std::size_t kFewBodies = 4;     // that move: many cost more than such steps are worth

// Of the accuracy: what rates of an interpolant, over its step, may miss of velocities. Where nothing jumps they miss
// less than the accuracy in nearly all frames (of sliding_blocks, belt, shaken_table; 300 times as much in one); where
// friction jumps, 100 to 10^7 times as much.
constexpr double kMaxDefect = 10;
// Of an evaluation, where the contacts of a step are solved: a second then has 1e6 units of work in the scene arch and
// 0.3e6 in dominoes, beside 0.25e6 to 8e6 in others.
constexpr long kWorkOfContact = 16;
constexpr double kMuchSlower = 0.25;  // sliding that loses less in a step is far from its stop

/// s: of contact that events do not serve. A few bodies move as fast as gravity moves them through their own size: the
/// same ones, smaller, take the same steps in less time.
double contactTimeStep(const Assembly& assembly) {
  const double gravity = assembly.mechanism.gravity.norm();
  if (gravity == 0 || assembly.mechanism.bodies.size() > kFewBodies) return kContactTimeStep;
  return std::min(kContactTimeStep, kFallRatio * std::sqrt(smallestSize(assembly.geometry) / gravity));
}

std::string textOf(const PromiseEnd& end, const Scene& scene) {
  return fmt::format("{}: the accuracy asked is not promised from {:.6g} s on: {} ({})", scene.path, end.time,
                     end.reason, namesOfBodies(end.bodies, scene));
}

}  // namespace

IslandSolver::IslandSolver(const Scene& scene, Assembly assembly, const ChosenMethod& method)
    : IslandSolver(scene, std::move(assembly), method, IslandHistory{}) {
  record_.emplace(island_.assembly, scene.accuracy);
}

IslandSolver::IslandSolver(const Scene& scene, Assembly assembly, const ChosenMethod& method,
                           const IslandRecord& record)
    : IslandSolver(scene, std::move(assembly), method, record.parts.front().history) {
  record_.emplace(island_.assembly, scene.accuracy, record.measures);
}

IslandSolver::IslandSolver(const Scene& scene, Assembly assembly, const ChosenMethod& method, IslandHistory history)
    : island_(scene, std::move(assembly)),
      ropes_(island_),
      coordinates_(island_.assembly),
      solver_(island_.assembly.mechanism.constraints, island_.assembly.mechanism.bodies),
      method_(method),
      promiseEnd_(std::move(history.promiseEnd)),
      hasLeftEvents_(history.hasLeftEvents),
      jointStates_(island_.assembly.joints.size()) {
  island_.bumps.goOnFrom(history.bumps);
  if (!history.resting.islands.empty()) island_.resting.goOnFrom(history.resting);
  if (history.isInContactSteps && method.isAdaptive())
    changeToSteps();
  else if (method.isAdaptive())
    moveByEvents(hasLeftEvents_);
  else
    moveBySteps(method);
  changeMotion();
}

const VectorX& IslandSolver::stateAt(double time, const std::function<void(double time)>& reached) {
  const double same = sameTime(time);
  CRADLE_CHECK(time <= island_.scene.duration + same);  // no step goes beyond the end: that would take for ever
  while (island_.time < time - same) {
    throwIfInterrupted();
    advance(time);
    if (isSwept_) swept_.add(island_.step, island_.state);
    if (record_ && method_.isAdaptive()) record_->measure(island_.state);
    if (reached) reached(island_.time);
  }
  report(time, false);
  if (record_) record_->add(time, reported_);
  reportedTime_ = time;
  if (!jointStates_.empty()) findJointStates(time);
  return reported_;
}

const VectorX& IslandSolver::stepToReported() {
  report(reportedTime_, true);
  return reported_;
}

/// Sets the reported state to that at `time`: in a step under way that of its interpolant, or of a step of its own.
void IslandSolver::report(double time, bool byStep) {
  if (island_.time <= time + sameTime(time))
    reported_ = island_.state;
  else
    interpolateAt(time, byStep);
  normalizeOrientations(reported_);
  const std::vector<RigidBody>& bodies = island_.assembly.mechanism.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].hasConstantSpin) rotate(static_cast<Eigen::Index>(i), time, reported_);
}

IslandRecord IslandSolver::record() const {
  CRADLE_CHECK(record_ && island_.time <= reportedTime_ + sameTime(reportedTime_));
  return {reported_, jointStates_, {partRecord()}, record_->measures()};
}

PartRecord IslandSolver::partRecord() const {
  PartRecord part{{}, pushesAt(reportedTime_), history(reportedTime_)};
  part.history.resting = island_.resting.record();
  return part;
}

std::vector<Event> IslandSolver::takeFirstEvents(const std::vector<char>& isToldResting) {
  const auto isTold = [&](int body) { return isToldResting[static_cast<std::size_t>(body)] != 0; };
  std::vector<Event> events;
  for (const Event& event : takeEvents())
    if ((event.kind == EventKind::rest && !isTold(event.bodyA)) || event.kind == EventKind::contactBegin)
      events.push_back(event);
  for (std::size_t i = 0; i < assembly().sceneBodies.size(); ++i)
    if (const int sceneBody = assembly().sceneBodies[i]; isTold(sceneBody) && !isResting(i))
      events.push_back({reportedTime_, EventKind::wake, sceneBody, -1,
                        centerOfMass(reported_, static_cast<Eigen::Index>(i)), Vec3::Zero(), 0});
  return events;
}

void IslandSolver::beginSweep(double to) {
  isSwept_ = true;
  swept_.begin(reportedTime_, to, reported_);
  if (island_.time > reportedTime_) swept_.add(island_.step, island_.state);
}

void IslandSolver::finish() {
  if (!record_ || promiseEnd_ || !method_.isAdaptive()) return;
  const std::optional<ConservationRecord::Loss> loss = record_->firstLoss();
  if (!loss) return;
  promiseEnd_ = endOf(*loss, island_.assembly.sceneBodies, island_.scene);
}

template <class Motion>
void IslandSolver::advance(double time, Motion& motion) {
  if (motion.isAtRest())
    motion.restUntil(time);
  else
    motion.advance(time);
}

void IslandSolver::advance(double time) {
  // Not before: frames in the step under way ask what has taken it.
  if (method_.isAdaptive()) changeMotion();
  const double before = island_.time;
  const long evaluationsBefore = island_.equations.evaluations();
  coordinates_.beginStep(island_.state);
  if (events_) {
    advance(time, *events_);
    if (!promiseEnd_ && !events_->fallbackReason().empty()) endPromise(*events_);
    if (!promiseEnd_ && events_->offConstraintsFrom()) endPromiseAtDeadPoint(*events_->offConstraintsFrom());
    if (const Correction* correction = island_.log.corrections().first(); correction && !promiseEnd_)
      endPromise(*correction);
  } else {
    advance(time, *steps_);
  }
  const long done = island_.equations.evaluations() - evaluationsBefore;
  work_ += done * std::ssize(island_.assembly.sceneBodies) * (steps_ && !steps_->isFree() ? kWorkOfContact : 1);
  const bool hasStepped = island_.step.time + island_.step.timeStep >= island_.time;
  coordinates_.endStep(island_.time - before, hasStepped ? island_.step.state : island_.state);
}

bool IslandSolver::keepsConstraints() const {
  return events_ ? events_->keepsConstraints() : steps_->keepsConstraints();
}

/// Steps of one length take over where events do not serve, and give back where nothing touches, or after a while. At
/// visual accuracies they go on to the end: trials cost more than they may save.
void IslandSolver::changeMotion() {
  if (events_) {
    if (events_->fallbackReason().empty()) return;
    if (!promiseEnd_) endPromise(*events_);  // at the start
    hasLeftEvents_ = true;
    island_.assembly.mechanism.contacts.clear();
    return changeToSteps();
  }
  if (!method_.isAdaptive() || steps_->isAtRest()) return;
  if (!steps_->isFree() && island_.time < nextTrial_) return;
  nextTrial_ = island_.time + trialTime_;
  if (steps_->isFree()) trialTime_ = kTrialTime;
  if (steps_->isFree() || steps_->mayServeEvents()) moveByEvents(true);
}

void IslandSolver::moveByEvents(bool isTrial) {
  steps_.reset();
  events_ = std::make_unique<EventMotion>(island_, ropes_, method_, isTrial);
}

void IslandSolver::moveBySteps(const ChosenMethod& steps) {
  events_.reset();
  steps_ = std::make_unique<SteppedMotion>(island_, ropes_, steps);
}

double IslandSolver::contactTimeStep() const {
  return isVisual() ? kContactTimeStep : cradle::contactTimeStep(island_.assembly);
}

void IslandSolver::changeToSteps() {
  const ChosenMethod steps = contactSteps(contactTimeStep());
  nextTrial_ = island_.time + trialTime_;
  trialTime_ *= 2;
  if (isVisual()) method_ = steps;
  moveBySteps(steps);
}

void IslandSolver::endPromise(const EventMotion& events) {
  promiseEnd_ = {island_.time, std::string(events.fallbackReason()), events.fallbackBodies(), {}};
  promiseEnd_->warning = fmt::format("{}; contact is resolved every {:.3g} s {}", textOf(*promiseEnd_, island_.scene),
                                     contactTimeStep(), isVisual() ? "to the end" : "as long as that lasts");
}

void IslandSolver::endPromiseAtDeadPoint(double time) {
  promiseEnd_ = {
      time,
      "constraints take more than the accuracy out of one step, as near a dead point or under a far heavier body",
      island_.assembly.sceneBodies,
      {}};
  promiseEnd_->warning = textOf(*promiseEnd_, island_.scene);
}

void IslandSolver::endPromise(const Correction& correction) {
  promiseEnd_ = {
      correction.time, "forces or impulses of contacts were not found to the tolerance", correction.bodies, {}};
  promiseEnd_->warning = textOf(*promiseEnd_, island_.scene);
}

void IslandSolver::interpolateAt(double time, bool byStep) {
  const bool keepsConstraints = this->keepsConstraints();
  const double fraction = (time - island_.step.time) / island_.step.timeStep;
  interpolate(island_.step, fraction, reported_);
  place(island_.assembly.mechanism.driven, time, reported_);
  if (events_ && byStep)
    withForcesOfStep([&] { stepTo(time); });
  else
    stepWhereForcesJump(time);
  if (steps_) steps_->addContactMotion(fraction, reported_);
  const Mechanism& mechanism = island_.assembly.mechanism;
  if (events_ && events_->ledgerOfStep()) setLedger(*events_->ledgerOfStep(), island_.step, fraction, reported_);
  if (events_ && keepsConstraints && !events_->contactsOfStep().empty()) {
    project(events_->contactsOfStep());
  } else if (keepsConstraints && solver_.hasConstraints()) {
    findStill();
    solver_.exclude(still_);
    solver_.project(reported_);
  }
  if (events_ && !mechanism.motors.empty()) withForcesOfStep([this] { frameEquations().keepTargets(reported_); });
  numericalEnergy(reported_) = numericalEnergy(island_.step.startState);
  bookNumerical(energyConstant(mechanism, island_.step.startState), mechanism, reported_);
}

/// Whether a contact slides much more slowly at one end of the step than at the other one.
bool IslandSolver::mayFrictionTurn(const std::vector<ContactConstraint>& contacts) const {
  const auto slides = [](const ContactConstraint& contact) { return contact.motion == ContactMotion::sliding; };
  if (std::none_of(contacts.begin(), contacts.end(), slides)) return false;
  const std::vector<RigidBody>& bodies = island_.assembly.mechanism.bodies;
  std::vector<BodyFrame> atStart, atEnd;
  findBodyFrames(bodies, island_.step.startState, atStart), findBodyFrames(bodies, island_.step.state, atEnd);
  return std::any_of(contacts.begin(), contacts.end(), [&](const ContactConstraint& contact) {
    if (!slides(contact)) return false;
    const double first = tangentialVelocity(kinematicsOf(contact, island_.step.startState, atStart)).norm(),
                 last = tangentialVelocity(kinematicsOf(contact, island_.step.state, atEnd)).norm();
    return std::min(first, last) < kMuchSlower * std::max(first, last);
  });
}

/// Where sliding is about to stop, friction across it may turn so fast that the stages of a step, and its interpolant
/// with them, say nothing of what is between them, though the step is right. The rates of the reported state tell that
/// from the forces there: if they do, it becomes the end of a shorter step from the same start.
void IslandSolver::stepWhereForcesJump(double time) {
  if (!events_ || !mayFrictionTurn(events_->contactsOfStep())) return;
  const Step& step = island_.step;
  withForcesOfStep([&] {
    setResting(still_);  // bodies that the end of the step has woken have rested in it
    frameEquations().evaluate(time, reported_, derivative_);
    interpolateRate(step, (time - step.time) / step.timeStep, frameStep_.work);
    const Eigen::Index first = poseComponents(reported_), count = reported_.size() - kLedgerSize - first;
    const auto size = 1 + reported_.segment(first, count).array().abs();
    const auto defect = (derivative_ - frameStep_.work).segment(first, count).array().abs() / size;
    if (defect.maxCoeff() * step.timeStep > kMaxDefect * island_.scene.accuracy) stepTo(time);
  });
}

/// Makes the reported state the end of a step from the same start as the one under way, with the forces of that.
void IslandSolver::stepTo(double time) {
  const Step& step = island_.step;
  setResting(still_);  // bodies that the end of the step has woken have rested in it
  frameStep_.startDerivativeIsKnown = false;
  method_.integrate(frameEquations().rightHandSide(), step.startState, step.time, time - step.time, frameStep_);
  reported_ = frameStep_.state;
  place(island_.assembly.mechanism.driven, time, reported_);
}

template <class Evaluate>
void IslandSolver::withForcesOfStep(const Evaluate& evaluate) {
  Mechanism& mechanism = island_.assembly.mechanism;
  // What has ended the step may have changed forces, and brought bodies to rest.
  std::vector<ContactConstraint> contacts = events_->contactsOfStep();
  Constraints constraints = events_->constraintsOfStep();
  std::vector<PushForce> pushes = events_->pushesOfStep();
  std::vector<JointMotor> motors = events_->motorsOfStep();
  const auto swapForces = [&] {
    std::swap(contacts, mechanism.contacts);
    std::swap(constraints, mechanism.constraints), std::swap(pushes, mechanism.pushes);
    std::swap(motors, mechanism.motors);
  };
  swapForces();
  findStill();
  std::vector<char> resting = island_.equations.resting();
  for (std::size_t i = 0; i < resting.size(); ++i) resting[i] = resting[i] && still_[i];
  setResting(resting);
  evaluate();
  swapForces();
}

void IslandSolver::findJointStates(double time) {
  coordinates_.find(std::min(0.0, time - island_.time), reported_, jointStates_);
  const Assembly& assembly = island_.assembly;
  if (assembly.mechanism.motors.empty()) return;
  const VectorX forces = motorForces(time);
  for (std::size_t i = 0; i < jointStates_.size(); ++i)
    if (const int motor = assembly.joints[i].motor; motor >= 0) jointStates_[i].force = forces[motor];
}

/// Forces of all motors in the reported state: of those that hold, in steps of one length, the ones of the step.
VectorX IslandSolver::motorForces(double time) {
  const std::vector<JointMotor>& motors = island_.assembly.mechanism.motors;
  const VectorX& last = island_.equations.motorForces();
  const bool isKnown = last.size() == std::ssize(motors);
  if (steps_ && steps_->motorForces().size() == last.size() && isKnown) return steps_->motorForces();
  frameEquations().setMotorSteps(island_.equations.motorSteps());
  const auto evaluate = [&] { frameEquations().evaluate(time, reported_, derivative_); };
  if (events_ && time < island_.time - sameTime(time)) {
    withForcesOfStep(evaluate);
  } else {
    setResting(island_.equations.resting());
    evaluate();
  }
  VectorX forces = frameEquations().motorForces();
  for (std::size_t i = 0; i < motors.size() && isKnown; ++i)
    if (frameEquations().isResting(motors[i].joint))
      forces[static_cast<Eigen::Index>(i)] = last[static_cast<Eigen::Index>(i)];
  return forces;
}

std::vector<ContactWrench> IslandSolver::contactWrenches() {
  const bool isInside = events_ && reportedTime_ < island_.time - sameTime(reportedTime_);
  WrenchSum sum;
  if (steps_) {
    steps_->addMeanLoads(reportedTime_, sum);
    return sum.wrenches();
  }
  for (const SupportForce& support : isInside ? *events_->supportsOfStep() : *island_.resting.supports())
    sum.add(loadOf(support.contact, support.pair, support.force, island_.assembly));
  addActiveLoads(isInside, sum);
  return sum.wrenches();
}

/// Adds the forces of active contacts in the reported state; inside the last step of those that were active over it.
void IslandSolver::addActiveLoads(bool isInside, WrenchSum& sum) {
  const std::vector<BodiesInContact> bodies = isInside ? events_->bodiesOfStep() : events_->bodiesInContact();
  if (bodies.empty()) return;
  const auto evaluate = [&] { frameEquations().evaluate(reportedTime_, reported_, derivative_); };
  ++evaluationsOfLoads_;
  frameEquations().setMotorSteps(island_.equations.motorSteps());
  if (isInside) {
    withForcesOfStep(evaluate);
  } else {
    setResting(island_.equations.resting());
    evaluate();
  }
  const std::vector<ContactForce>& forces = frameEquations().contactForces();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double sign = bodies[i].isMirrored ? 1 : -1;  // forces are on A of the constraint
    const Vec3 normalForce = sign * forces[i].normal * forces[i].direction, friction = sign * forces[i].tangential;
    if (!((normalForce + friction).norm() < kLargestNumber)) continue;  // friction is about to jam: none is known
    sum.add({bodies[i].bodyA, bodies[i].bodyB, forces[i].point, forces[i].normal, normalForce, friction});
  }
}

EquationsOfMotion& IslandSolver::frameEquations() {
  if (!frameEquations_) frameEquations_ = std::make_unique<EquationsOfMotion>(island_.assembly.mechanism);
  return *frameEquations_;
}

/// For what is asked of frames.
void IslandSolver::setResting(const std::vector<char>& resting) {
  for (std::size_t i = 0; i < resting.size(); ++i)
    if (frameEquations().isResting(i) != (resting[i] != 0)) frameEquations().setResting(i, resting[i] != 0);
}

/// Projects the interpolated state onto the constraint manifold: no gaps at active contacts, no constraint errors.
void IslandSolver::project(const std::vector<ContactConstraint>& contacts) {
  const Mechanism& mechanism = island_.assembly.mechanism;
  findStill();
  ContactSolver(contacts, mechanism.constraints, mechanism.bodies).project(reported_, still_);
}

/// A body that has not moved within the step is where its constraints keep it.
void IslandSolver::findStill() {
  const Step& step = island_.step;
  still_.resize(island_.assembly.mechanism.bodies.size());
  for (std::size_t i = 0; i < still_.size(); ++i) {
    const Eigen::Index at = static_cast<Eigen::Index>(i) * kPoseSize;
    still_[i] = step.startState.segment<kPoseSize>(at) == step.state.segment<kPoseSize>(at);
  }
}

/// Sets the orientation of a body whose angular velocity is constant: the state keeps the orientation of the start.
void IslandSolver::rotate(Eigen::Index body, double time, VectorX& state) const {
  turnBody(state, body, (time - island_.assembly.startTime) * Vec3(angularVelocity(state, body)));
}

}  // namespace cradle
