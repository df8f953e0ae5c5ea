// J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988; M. Jean, "The non-smooth
// contact dynamics method", Comput. Methods Appl. Mech. Engrg. 177, 1999: velocities at the step's end are the
// unknowns, impulses of a step may be forces or shocks. What is apart by a gap s may close with s/h at most.
//
// For order 2 where contacts last: normals and arms are those of the step's middle, to which bodies go with the
// velocities of its start, and the contact's velocity at the step's ends is J v -+ (h/2) dJ/dt v there; bodies go on
// with the mean of the velocities at both ends, which then leaves gaps as they are, and impulses do no work on them.

#include "simulate/steps/contact_stepping.h"

#include <algorithm>
#include <cmath>

#include "impact/impact_energy.h"
#include "simulate/contact_response.h"
#include "simulate/plan/disjoint_sets.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kRestSpeedRatio = 0.01;  // of the speed that gravity gives in a step: slower is no impact
constexpr double kOverlapRatio = 1e-9;    // of the smallest body's size: deeper overlaps are taken out
constexpr double kSolvedRatio = 1e-7;     // of the fastest velocity
constexpr double kSameSide = 0.99;        // cosine: normals that turn farther in half a step are another contact's
constexpr double kSeenWay = 1e5;          // overlap tolerances: over a shorter way, errors of gaps hide how it turns
constexpr double kFreeClosing = 2;        // of the speed with which a contact lands: nothing makes it so fast

}  // namespace

ContactStepping::ContactStepping(const Assembly& assembly)
    : assembly_(assembly),
      solver_(assembly.mechanism.constraints, assembly.mechanism.bodies),
      overlapTolerance_(kOverlapRatio * smallestSize(assembly.geometry)) {}

void ContactStepping::resolve(const std::vector<Contact>& contacts, const std::vector<const RopeLimit*>& ropes,
                              const VectorX& before, double timeStep, VectorX& state) {
  previous_.swap(contacts_), previousSlips_.swap(slips_);
  startPart_ = previousStep_ > 0 ? timeStep / previousStep_ : 1;
  previousStep_ = timeStep;
  frictionWork_ = {};
  faults_.clear();
  begin(contacts, ropes, before, timeStep, state);
  slips_.assign(contacts_.size(), Vec3::Zero());
  strikesInside_.resize(contacts_.size(), 0);
  if (contacts.empty()) return;
  const double constant = energyConstant(assembly_.mechanism, state);
  const std::vector<Group> groups = findGroups();
  std::vector<double> most;  // J, of each group
  for (const Group& group : groups) {
    most.push_back(energyOf(group.moved.bodies, assembly_.mechanism, state));
    resolve(group, before, timeStep, state);
  }
  // Contact moves bodies along straight lines, which ends of rods and joints do not follow.
  if (solver_.hasConstraints()) {
    solver_.project(state);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      keepMomenta(groups[i].moved, free_, assembly_.mechanism, state);
      limit(groups[i], most[i], state);
    }
  }
  strikesInside_.clear();
  contacts_.resize(contacts.size());
  bookForces(timeStep, state);
  bookNumerical(constant, assembly_.mechanism, state);
}

void ContactStepping::begin(const std::vector<Contact>& contacts, const std::vector<const RopeLimit*>& ropes,
                            const VectorX& before, double timeStep, const VectorX& state) {
  setMiddle(before, timeStep);
  contacts_.clear();
  ropes_.clear(), ropeMaterials_.clear();
  for (const Contact& contact : contacts) contacts_.push_back({contact, Vec3::Zero(), false});
  if (!contacts.empty())
    for (const RopeLimit* rope : ropes) {
      const ImpactContact contact = RopeEvents::contactOf(*rope, before);
      contacts_.push_back({contact.contact, Vec3::Zero(), false});
      ropes_.push_back(rope), ropeMaterials_.push_back(contact.material);
    }
  free_ = state;
  if (solver_.hasConstraints() && !contacts.empty()) solver_.factorize(middle_);
}

const ContactMaterial& ContactStepping::materialOf(std::size_t member) const {
  if (isRope(member)) return ropeMaterials_[member - firstRope()];
  return assembly_.geometry.pairs[contacts_[member].contact.pair].material;
}

void ContactStepping::setContactProblem(const Group& group, const VectorX& state) {
  setContactProblem(group, group.contacts, state);
}

