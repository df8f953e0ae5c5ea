// J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988; M. Jean, "The non-smooth
// contact dynamics method", Comput. Methods Appl. Mech. Engrg. 177, 1999: velocities at the step's end are the
// unknowns, impulses of a step may be forces or shocks. What is apart by a gap s may close with s/h at most.

#include "simulate/contact_stepping.h"

#include <algorithm>
#include <cmath>

#include "dynamics/invariants.h"
#include "impact/contact_cones.h"
#include "simulate/islands.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kSlidingSpeed = 1e-6;     // m/s: slower counts as sticking
constexpr double kRestSteps = 2;           // a rebound that ends within as many steps is not resolved
constexpr double kRestSpeedFloor = 1e-12;  // m/s: rounding
constexpr double kRestSpeedPart = 0.01;    // of the speed that gravity gives in a step: slower is no impact
constexpr double kOverlapPart = 1e-9;      // of the smallest body's size: deeper overlaps are taken out
constexpr double kSmoothPart = 1e-2;       // of that: overlaps that the mean velocity may add in a step
constexpr std::size_t kFewContacts = 6;    // solved densely, to rounding
constexpr double kSeparatedPart = 0.1;     // of the overlaps that are let be: how well others are taken out, ...
constexpr double kSeparatedError = 1e-3;   // ... or of the deepest
constexpr double kFarOverlaps = 10;        // of the deepest overlap: gaps that are as good as any wider ones
constexpr double kSolvedPart = 1e-7;       // of the fastest velocity

double smallestSize(const ContactGeometry& geometry) {
  double smallest = 1;
  for (const Collider& collider : geometry.colliders)
    if (collider.body != kFixed) smallest = std::min(smallest, collider.boundingRadius);
  return smallest;
}

}  // namespace

ContactStepping::ContactStepping(const Assembly& assembly)
    : assembly_(assembly),
      solver_(assembly.mechanism.constraints, assembly.mechanism.bodies),
      overlapTolerance_(kOverlapPart * smallestSize(assembly.geometry)) {}

void ContactStepping::resolve(const std::vector<Contact>& contacts, const VectorX& before, double timeStep,
                              VectorX& state) {
  previous_.swap(contacts_), previousSlips_.swap(slips_);
  contacts_.clear();
  for (const Contact& contact : contacts) contacts_.push_back({contact, Vec3::Zero(), false});
  slips_.assign(contacts.size(), Vec3::Zero());
  if (contacts.empty()) return;
  free_ = state;
  const Invariants free = invariantsOf(assembly_.mechanism, state);
  if (solver_.hasConstraints()) solver_.factorize(before);
  for (const Group& group : findGroups()) resolve(group, before, timeStep, state);
  const Invariants held = invariantsOf(assembly_.mechanism, state);
  dissipatedEnergy(state) += free.kinetic + free.potential - held.kinetic - held.potential;
}

/// Contacts whose bodies touch or are tied to each other.
std::vector<ContactStepping::Group> ContactStepping::findGroups() const {
  Islands islands(assembly_.mechanism.bodies.size());
  std::vector<char> isTied(assembly_.mechanism.bodies.size(), 0);
  forEachTie(assembly_.mechanism.constraints, [&](int bodyA, int bodyB) {
    islands.join(bodyA, bodyB);
    for (const int body : {bodyA, bodyB})
      if (body != kFixed) isTied[static_cast<std::size_t>(body)] = 1;
  });
  for (const SteppedContact& stepped : contacts_) islands.join(stepped.contact.bodyA, stepped.contact.bodyB);
  std::map<int, Group> groups;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& contact = contacts_[i].contact;
    const int body = contact.bodyA != kFixed ? contact.bodyA : contact.bodyB;
    groups[islands.islandOf(body)].members.push_back(i);
  }
  for (std::size_t body = 0; body < isTied.size(); ++body)
    if (const auto group = groups.find(islands.islandOf(static_cast<int>(body))); group != groups.end())
      group->second.isTied = group->second.isTied || isTied[body];
  std::vector<Group> ordered;
  for (auto& [firstBody, group] : groups) {
    group.firstBody = firstBody;
    ordered.push_back(std::move(group));
  }
  return ordered;
}

