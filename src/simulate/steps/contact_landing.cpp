// A body that lands on one end while another still carries loses what the impact takes from it, at an instant. Spread
// over a step, in which the end that will leave is still held, more is lost: by a part of the step's length over the
// time between landings. So a step ends where something lands.

#include <algorithm>
#include <cmath>

#include "impact/impact_energy.h"
#include "simulate/steps/contact_stepping.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

/// J: of impulses between contacts' velocities.
double energyTakenBy(const VectorX& impulses, const VectorX& before, const VectorX& after) {
  double taken = 0;
  for (Index at = 0; at < impulses.size(); at += 3)
    taken += energyTaken(impulses.segment<3>(at), before.segment<3>(at), after.segment<3>(at));
  return taken;
}

}  // namespace

double ContactStepping::nextImpact(const std::vector<Contact>& contacts, const VectorX& before, double timeStep,
                                   const VectorX& state, double minImpactSpeed) {
  strikesInside_.assign(contacts.size(), 0);
  double first = INFINITY;
  if (contacts.empty()) return first;
  // The impulses of the step before are where that to come begins.
  const std::vector<SteppedContact> last = contacts_;
  begin(contacts, {}, before, timeStep, state);
  previous_ = last, previousSlips_ = slips_;
  startPart_ = previousStep_ > 0 ? timeStep / previousStep_ : 1;
  for (const Group& group : findGroups()) {
    const Motion motion = motionOf(group, before, timeStep, state);
    if (!markImpactsInside(group, motion, minImpactSpeed)) continue;
    VectorX path = state;
    const VectorX impulses = solve(group, posed(group, motion, 1));
    dense_ ? dense_->apply(impulses, path) : sparse_.apply(impulses, path);
    first = std::min(first, fractionOfImpact(group, motion, sparse_.velocitiesIn(path) + motion.velocityProduct));
  }
  contacts_ = last;
  faults_.clear();  // of a trial
  return first;
}

/// What may land: apart, and closed at the step's end by free motion.
bool ContactStepping::markImpactsInside(const Group& group, const Motion& motion, double minImpactSpeed) {
  bool isFound = false;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const Index normal = 3 * static_cast<Index>(i) + 2;
    const double gap = group.contacts[i].separation;
    const double closing = motion.closing(normal), fastest = closing + motion.pressing(normal);
    const bool lands = gap > overlapTolerance_ && closing > minImpactSpeed && gap < motion.timeStep * fastest;
    strikesInside_[group.members[i]] = lands ? 1 : 0;
    isFound = isFound || lands;
  }
  return isFound;
}

/// The first root of gap + v t + a t^2 / 2, in steps; what has none within the step does not land.
double ContactStepping::fractionOfImpact(const Group& group, const Motion& motion, const VectorX& end) {
  double first = INFINITY;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    char& lands = strikesInside_[group.members[i]];
    if (!lands) continue;
    const Index normal = 3 * static_cast<Index>(i) + 2;
    const double gap = group.contacts[i].separation / motion.timeStep, closing = motion.closing(normal);
    const double root = closing * closing - 2 * gap * (end[normal] + closing);
    const double part = root < 0 ? INFINITY : 2 * gap / (closing + std::sqrt(root));
    lands = part <= 1 ? 1 : 0;
    if (lands) first = std::min(first, part);
  }
  return first;
}

std::vector<Vec3> ContactStepping::strike(const std::vector<Contact>& contacts, double timeStep, VectorX& state) {
  std::vector<Vec3> impulses(contacts.size(), Vec3::Zero());
  const std::vector<SteppedContact> last = contacts_;
  begin(contacts, {}, state, 0, state);
  const double constant = energyConstant(assembly_.mechanism, state);
  for (const Group& group : findGroups()) {
    setContactProblem(group, state);
    const VectorX found = strike(group, timeStep, state);
    for (std::size_t i = 0; i < group.members.size(); ++i)
      impulses[group.members[i]] = sparse_.axes(i) * found.segment<3>(3 * static_cast<Index>(i));
  }
  contacts_ = last;
  bookNumerical(constant, assembly_.mechanism, state);
  return impulses;
}

/// Newton's restitution as in the steps: of what closes faster than accelerations explain.
ContactStepping::Problem ContactStepping::posedImpact(const Group& group, const VectorX& start, double timeStep,
                                                      double part) const {
  Problem problem{start, {}};
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const ContactMaterial& material = materialOf(group.members[i]);
    problem.frictions.push_back(material.staticFriction);
    const Index normal = 3 * static_cast<Index>(i) + 2;
    const double rebound = -part * material.restitution * start[normal];
    if (rebound <= restSpeed(0, timeStep)) continue;
    problem.free[normal] -= rebound;
    problem.hasRebounds = true;
  }
  return problem;
}

/// Dynamic friction where `end` slides. Whether that is another.
bool ContactStepping::slide(const Group& group, const VectorX& end, Problem& problem) const {
  bool isOther = false;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const ContactMaterial& material = materialOf(group.members[i]);
    if (material.dynamicFriction == material.staticFriction) continue;
    if (end.segment<2>(3 * static_cast<Index>(i)).norm() <= kSlowestSliding) continue;
    problem.frictions[i] = material.dynamicFriction;
    isOther = true;
  }
  return isOther;
}

/// With all friction static, then with dynamic friction where that slides.
VectorX ContactStepping::strike(const Group& group, double timeStep, VectorX& state) {
  const VectorX start = sparse_.velocitiesIn(state);
  const double most = energyOf(group.moved.bodies, assembly_.mechanism, state);
  Problem problem;
  VectorX impulses;
  const auto solveAndApply = [&] {
    restore(group.moved.bodies, state);
    impulses = solve(group, problem);
    dense_ ? dense_->apply(impulses, state) : sparse_.apply(impulses, state);
  };
  const std::size_t faults = faults_.size();
  const auto lossWith = [&](double part) {
    forgetFaults(faults);
    problem = posedImpact(group, start, timeStep, part);
    solveAndApply();
    if (slide(group, sparse_.velocitiesIn(state), problem)) solveAndApply();
    return most - energyOf(group.moved.bodies, assembly_.mechanism, state);
  };
  const double loss = lossWith(1);
  if (problem.hasRebounds && isGain(most - loss, most)) lossWith(fractionWithoutGain(lossWith, loss));
  impactEnergy(state) += std::max(0.0, energyTakenBy(impulses, start, sparse_.velocitiesIn(state)));
  limit(group, most, state);
  return impulses;
}

}  // namespace cradle
