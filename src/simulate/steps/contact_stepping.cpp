// J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988; M. Jean, "The non-smooth
// contact dynamics method", Comput. Methods Appl. Mech. Engrg. 177, 1999: velocities at the step's end are the
// unknowns, impulses of a step may be forces or shocks. A contact that is apart by a gap s may close with s/h at most.
//
// For order 2 where contacts last: normals and moment arms are those of the step's middle, to which bodies go with the
// velocities of its start, and the contact's velocity at the step's ends is J v -+ (h/2) (dJ/dt) v there; bodies go on
// with the mean of the velocities at both ends, which then leaves gaps as they are, and impulses do no work on them.

#include "simulate/steps/contact_stepping.h"

#include <algorithm>

#include "impact/friction_cone.h"
#include "impact/impact_energy.h"
#include "simulate/steps/penetration_correction.h"
#include "simulate/steps/step_impact.h"

namespace cradle {
namespace {

/// m: gaps of a group's contacts after a step with velocities in their axes.
VectorX gapsAfter(const StepGroup& group, double timeStep, const VectorX& velocities) {
  VectorX gaps(group.contacts.size());
  for (Eigen::Index i = 0; i < gaps.size(); ++i)
    gaps[i] = group.contacts[static_cast<std::size_t>(i)].separation + timeStep * velocities[3 * i + 2];
  return gaps;
}

/// Places bodies where the mean of their velocities at both ends of a step leads. A method of order 1 leads h^2 a / 2
/// from there, and contact would be charged with the energy of that.
void placeByMean(const std::vector<int>& bodies, const VectorX& before, double timeStep, VectorX& state) {
  const double half = 0.5 * timeStep;
  for (const int body : bodies) {
    state.segment<kPoseSize>(body * kPoseSize) = before.segment<kPoseSize>(body * kPoseSize);
    centerOfMass(state, body) += half * (linearVelocity(before, body) + linearVelocity(state, body));
    turnBody(state, body, half * (angularVelocity(before, body) + angularVelocity(state, body)));
  }
}

/// Moves bodies from the start of a step with the mean of their velocities at both ends, those at the end being in
/// `state`. A body whose velocity is that of free motion is where free motion led.
void moveByMean(const std::vector<int>& bodies, const FreeStep& step, VectorX& state) {
  const double half = 0.5 * step.timeStep;
  for (const int body : bodies) {
    state.segment<kPoseSize>(body * kPoseSize) = step.end.segment<kPoseSize>(body * kPoseSize);
    if (linearVelocity(state, body) != linearVelocity(step.end, body))
      centerOfMass(state, body) =
          centerOfMass(step.before, body) + half * (linearVelocity(step.before, body) + linearVelocity(state, body));
    turnBody(state, body, half * (angularVelocity(state, body) - angularVelocity(step.end, body)));
  }
}

/// Corrects the work of dampers, pushes and motors that push, which was that along free motion: contact changes
/// velocities in proportion to time, so that the mean of their change is half of it.
void bookForces(const Mechanism& mechanism, const FreeStep& step, VectorX& state) {
  for (const SpringForce& spring : mechanism.springs)
    dampingEnergy(state) +=
        0.5 * step.timeStep * (actionOf(spring, state).dissipation - actionOf(spring, step.end).dissipation);
  for (const PushForce& push : mechanism.pushes)
    pushWork(state) += 0.5 * step.timeStep * (powerOf(push, state) - powerOf(push, step.end));
  std::vector<BodyFrame> frames;
  for (const JointMotor& motor : mechanism.motors) {
    if (motor.mode == JointMotor::Mode::holds) continue;
    if (frames.empty()) findBodyFrames(mechanism.bodies, state, frames);
    const ConstraintBlock row = rowOf(motor, state, frames);
    pushWork(state) +=
        0.5 * step.timeStep * motor.sign * motor.maxForce * (rateOf(row, 0, state) - rateOf(row, 0, step.end));
  }
}

}  // namespace

void ContactStepping::resolve(const std::vector<Contact>& contacts, const std::vector<const Limit*>& ropes,
                              const VectorX& before, double timeStep, VectorX& state,
                              const std::vector<char>& strikesInside) {
  problem_.warmStartFrom({std::exchange(contacts_, {}), std::exchange(slips_, {}), impulseRatio(timeStep)});
  previousStep_ = timeStep;
  frictionWork_ = {};
  faults_.clear();
  motorImpulses_.setZero(std::ssize(assembly_.mechanism.motors));
  if (contacts.empty()) return;
  const Mechanism& mechanism = assembly_.mechanism;
  const ContactSet set(assembly_, tolerances_, contacts, ropes, before);
  const std::vector<StepGroup> groups = set.findGroups();
  const double constant = energyConstant(mechanism, state);
  if (isFirstOrder_)
    for (const StepGroup& group : groups) placeByMean(group.moved.bodies, before, timeStep, state);
  const FreeStep step(mechanism.bodies, before, timeStep, state);
  holdMotors();
  problem_.factorize(step.middle);
  for (std::size_t i = 0; i < set.size(); ++i) contacts_.push_back({set[i], Vec3::Zero(), false});
  slips_.assign(set.size(), Vec3::Zero());
  const LedMotion led = ledMotion(before, state);
  std::vector<double> most;  // J, of each group
  for (const StepGroup& group : groups) {
    most.push_back(energyOf(group.moved.bodies, mechanism, state));
    most.back() += resolveGroup(group, {set, step, strikesInside, led}, state);
  }
  // Contact moves bodies along straight lines, which ends of rods and joints do not follow.
  if (problem_.constraints().hasConstraints()) {
    problem_.constraints().project(state);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      keepMomenta(groups[i].moved, step.end, mechanism, state);
      clampEnergyWithFault(groups[i].moved, most[i], mechanism, state, faults_);
    }
  }
  contacts_.resize(contacts.size());  // without ropes
  bookForces(mechanism, step, state);
  bookNumerical(constant, mechanism, state);
}