/// Speed (m/s) of closing that does not rebound; `pressing` is what a step adds to it.
double ContactStepping::restSpeed(double pressing, double timeStep) const {
  return kRestSteps * pressing + kRestSpeedPart * assembly_.mechanism.gravity.norm() * timeStep + kRestSpeedFloor;
}

/// The cone problem: what is left of the gap, or the rebound, is taken from the normal velocities.
ContactStepping::Problem ContactStepping::posed(const std::vector<Contact>& contacts, const VectorX& startVelocities,
                                                const VectorX& freeVelocities, double timeStep) const {
  Problem problem{freeVelocities, {}};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const SurfaceLaw& law = assembly_.geometry.pairs[contacts[i].pair].law;
    const bool slides = startVelocities.segment<2>(at).norm() > kSlidingSpeed;
    problem.frictions.push_back(slides ? law.dynamicFriction : law.staticFriction);
    const double closing = -startVelocities[at + 2], pressing = std::max(0.0, -closing - freeVelocities[at + 2]);
    const double gap = std::max(0.0, contacts[i].separation);
    const bool touches = gap + timeStep * freeVelocities[at + 2] < 0;
    const bool rebounds = touches && law.restitution * closing > restSpeed(pressing, timeStep);
    problem.free[at + 2] -= rebounds ? law.restitution * closing - pressing : -gap / timeStep;
  }
  return problem;
}

void ContactStepping::resolve(const Group& group, const VectorX& before, double timeStep, VectorX& state) {
  std::vector<Contact> contacts;
  std::vector<int> bodies;
  for (const std::size_t i : group.members) {
    contacts.push_back(contacts_[i].contact);
    for (const int body : {contacts.back().bodyA, contacts.back().bodyB})
      if (body != kFixed) bodies.push_back(body);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());

  // How fast would the contacts close, and what stops them?
  cones_.set(contacts, assembly_.mechanism.bodies, before);
  const VectorX startVelocities = cones_.velocitiesIn(before), freeVelocities = cones_.velocitiesIn(state);
  const Problem problem = posed(contacts, startVelocities, freeVelocities, timeStep);
  VectorX impulses;
  if (group.isTied) {
    const ContactCones tied(contacts, ImpulseResponse(assembly_.mechanism.bodies, solver_), before);
    impulses = solveTied(problem, tied.inverseMass());
    tied.apply(impulses, state);
  } else {
    impulses = solveUntied(group, problem);
    cones_.apply(impulses, state);
  }

  // Where do the new velocities lead?
  const VectorX endVelocities = cones_.velocitiesIn(state);
  bool isSmooth = true;
  VectorX gaps(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const double mean = 0.5 * (startVelocities[at + 2] + endVelocities[at + 2]), gap = contacts[i].separation;
    gaps[static_cast<Index>(i)] = gap + timeStep * mean;
    isSmooth = isSmooth && gap + timeStep * mean > std::min(0.0, gap) - kSmoothPart * overlapTolerance_;
  }
  if (!isSmooth)
    for (std::size_t i = 0; i < contacts.size(); ++i)
      gaps[static_cast<Index>(i)] = contacts[i].separation + timeStep * endVelocities[3 * static_cast<Index>(i) + 2];
  move(bodies, isSmooth, before, timeStep, state);
  if (gaps.minCoeff() < -overlapTolerance_) separate(contacts, gaps, group.isTied, before, state);

  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    SteppedContact& stepped = contacts_[group.members[i]];
    stepped.impulse = cones_.axes(i) * impulses.segment<3>(at);
    const double closing = -startVelocities[at + 2], pressing = std::max(0.0, -closing - freeVelocities[at + 2]);
    stepped.isImpact = impulses[at + 2] > 0 && closing > restSpeed(pressing, timeStep);
    const Vec3 slip = endVelocities.segment<3>(at) + problem.free.segment<3>(at) - freeVelocities.segment<3>(at);
    slips_[group.members[i]] = cones_.axes(i) * correctedVelocity(slip, problem.frictions[i]);
  }
}

