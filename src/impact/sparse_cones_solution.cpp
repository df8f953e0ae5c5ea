// Newton's method (cone_newton.h) from where the step before ended; where that does not lead to a solution, from where
// ADMM (cone_iteration.h) and interior points (cone_interior.h) come, in turn. Of all that they find the best is kept.

#include <algorithm>
#include <cmath>

#include "impact/cone_interior.h"
#include "impact/cone_newton.h"
#include "impact/sparse_cones.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kLargest = 4;          // bound that a few contacts a body stay below, of scaled inverse masses
constexpr double kProximal = 1e-7;      // eta, scaled
constexpr double kFirstPenalty = 1e-4;  // rho, scaled
constexpr double kLeastPenalty = 1e-6;  // of the same: below, the difference b - ... is rounding
constexpr int kMostTrials = 10;         // to come near enough for Newton's method
constexpr int kInteriorTrial = 1;       // of them: by the interior point method, the others by ADMM
constexpr int kIterations = 10;         // of ADMM before Newton's method is tried again; then twice as many, and so on
constexpr double kHardFactor = 10;      // of the tolerance: enough where the interior point method was not
constexpr double kSparseInteriorPart = 0.5;  // of the tolerance: where the interior point method ends
constexpr double kRegular = 1e-9;            // scaled inverse mass: makes redundant contacts solvable
constexpr int kMostSparseNewtonSteps = 6;    // 1 or 2 from the step before, where nothing changes

}  // namespace

/// Newton's method as in cone_problem.cpp, A dz + B du = -F by contact, du = J dv: (1 + sum J^T A^-1 B J) dv = -sum J^T
/// A^-1 F by body.
void SparseCones::stepByNewton(VectorX& z, VectorX& u) {
  stiffnesses_.assign(contacts_.size(), Mat3::Zero());
  VectorX change = VectorX::Zero(z.size());
  std::vector<char> isPushing(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    isPushing[i] = pushes(z.segment<3>(at), u.segment<3>(at));
    if (!isPushing[i]) z.segment<3>(at).setZero();
  }
  multiply(z, u);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!isPushing[i]) continue;
    const Index at = 3 * static_cast<Index>(i);
    const NewtonRow row = newtonRow(z.segment<3>(at), u.segment<3>(at), cones_.frictions[i], kRegular);
    const Mat3 inverse = row.ofImpulse.inverse();
    stiffnesses_[i] = inverse * row.ofVelocity;
    change.segment<3>(at) = -inverse * row.value;
  }
  shift_ = 0;
  assemble(1, stiffnesses_);
  gather(change);
  factor_.solve(bodyWork_);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    change.segment<3>(3 * static_cast<Index>(i)) -= stiffnesses_[i] * velocityOfBodies(i);
  z += change;
  multiply(z, u);
}

/// Changes the impulses only if it converges.
bool SparseCones::finish(VectorX& impulses, VectorX& velocities, double tolerance) {
  VectorX z = impulses, u = velocities;
  for (int step = 0; step < kMostSparseNewtonSteps; ++step) {
    stepByNewton(z, u);
    const double left = residual(z, u);
    if (!(left < INFINITY)) return false;
    if (left > tolerance) continue;
    impulses = z, velocities = u;
    return true;
  }
  return false;
}

/// In m/s, of the worst contact.
double SparseCones::residual(const VectorX& z, const VectorX& u) const {
  double largest = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const Vec3 error = coulombResidual(z.segment<3>(at), u.segment<3>(at), cones_.frictions[i]);
    if (!error.allFinite()) return INFINITY;
    largest = std::max(largest, error.cwiseAbs().maxCoeff() / contacts_[i].scale);
  }
  return largest;
}

/// ADMM, with a penalty that is balanced again and again.
void SparseCones::approachByAdmm(int iterations, ConeIterate& at) {
  const auto shifted = [this](VectorX& b) { solveShifted(b); };
  for (int done = 0; done < iterations; done += kIterations) {
    factorize(at.penalty + kProximal);
    iterateCones(cones_, kProximal, shifted, kIterations, at);
    at.penalty = std::max(balancedPenalty(at, kLargest), kLeastPenalty);
  }
}