/// Motors that hold do so whatever the contacts of the step do.
void ContactStepping::holdMotors() {
  heldMotors_.clear();
  const std::vector<JointMotor>& motors = assembly_.mechanism.motors;
  for (std::size_t i = 0; i < motors.size(); ++i)
    if (motors[i].mode == JointMotor::Mode::holds) heldMotors_.push_back(i);
  problem_.hold(heldMotors_);
}

/// With rows J of joints and of motors that hold, velocities v of a mechanism are led in as far as J v != 0: by M^-1
/// J^T nu, which has the same J v. The work of motors against impulses is then as that of driven bodies.
ContactStepping::LedMotion ContactStepping::ledMotion(const VectorX& before, const VectorX& state) {
  const std::vector<RigidBody>& bodies = assembly_.mechanism.bodies;
  if (assembly_.mechanism.driven.empty() && !problem_.isHolding()) return {};
  const auto ledBy = [&](const VectorX& velocities) {
    VectorX led = ledVelocities(bodies, problem_.ties(), velocities);
    if (!problem_.isHolding()) return led;
    VectorX free = velocities;
    problem_.ties().constrainVelocities(free);
    const Eigen::Index poses = poseComponents(velocities);
    led.tail(led.size() - poses) += velocities.tail(led.size() - poses) - free.tail(led.size() - poses);
    return led;
  };
  return {ledBy(before), ledBy(state)};
}