void ContactStepping::setContactProblem(const Group& group, const std::vector<Contact>& contacts,
                                        const VectorX& state) {
  sparse_.set(contacts, assembly_.mechanism.bodies, state);
  dense_.reset();
  if (group.isConstrained) dense_.emplace(contacts, ImpulseResponse(assembly_.mechanism.bodies, solver_), state);
}

/// Where bodies are in the middle of a step if nothing acts on them.
void ContactStepping::setMiddle(const VectorX& before, double timeStep) {
  middle_ = before;
  for (Index body = 0; body < bodyCount(before); ++body) {
    centerOfMass(middle_, body) += 0.5 * timeStep * linearVelocity(before, body);
    turnBody(middle_, body, 0.5 * timeStep * angularVelocity(before, body));
  }
  findBodyFrames(assembly_.mechanism.bodies, middle_, frames_);
}

/// Moves a contact of the step's start to its middle. Returns the derivative (m/s^2, world) of its velocity there if
/// its bodies keep theirs.
Vec3 ContactStepping::follow(std::size_t member, const VectorX& before, double timeStep, Contact& contact) const {
  if (!isRope(member)) {
    const Vec3 drift = followContact(before, middle_, frames_, contact);
    return canLast(contact) ? drift : followSides(timeStep, contact);
  }
  const RopeLimit& rope = *ropes_[member - firstRope()];
  contact = RopeEvents::contactOf(rope, middle_).contact;
  return -lengtheningAcceleration(rope, middle_, VectorX::Zero(middle_.size())) * contact.normal;
}

/// The same for the sides of two capsules, whose gap is smooth, by where they are found in the middle. With gaps s
/// there and s0 at the start, and the derivative s' in the middle: s - s0 = s' h/2 - s'' h^2/8. Zero for edges of
/// others.
Vec3 ContactStepping::followSides(double timeStep, Contact& contact) const {
  const ContactGeometry& geometry = assembly_.geometry;
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const auto isCapsule = [&](std::size_t i) { return geometry.colliders[i].kind() == ColliderKind::capsule; };
  const double half = 0.5 * timeStep, speed = relativeVelocity(contact, middle_).norm();
  const bool areCapsules = !pair.againstPlane && isCapsule(pair.a) && isCapsule(pair.b);
  if (!areCapsules || half * speed < kSeenWay * overlapTolerance_) return Vec3::Zero();
  std::vector<Contact> found;
  appendContacts(geometry, contact.pair, middle_, std::max(0.0, contact.separation) + half * speed, found);
  const Contact* nearest = nullptr;
  for (const Contact& other : found)
    if (!nearest || (other.point - contact.point).squaredNorm() < (nearest->point - contact.point).squaredNorm())
      nearest = &other;
  if (!nearest || nearest->normal.dot(contact.normal) < kSameSide) return Vec3::Zero();
  const double derivative = openingSpeed(*nearest, middle_), gap = contact.separation;
  const double velocityProduct = 2 * (derivative - (nearest->separation - gap) / half);  // m/s: s'' h/2
  if (std::abs(velocityProduct) > speed) return Vec3::Zero();
  contact = *nearest;
  contact.separation = gap;
  return velocityProduct / half * contact.normal;
}

/// What contacts see of a step, with the cones set to where they are in its middle.
ContactStepping::Motion ContactStepping::motionOf(const Group& group, const VectorX& before, double timeStep,
                                                  const VectorX& state) {
  std::vector<Contact> contacts = group.contacts;
  std::vector<Vec3> velocityProducts;  // m/s^2, world
  for (std::size_t i = 0; i < contacts.size(); ++i)
    velocityProducts.push_back(follow(group.members[i], before, timeStep, contacts[i]));
  setContactProblem(group, contacts, middle_);
  Motion motion{before, sparse_.velocitiesIn(before), sparse_.velocitiesIn(state), VectorX(3 * velocityProducts.size()),
                timeStep};
  for (std::size_t i = 0; i < velocityProducts.size(); ++i)
    motion.velocityProduct.segment<3>(3 * static_cast<Index>(i)) =
        0.5 * timeStep * (sparse_.axes(i).transpose() * velocityProducts[i]);
  return motion;
}

/// Whether the member is a contact with a fixed plane without friction.
bool ContactStepping::isOnSmoothPlane(std::size_t member) const {
  if (isRope(member) || materialOf(member).staticFriction > 0 || materialOf(member).dynamicFriction > 0) return false;
  return assembly_.geometry.pairs[contacts_[member].contact.pair].againstPlane;
}