VectorX ContactStepping::solveUntied(const Group& group, const Problem& problem) {
  const double tolerance = kSolvedPart * problem.free.cwiseAbs().maxCoeff();
  if (group.members.size() <= kFewContacts) return solveTied(problem, cones_.inverseMass());
  ConeStart start = startOf(group);
  const ConeSolution solution = cones_.solve(problem.free, problem.frictions, tolerance, start, count_.iterations);
  penalties_[group.firstBody] = start.penalty;
  count(solution);
  return solution.impulses;
}

VectorX ContactStepping::solveTied(const Problem& problem, const MatrixX& inverseMass) {
  const ConeSolution solution = solveConeProblem(inverseMass, problem.free, problem.frictions);
  count(solution);
  return solution.impulses;
}

void ContactStepping::count(const ConeSolution& solution) {
  ++count_.problems;
  if (solution.converged) return;
  ++count_.unsolved;
  count_.worstResidual = std::max(count_.worstResidual, solution.residual);
}

/// Impulses and velocities of the step before, by the nearest contact of the same bodies.
ConeStart ContactStepping::startOf(const Group& group) const {
  const Index size = 3 * static_cast<Index>(group.members.size());
  ConeStart start{VectorX::Zero(size), VectorX::Zero(size), 0};
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
      start.impulses.segment<3>(3 * static_cast<Index>(i)) = cones_.axes(i).transpose() * previous_[k].impulse;
      start.velocities.segment<3>(3 * static_cast<Index>(i)) = cones_.axes(i).transpose() * previousSlips_[k];
    }
  }
  return start;
}

/// With the mean of the velocities at both ends, where that leads into no overlap: what lasts keeps order 2 and its
/// energy. Else with those at the end, which the gaps were asked of.
void ContactStepping::move(const std::vector<int>& bodies, bool isSmooth, const VectorX& before, double timeStep,
                           VectorX& state) {
  for (const int body : bodies) {
    if (isSmooth) {
      centerOfMass(state, body) += 0.5 * timeStep * (linearVelocity(state, body) - linearVelocity(free_, body));
      turnBody(state, body, 0.5 * timeStep * (angularVelocity(state, body) - angularVelocity(free_, body)));
    } else {
      centerOfMass(state, body) = centerOfMass(before, body) + timeStep * linearVelocity(state, body);
      setOrientation(state, body, orientation(before, body));
      turnBody(state, body, timeStep * angularVelocity(state, body));
    }
  }
}

/// Moves bodies apart where `gaps` (m) at the step's end are negative, without touching velocities.
void ContactStepping::separate(const std::vector<Contact>& contacts, const VectorX& gaps, bool isTied,
                               const VectorX& before, VectorX& state) {
  const double deepest = -gaps.minCoeff();
  Problem problem{VectorX::Zero(3 * gaps.size()), std::vector<double>(contacts.size(), 0)};
  for (Index i = 0; i < gaps.size(); ++i) problem.free[3 * i + 2] = std::min(gaps[i], kFarOverlaps * deepest);
  VectorX displacement = state;
  displacement.tail(state.size() - poseComponents(state)).setZero();
  if (isTied) {
    const ContactCones tied(contacts, ImpulseResponse(assembly_.mechanism.bodies, solver_), before);
    tied.apply(solveConeProblem(tied.inverseMass(), problem.free, problem.frictions).impulses, displacement);
  } else if (contacts.size() <= kFewContacts) {
    cones_.apply(solveConeProblem(cones_.inverseMass(), problem.free, problem.frictions).impulses, displacement);
  } else {
    ConeStart start{VectorX::Zero(3 * gaps.size()), VectorX::Zero(3 * gaps.size()), 0};
    const double tolerance = std::max(kSeparatedPart * overlapTolerance_, kSeparatedError * deepest);
    cones_.apply(cones_.solve(problem.free, problem.frictions, tolerance, start, count_.iterations).impulses,
                 displacement);
  }
  for (Index body = 0; body < bodyCount(state); ++body) {
    centerOfMass(state, body) += linearVelocity(displacement, body);
    turnBody(state, body, angularVelocity(displacement, body));
  }
}

}  // namespace cradle