/// Energy does not grow beyond the most that what drives bodies may work, which is returned (J): a restitution that
/// would let it (with friction it can) is made smaller, and what is left by rounding, by the order of the method, or by
/// impulses that were not found is taken from the velocities.
double ContactStepping::resolveGroup(const StepGroup& group, const StepInput& input, VectorX& state) {
  const Mechanism& mechanism = assembly_.mechanism;
  const StepMotion motion = stepMotionOf(group, input.contacts, input.step, problem_);
  const double most = energyOf(group.moved.bodies, mechanism, state);
  ContactProblem posed;
  VectorX impulses, end;
  WorkOfDrives work;
  const std::size_t kept = faults_.size();
  const auto lossWith = [&](double restitutionFraction) {
    faults_.erase(faults_.begin() + static_cast<std::ptrdiff_t>(kept), faults_.end());
    copyBodies(group.moved.bodies, input.step.end, state);
    posed = posedStep(group, input.contacts, motion, input.strikesInside, restitutionFraction);
    impulses = problem_.solve(group, posed, faults_);
    work = workOfDrives(input.led, posed.free, impulses);
    end = move(group, input, motion, impulses, state);
    return most + work.most - energyOf(group.moved.bodies, mechanism, state);
  };
  const double loss = lossWith(1);
  if (posed.hasRebounds && isGain(most + work.most - loss, most + work.most))
    lossWith(fractionWithoutGain(lossWith, loss));
  keepMomenta(group.moved, input.step.end, mechanism, state);
  clampEnergyWithFault(group.moved, most + work.most, mechanism, state, faults_);
  keep(group, motion, posed, impulses, state);
  if (problem_.isHolding()) {
    const VectorX given = problem_.motorImpulses(impulses, input.step.middle);
    for (std::size_t i = 0; i < heldMotors_.size(); ++i)
      motorImpulses_[static_cast<Eigen::Index>(heldMotors_[i])] += given[static_cast<Eigen::Index>(i)];
  }
  book(group, motion, impulses, end, most + work.mean - energyOf(group.moved.bodies, mechanism, state), state);
  pushWork(state) += work.mean;
  return work.most;
}

/// Of driven bodies and motors that hold, against impulses at the contacts of the group that was set: they are forces
/// of a step, whose work with changing velocities is known to the order of the method, and they leave velocities that
/// are not solved for.
ContactStepping::WorkOfDrives ContactStepping::workOfDrives(const LedMotion& led, const VectorX& free,
                                                            const VectorX& impulses) const {
  if (led.start.size() == 0) return {};
  const VectorX start = problem_.velocitiesIn(led.start), end = problem_.velocitiesIn(led.end);
  const double atStart = -impulses.dot(start), atEnd = -impulses.dot(end);
  double unsolved = StepTolerances::kSolvedRatio * free.cwiseAbs().maxCoeff() * impulses.lpNorm<1>();
  if (problem_.isHolding()) unsolved += GroupProblem::kCompliance * impulses.cwiseAbs().dot(end.cwiseAbs());
  return {0.5 * (atStart + atEnd), std::max(atStart, atEnd) + unsolved};
}

/// From free motion to where impulses lead, with the mean of the velocities at both ends: contacts that last keep order
/// 2 and their energy. Overlaps to which that leads where a contact strikes are taken out, and the energy of that from
/// the velocities. Returns the contacts' velocities at the end.
VectorX ContactStepping::move(const StepGroup& group, const StepInput& input, const StepMotion& motion,
                              const VectorX& impulses, VectorX& state) {
  problem_.apply(impulses, state);
  const VectorX end = problem_.velocitiesIn(state);
  moveByMean(group.moved.bodies, input.step, state);
  const VectorX gaps = gapsAfter(group, motion.timeStep, 0.5 * (motion.start + end));
  if (gaps.minCoeff() >= -tolerances_.overlap) return end;
  const double most = energyOf(group.moved.bodies, assembly_.mechanism, state);
  separateGroup(group, input.contacts, gaps, problem_, state);
  clampEnergyWithFault(group.moved, most, assembly_.mechanism, state, faults_);
  return end;
}

