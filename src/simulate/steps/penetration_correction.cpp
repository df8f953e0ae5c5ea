// Overlaps are taken out by displacements that solve the frictional contact problem without friction: the least that
// makes gaps zero.

#include <algorithm>

#include "simulate/steps/contact_stepping.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kSeparatedRatio = 0.1;   // of the overlaps that are let be: how well others are taken out, ...
constexpr double kSeparatedError = 1e-3;  // ... or of the deepest
// Of the inverse mass without constraints: where a joint is nearer to a contact than 1e-3 of the size, an overlap is
// let be. Taking it out would lift the body by more than a thousand times as much, against all forces.
constexpr double kMinMobility = 1e-6;
constexpr double kFarthestSeparation = 0.05;  // sizes, or rad: the rest is left to the steps to come
constexpr double kFarOverlaps = 10;           // of the deepest overlap: gaps that are as good as any wider ones

}  // namespace

void ContactStepping::correctPenetration(const std::vector<Contact>& contacts,
                                         const std::vector<const RopeLimit*>& ropes, VectorX& state) {
  const std::vector<SteppedContact> last = contacts_;
  begin(contacts, ropes, state, 0, state);
  const double constant = energyConstant(assembly_.mechanism, state);
  for (const Group& group : findGroups()) {
    VectorX gaps(group.contacts.size());
    for (Index i = 0; i < gaps.size(); ++i) gaps[i] = group.contacts[static_cast<std::size_t>(i)].separation;
    if (gaps.minCoeff() >= -overlapTolerance_) continue;
    setContactProblem(group, state);
    const double most = energyOf(group.moved.bodies, assembly_.mechanism, state);
    separate(group, gaps, state);
    if (group.isConstrained) solver_.project(state);
    keepMomenta(group.moved, free_, assembly_.mechanism, state);
    limit(group, most, state);
  }
  contacts_ = last;
  bookNumerical(constant, assembly_.mechanism, state);
}

/// Moves bodies apart where `gaps` (m) at the step's end are negative, without touching velocities.
void ContactStepping::separate(const Group& group, const VectorX& gaps, VectorX& state) {
  const double deepest = -gaps.minCoeff();
  Problem problem{VectorX::Zero(3 * gaps.size()), std::vector<double>(group.contacts.size(), 0)};
  for (Index i = 0; i < gaps.size(); ++i) {
    const bool isMobile = !dense_ || dense_->leverage(static_cast<std::size_t>(i)) > kMinMobility;
    problem.free[3 * i + 2] = isMobile ? std::min(gaps[i], kFarOverlaps * deepest) : kFarOverlaps * deepest;
  }
  VectorX displacement = state;
  displacement.tail(state.size() - poseComponents(state)).setZero();
  if (dense_ || group.contacts.size() <= kFewContacts) {
    const VectorX pushes = solveFrictionalContact(delassus(), problem.free, problem.frictions).impulses;
    dense_ ? dense_->apply(pushes, displacement) : sparse_.apply(pushes, displacement);
  } else {
    WarmStart start{VectorX::Zero(3 * gaps.size()), VectorX::Zero(3 * gaps.size()), 0};
    const double tolerance = std::max(kSeparatedRatio * overlapTolerance_, kSeparatedError * deepest);
    sparse_.apply(sparse_.solve(problem.free, problem.frictions, tolerance, start, iterations_).impulses, displacement);
  }
  double farthest = 0;  // in sizes, or rad: what leads far along straight lines leads astray
  for (const int body : group.moved.bodies) {
    const double radius = assembly_.radii[static_cast<std::size_t>(body)];
    if (radius == 0) continue;  // without a collider
    farthest = std::max(
        {farthest, linearVelocity(displacement, body).norm() / radius, angularVelocity(displacement, body).norm()});
  }
  const double part = std::min(1.0, kFarthestSeparation / farthest);
  for (const int body : group.moved.bodies) {
    centerOfMass(state, body) += part * linearVelocity(displacement, body);
    turnBody(state, body, part * angularVelocity(displacement, body));
  }
}

}  // namespace cradle