/// Contacts whose bodies touch or are joined.
std::vector<ContactStepping::Group> ContactStepping::findGroups() const {
  DisjointSets islands(assembly_.mechanism.bodies.size());
  std::vector<char> isConstrained(assembly_.mechanism.bodies.size(), 0), isConstrainedToFixed = isConstrained;
  forEachConstraint(assembly_.mechanism.constraints, [&](int bodyA, int bodyB) {
    islands.join(bodyA, bodyB);
    for (const auto& [body, other] : {std::pair(bodyA, bodyB), {bodyB, bodyA}}) {
      if (body == kFixed) continue;
      isConstrained[static_cast<std::size_t>(body)] = 1;
      if (other == kFixed) isConstrainedToFixed[static_cast<std::size_t>(body)] = 1;
    }
  });
  for (const SteppedContact& stepped : contacts_) islands.join(stepped.contact.bodyA, stepped.contact.bodyB);
  std::map<int, Group> groups;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& contact = contacts_[i].contact;
    Group& group = groups[islands.islandOf(contact.movingBody())];
    group.members.push_back(i);
    group.contacts.push_back(contact);
    if (contact.bodyA != kFixed && contact.bodyB != kFixed) continue;
    if (isOnSmoothPlane(i))
      hinderByPlane(contact.normal, group.moved.kept);
    else
      group.moved.kept.resize(6, 0);
  }
  for (std::size_t body = 0; body < isConstrained.size(); ++body)
    if (const auto group = groups.find(islands.islandOf(static_cast<int>(body))); group != groups.end()) {
      group->second.moved.bodies.push_back(static_cast<int>(body));
      if (isConstrainedToFixed[body]) group->second.moved.kept.resize(6, 0);
      group->second.isConstrained = group->second.isConstrained || isConstrained[body];
    }
  std::vector<Group> ordered;
  for (auto& [firstBody, group] : groups) {
    group.firstBody = firstBody;
    ordered.push_back(std::move(group));
  }
  return ordered;
}

/// Speed (m/s) of closing that does not rebound; `pressing` is what a step adds to it.
double ContactStepping::restSpeed(double pressing, double timeStep) const {
  return kRestSteps * pressing + kRestSpeedRatio * assembly_.mechanism.gravity.norm() * timeStep + kRestSpeedFloor;
}

/// The frictional contact problem for velocities at the step's end: what is left of the gap, or the rebound, is taken
/// from the normal ones. A contact that opens when the step begins may come back as fast, so that the mean leaves its
/// gap as it was. Of the restitution only a part counts.
ContactStepping::Problem ContactStepping::posed(const Group& group, const Motion& motion, double part) const {
  Problem problem{motion.free + motion.velocityProduct, {}};
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const ContactMaterial& material = materialOf(group.members[i]);
    const bool slides = (motion.start - motion.velocityProduct).segment<2>(at).norm() > kSlowestSliding;
    problem.frictions.push_back(slides ? material.dynamicFriction : material.staticFriction);
    const double closing = motion.closing(at + 2), pressing = motion.pressing(at + 2);
    const double gap = std::max(0.0, group.contacts[i].separation), restitution = part * material.restitution;
    const bool touches = gap + motion.timeStep * problem.free[at + 2] < 0;
    const bool rebounds = touches && restitution * closing > restSpeed(pressing, motion.timeStep);
    if (strikesInside_[group.members[i]]) {
      problem.free[at + 2] += kFreeClosing * (closing + pressing);
      continue;
    }
    const double returning = std::min(std::max(0.0, -closing), pressing);  // of what opens, and is pressed back
    problem.free[at + 2] += rebounds ? pressing - restitution * closing : gap / motion.timeStep + returning;
    problem.hasRebounds = problem.hasRebounds || rebounds;
  }
  return problem;
}

/// Energy does not grow: a restitution that would let it (with friction it can) is made smaller, and what is left by
/// rounding, by the order of the method, or by impulses that were not found is taken from the velocities.
void ContactStepping::resolve(const Group& group, const VectorX& before, double timeStep, VectorX& state) {
  const Motion motion = motionOf(group, before, timeStep, state);
  const double most = energyOf(group.moved.bodies, assembly_.mechanism, state);
  Problem problem;
  VectorX impulses, end;
  const std::size_t faults = faults_.size();
  const auto lossWith = [&](double part) {
    forgetFaults(faults);
    restore(group.moved.bodies, state);
    problem = posed(group, motion, part);
    impulses = solve(group, problem);
    end = move(group, motion, impulses, state);
    return most - energyOf(group.moved.bodies, assembly_.mechanism, state);
  };
  const double loss = lossWith(1);
  if (problem.hasRebounds && isGain(most - loss, most)) lossWith(fractionWithoutGain(lossWith, loss));
  keepMomenta(group.moved, free_, assembly_.mechanism, state);
  limit(group, most, state);
  keep(group, motion, problem, impulses, state);
  book(group, motion, impulses, end, most - energyOf(group.moved.bodies, assembly_.mechanism, state), state);
}