/// By the interior point method, from nothing. Returns its iterations.
long SparseCones::approachFromInside(double tolerance, ConeIterate& at) {
  shift_ = 0;
  ConeOperator op;
  op.multiply = [this](const VectorX& z, VectorX& u) { multiply(z, u); };
  op.respond = [this](const std::vector<Mat3>& stiffnesses, bool isNew, const VectorX& c, VectorX& du) {
    if (isNew) assemble(1, stiffnesses);
    gather(c);
    factor_.solve(bodyWork_);
    du.resize(c.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) du.segment<3>(3 * static_cast<Index>(i)) = velocityOfBodies(i);
  };
  double least = INFINITY;
  for (const Row& row : contacts_) least = std::min(least, row.scale);
  const long iterations = solveByInteriorPoint(cones_, op, kSparseInteriorPart * least * tolerance, at.impulses);
  VectorX u;
  multiply(at.impulses, u);
  takeVelocities(u, at);
  return iterations;
}

/// The iterate's velocities from those that its impulses give.
void SparseCones::takeVelocities(const VectorX& u, ConeIterate& at) const {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    at.velocities.segment<3>(k) = correctedVelocity(u.segment<3>(k), cones_.frictions[i]);
  }
  at.unbounded = at.impulses;
}

/// Keeps impulses that obey Coulomb's law better than the best so far. True if they do as well as asked, or those do
/// that Newton's method finds from there.
bool SparseCones::take(const VectorX& impulses, double tolerance, Found& found) {
  VectorX z = impulses, u;
  multiply(z, u);
  double left = residual(z, u);
  const bool isNear = left <= tolerance || finish(z, u, tolerance);
  if (isNear) left = residual(z, u);
  if (left < found.residual) found = {std::move(z), std::move(u), left};
  return isNear;
}

/// The iterate, scaled, of where an iteration begins.
ConeIterate SparseCones::scaled(const ConeStart& start) const {
  ConeIterate at;
  at.impulses = start.impulses, at.velocities = start.velocities;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    at.impulses.segment<3>(k) /= contacts_[i].scale, at.velocities.segment<3>(k) *= contacts_[i].scale;
  }
  at.unbounded = at.impulses;
  at.penalty = start.penalty > 0 ? start.penalty : kFirstPenalty;
  return at;
}

/// From the iterate by one method after the other, until a solution is found.
bool SparseCones::search(double tolerance, ConeIterate& at, Found& found, long& iterations) {
  if (take(at.impulses, tolerance, found)) return true;
  int round = kIterations;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    if (trial == kInteriorTrial) {
      iterations += approachFromInside(tolerance, at);
    } else {
      approachByAdmm(round, at);
      iterations += round;
      round *= 2;
    }
    if (take(at.impulses, (trial > kInteriorTrial ? kHardFactor : 1) * tolerance, found)) return true;
  }
  return false;
}

ConeSolution SparseCones::solve(const VectorX& free, const std::vector<double>& frictions, double tolerance,
                                ConeStart& start, long& iterations) {
  cones_.free = free, cones_.frictions = frictions;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    cones_.free.segment<3>(3 * static_cast<Index>(i)) *= contacts_[i].scale;
  ConeIterate at = scaled(start);
  Found found{VectorX::Zero(free.size()), cones_.free};
  ConeSolution solution;
  solution.converged = search(tolerance, at, found, iterations);
  solution.residual = found.residual;
  at.impulses = found.impulses;
  takeVelocities(found.velocities, at);
  start.penalty = at.penalty;
  solution.impulses = start.impulses = at.impulses, solution.velocities = found.velocities;
  start.velocities = at.velocities;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    solution.impulses.segment<3>(k) *= contacts_[i].scale, solution.velocities.segment<3>(k) /= contacts_[i].scale;
    start.impulses.segment<3>(k) *= contacts_[i].scale, start.velocities.segment<3>(k) /= contacts_[i].scale;
  }
  return solution;
}

}  // namespace cradle