/// Keeps impulses and velocities of a group for the events of this step and the warm start of the next.
void ContactStepping::keep(const StepGroup& group, const StepMotion& motion, const ContactProblem& posed,
                           const VectorX& impulses, const VectorX& state) {
  const VectorX end = problem_.velocitiesIn(state);
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const Eigen::Index at = 3 * static_cast<Eigen::Index>(i);
    SteppedContact& stepped = contacts_[group.members[i]];
    stepped.impulse = problem_.axes(i) * impulses.segment<3>(at);
    const double closing = motion.closing(at + 2), pressing = motion.pressing(at + 2);
    stepped.isImpact = impulses[at + 2] > 0 && closing > tolerances_.maxRestSpeed(pressing, motion.timeStep);
    const Vec3 slip = end.segment<3>(at) + posed.free.segment<3>(at) - motion.free.segment<3>(at);
    slips_[group.members[i]] = problem_.axes(i) * correctedVelocity(slip, posed.frictions[i]);
  }
}

/// Books the work of contact impulses: that of contacts that struck, with their friction, and that of the closing which
/// others still had is impact; the rest is friction. Friction that drives a body which strikes something else gives
/// what the impact takes besides; a negative sum of both is an error and no work of contacts. Nor do they take more
/// than `loss` (J) where constraints take part: impulses of constraints are as large where contacts have short moment
/// arms about a joint.
void ContactStepping::book(const StepGroup& group, const StepMotion& motion, const VectorX& impulses,
                           const VectorX& end, double loss, VectorX& state) {
  double impact = 0, friction = 0, frictionAtStart = 0;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const Eigen::Index at = 3 * static_cast<Eigen::Index>(i);
    const Vec3 impulse = impulses.segment<3>(at), before = motion.start.segment<3>(at), after = end.segment<3>(at);
    const bool isImpact = contacts_[group.members[i]].isImpact;
    const Vec3 pressing = isImpact ? impulse : Vec3(0, 0, impulse.z()), rubbing = impulse - pressing;
    impact += energyTaken(pressing, before, after);
    friction += energyTaken(rubbing, before, after);
    frictionAtStart += energyTaken(rubbing, before, before);
  }
  const double taken = std::max(0.0, impact + friction), left = std::max(0.0, loss);
  const double rubbed = std::clamp(friction, 0.0, taken);
  const double fraction = group.isConstrained && taken > left ? left / taken : 1;
  impactEnergy(state) += fraction * (taken - rubbed);
  if (rubbed == 0) return;
  frictionEnergy(state) += fraction * rubbed;
  frictionWork_.taken += fraction * rubbed, frictionWork_.atStart += fraction * rubbed / friction * frictionAtStart;
}

NextImpact ContactStepping::nextImpact(const std::vector<Contact>& contacts, const VectorX& before, double timeStep,
                                       const VectorX& state, double minImpactSpeed) {
  if (contacts.empty()) return {};
  problem_.warmStartFrom({contacts_, slips_, impulseRatio(timeStep)});
  const FreeStep step(assembly_.mechanism.bodies, before, timeStep, state);
  holdMotors();
  problem_.factorize(step.middle);
  faults_.clear();
  return findNextImpact({assembly_, tolerances_, contacts, {}, before}, step, minImpactSpeed, problem_);
}

void ContactStepping::correctPenetration(const std::vector<Contact>& contacts, const std::vector<const Limit*>& ropes,
                                         VectorX& state) {
  const ContactSet set(assembly_, tolerances_, contacts, ropes, state);
  problem_.hold({});
  if (!contacts.empty()) problem_.factorize(FreeStep(assembly_.mechanism.bodies, state, 0, state).middle);
  cradle::correctPenetration(set, problem_, state, faults_);
}

std::vector<Vec3> ContactStepping::resolveImpact(const std::vector<Contact>& contacts, double timeStep,
                                                 VectorX& state) {
  const ContactSet set(assembly_, tolerances_, contacts, {}, state);
  problem_.hold({});  // a finite force gives no impulse
  if (!contacts.empty()) problem_.factorize(FreeStep(assembly_.mechanism.bodies, state, 0, state).middle);
  return resolveStepImpact(set, timeStep, problem_, state, faults_);
}

}  // namespace cradle