VectorX ContactStepping::solve(const Group& group, const Problem& problem) {
  if (dense_ || group.contacts.size() <= kFewContacts) {
    const MatrixX delassus = this->delassus();
    const double most = problem.free.cwiseAbs().maxCoeff();
    ContactSolution solution = solveFrictionalContact(delassus, problem.free, problem.frictions);
    // What is wedged may have no solution, and the search for one may lead beyond all bounds.
    if (!(solution.residual <= most)) {
      faults_.push_back({CorrectionKind::omittedFriction, group.moved.bodies, solution.residual});
      solution = solveFrictionalContact(delassus, problem.free, std::vector<double>(problem.frictions.size(), 0));
    }
    if (!(solution.residual <= most)) {
      faults_.push_back({CorrectionKind::omittedContacts, group.moved.bodies, solution.residual});
      solution.impulses.setZero();
    }
    noteUnsolved(group, solution, kSolvedRatio * most);
    return solution.impulses;
  }
  const double fastest = problem.free.cwiseAbs().maxCoeff(), tolerance = kSolvedRatio * fastest;
  WarmStart start = startOf(group);
  const ContactSolution solution = sparse_.solve(problem.free, problem.frictions, tolerance, start, iterations_);
  penalties_[group.firstBody] = start.penalty;
  noteUnsolved(group, solution, tolerance);
  return solution.impulses;
}

void ContactStepping::noteUnsolved(const Group& group, const ContactSolution& solution, double tolerance) {
  if (!solution.converged && !(solution.residual <= tolerance))
    faults_.push_back({CorrectionKind::unsolvedContacts, group.moved.bodies, solution.residual});
}

void ContactStepping::limit(const Group& group, double most, VectorX& state) {
  const double taken = clampEnergy(group.moved, most, assembly_.mechanism, state);
  if (taken > 0) faults_.push_back({CorrectionKind::clampedEnergy, group.moved.bodies, taken});
}

/// Impulses and velocities of the step before, by the nearest contact of the same bodies.
WarmStart ContactStepping::startOf(const Group& group) const {
  const Index size = 3 * static_cast<Index>(group.members.size());
  WarmStart start{VectorX::Zero(size), VectorX::Zero(size), 0};
  const auto penalty = penalties_.find(group.firstBody);
  if (penalty != penalties_.end()) start.penalty = penalty->second;
  for (std::size_t i = 0; i < group.members.size(); ++i) {
    const Contact& contact = contacts_[group.members[i]].contact;
    double nearest = INFINITY;
    for (std::size_t k = 0; k < previous_.size(); ++k) {
      const Contact& other = previous_[k].contact;
      if (other.bodyA != contact.bodyA || other.bodyB != contact.bodyB) continue;
      const double distance = (other.point - contact.point).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      start.impulses.segment<3>(3 * static_cast<Index>(i)) =
          startPart_ * (sparse_.axes(i).transpose() * previous_[k].impulse);
      start.velocities.segment<3>(3 * static_cast<Index>(i)) = sparse_.axes(i).transpose() * previousSlips_[k];
    }
  }
  return start;
}

/// From free motion to where impulses lead, with the mean of the velocities at both ends: what lasts keeps order 2 and
/// its energy. Overlaps to which that leads where something strikes are taken out, and what lifts from the velocities.
/// Returns the contacts' velocities at the end.
VectorX ContactStepping::move(const Group& group, const Motion& motion, const VectorX& impulses, VectorX& state) {
  dense_ ? dense_->apply(impulses, state) : sparse_.apply(impulses, state);
  const VectorX end = sparse_.velocitiesIn(state);
  moveByMean(group, motion, state);
  const VectorX gaps = gapsAfter(group, motion.timeStep, 0.5 * (motion.start + end));
  if (gaps.minCoeff() >= -overlapTolerance_) return end;
  const double most = energyOf(group.moved.bodies, assembly_.mechanism, state);
  separate(group, gaps, state);
  limit(group, most, state);
  return end;
}

