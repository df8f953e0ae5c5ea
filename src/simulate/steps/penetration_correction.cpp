// Displacements solve the frictional contact problem without friction: 0 <= W p + s perp p >= 0, s the gaps, W the
// Delassus operator and M^-1 J^T p the displacements (position correction by projection, as in "split impulse"
// methods).

#include "simulate/steps/penetration_correction.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr double kFarthestSeparation = 0.05;  // sizes, or rad: the rest is left to the steps to come
constexpr double kFarOverlaps = 10;  // of the farthest that a contact is moved: gaps that are as good as any wider ones

/// The largest displacement of bodies with a collider: in sizes of the body, or rad.
double largestDisplacement(const std::vector<int>& bodies, const std::vector<double>& radii,
                           const VectorX& displacement) {
  double largest = 0;
  for (const int body : bodies) {
    const double radius = radii[static_cast<std::size_t>(body)];
    if (radius == 0) continue;
    largest = std::max(
        {largest, linearVelocity(displacement, body).norm() / radius, angularVelocity(displacement, body).norm()});
  }
  return largest;
}

/// m: farther than any contact is moved by the correction of overlaps up to `deepest` (m). The push that takes an
/// overlap s_j out moves contact i by s_j W_ij / W_jj, which is below s_j sqrt(W_ii / W_jj): much more than s_j where
/// contact j has a short moment arm about a joint.
double farGap(const VectorX& gaps, double deepest, const GroupProblem& problem) {
  double most = 0, least = INFINITY;
  for (Eigen::Index i = 0; i < gaps.size(); ++i) {
    const double mobility = problem.mobility(static_cast<std::size_t>(i));
    if (!(mobility > StepTolerances::kMinMobility)) continue;
    most = std::max(most, mobility);
    if (gaps[i] < 0) least = std::min(least, mobility);
  }
  return kFarOverlaps * deepest * std::sqrt(std::max(1.0, most / least));
}

}  // namespace

void separateGroup(const StepGroup& group, const ContactSet& contacts, const VectorX& gaps, GroupProblem& problem,
                   VectorX& state) {
  const double deepest = -gaps.minCoeff(), far = farGap(gaps, deepest, problem);
  VectorX free = VectorX::Zero(3 * gaps.size());
  for (Eigen::Index i = 0; i < gaps.size(); ++i) {
    const bool isMobile = problem.mobility(static_cast<std::size_t>(i)) > StepTolerances::kMinMobility;
    free[3 * i + 2] = isMobile ? std::min(gaps[i], far) : far;
  }
  const double tolerance = contacts.tolerances().separationError(deepest);
  VectorX displacement = state;  // in the place of velocities
  displacement.tail(state.size() - poseComponents(state)).setZero();
  problem.apply(problem.solveFrictionless(free, tolerance), displacement);
  // Displacements are linearised: far along straight lines they lead astray.
  const double farthest = largestDisplacement(group.moved.bodies, contacts.assembly().radii, displacement);
  const double fraction = std::min(1.0, kFarthestSeparation / farthest);
  for (const int body : group.moved.bodies) {
    centerOfMass(state, body) += fraction * linearVelocity(displacement, body);
    turnBody(state, body, fraction * angularVelocity(displacement, body));
  }
}

void correctPenetration(const ContactSet& contacts, GroupProblem& problem, VectorX& state,
                        std::vector<SteppingFault>& faults) {
  const Mechanism& mechanism = contacts.assembly().mechanism;
  const VectorX before = state;
  const double constant = energyConstant(mechanism, state);
  for (const StepGroup& group : contacts.findGroups()) {
    VectorX gaps(group.contacts.size());
    for (Eigen::Index i = 0; i < gaps.size(); ++i) gaps[i] = group.contacts[static_cast<std::size_t>(i)].separation;
    if (gaps.minCoeff() >= -contacts.tolerances().overlap) continue;
    problem.set(group, state);
    const double most = energyOf(group.moved.bodies, mechanism, state);
    separateGroup(group, contacts, gaps, problem, state);
    if (group.isConstrained) problem.constraints().project(state);
    keepMomenta(group.moved, before, mechanism, state);
    clampEnergyWithFault(group.moved, most, mechanism, state, faults);
  }
  bookNumerical(constant, mechanism, state);
}

}  // namespace cradle