/// m: of the contacts after a step with velocities in their axes.
VectorX ContactStepping::gapsAfter(const Group& group, double timeStep, const VectorX& velocities) {
  VectorX gaps(group.contacts.size());
  for (Index i = 0; i < gaps.size(); ++i)
    gaps[i] = group.contacts[static_cast<std::size_t>(i)].separation + timeStep * velocities[3 * i + 2];
  return gaps;
}

void ContactStepping::moveByMean(const Group& group, const Motion& motion, VectorX& state) const {
  const double half = 0.5 * motion.timeStep;
  for (const int body : group.moved.bodies) {
    state.segment<kPoseSize>(body * kPoseSize) = free_.segment<kPoseSize>(body * kPoseSize);
    if (linearVelocity(state, body) != linearVelocity(free_, body))
      centerOfMass(state, body) = centerOfMass(motion.before, body) +
                                  half * (linearVelocity(motion.before, body) + linearVelocity(state, body));
    turnBody(state, body, half * (angularVelocity(state, body) - angularVelocity(free_, body)));
  }
}

void ContactStepping::restore(const std::vector<int>& bodies, VectorX& state) const {
  for (const int body : bodies) {
    state.segment<kPoseSize>(body * kPoseSize) = free_.segment<kPoseSize>(body * kPoseSize);
    state.segment<kVelocitySize>(velocityOffset(state, body)) =
        free_.segment<kVelocitySize>(velocityOffset(state, body));
  }
}

/// What struck is an impact, with its friction, and so is the closing that others still had; the rest of their work is
/// friction. What contacts would give of energy, in all, is an error and none of theirs; nor do they take more than
/// constraints, whose impulses are as large where contacts have short levers about a joint, leave of `loss` (J).
void ContactStepping::book(const Group& group, const Motion& motion, const VectorX& impulses, const VectorX& end,
                           double loss, VectorX& state) {
  double struck = 0, rubbed = 0, rubbedAtStart = 0;
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const Vec3 impulse = impulses.segment<3>(at), before = motion.start.segment<3>(at), after = end.segment<3>(at);
    const bool isImpact = contacts_[group.members[i]].isImpact;
    const Vec3 pressing = isImpact ? impulse : Vec3(0, 0, impulse.z()), rubbing = impulse - pressing;
    struck += energyTaken(pressing, before, after);
    rubbed += energyTaken(rubbing, before, after);
    rubbedAtStart += energyTaken(rubbing, before, before);
  }
  struck = std::max(0.0, struck), rubbed = std::max(0.0, rubbed);
  const double taken = struck + rubbed, left = std::max(0.0, loss);
  const double part = group.isConstrained && taken > left ? left / taken : 1;
  impactEnergy(state) += part * struck;
  if (rubbed == 0) return;
  frictionEnergy(state) += part * rubbed;
  frictionWork_.taken += part * rubbed, frictionWork_.atStart += part * rubbedAtStart;
}

/// Dampers and pushes worked along free motion; contact changed velocities little by little.
void ContactStepping::bookForces(double timeStep, VectorX& state) const {
  const Mechanism& mechanism = assembly_.mechanism;
  for (const SpringForce& spring : mechanism.springs)
    dampingEnergy(state) +=
        0.5 * timeStep * (actionOf(spring, state).dissipation - actionOf(spring, free_).dissipation);
  for (const PushForce& push : mechanism.pushes)
    pushWork(state) += 0.5 * timeStep * (powerOf(push, state) - powerOf(push, free_));
}

/// What the next step begins with, and who is told.
void ContactStepping::keep(const Group& group, const Motion& motion, const Problem& problem, const VectorX& impulses,
                           const VectorX& state) {
  const VectorX end = sparse_.velocitiesIn(state);
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    SteppedContact& stepped = contacts_[group.members[i]];
    stepped.impulse = sparse_.axes(i) * impulses.segment<3>(at);
    const double closing = motion.closing(at + 2), pressing = motion.pressing(at + 2);
    stepped.isImpact = impulses[at + 2] > 0 && closing > restSpeed(pressing, motion.timeStep);
    const Vec3 slip = end.segment<3>(at) + problem.free.segment<3>(at) - motion.free.segment<3>(at);
    slips_[group.members[i]] = sparse_.axes(i) * correctedVelocity(slip, problem.frictions[i]);
  }
}

}  // namespace cradle
