// The matrix by its factors. With J = D J' M^-1/2, D the scale of each contact, (J J^T + s)^-1 b = (b - J (J^T J +
// s)^-1 J^T b) / s: what is factorised has six rows a body, whatever the number of its contacts, and couples only
// bodies that touch.
//
// Solved by Newton's method (contact_newton.h) from where the step before ended; where that does not lead to a
// solution, from where ADMM (contact_admm.h) and interior points (contact_interior_point.h) come, in turn. Of all that
// they find the best is kept.

#include "impact/sparse_contact_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "impact/contact_interior_point.h"
#include "impact/contact_newton.h"
#include "impact/dense_contact_problem.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kLargest = 4;          // bound that a few contacts a body stay below, of scaled inverse masses
constexpr double kProximal = 1e-7;      // eta, scaled
constexpr double kFirstPenalty = 1e-4;  // rho, scaled
constexpr double kMinPenalty = 1e-6;    // of the same: below, the difference b - ... is rounding
constexpr int kMaxTrials = 10;          // to come near enough for Newton's method
constexpr int kInteriorTrial = 1;       // of them: by the interior point method, the others by ADMM
constexpr int kIterations = 10;         // of ADMM before Newton's method is tried again; then twice as many, and so on
constexpr double kHardFactor = 10;      // of the tolerance: enough where the interior point method was not
constexpr double kSparseInteriorRatio = 0.5;  // of the tolerance: where the interior point method ends
constexpr double kRegular = 1e-9;             // scaled inverse mass: makes redundant contacts solvable
constexpr int kMaxSparseNewtonSteps = 6;      // 1 or 2 from the step before, where nothing changes

}  // namespace

SparseContactProblem::Row SparseContactProblem::rowOf(const Contact& contact, const std::array<int, 2>& bodies,
                                                      const VectorX& state) const {
  Row row{contactAxes(contact.normal), bodies, {Mat36::Zero(), Mat36::Zero()}, 1};
  double inverseMass = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    if (bodies[side] < 0) continue;
    const BodyRoot& body = bodies_[static_cast<std::size_t>(bodies[side])];
    const Vec3 arm = contact.point - centerOfMass(state, body.index);
    const double sign = side == 0 ? -1 : 1;
    row.j[side].leftCols<3>() = sign * body.inverseMass * row.axes.transpose();
    row.j[side].rightCols<3>() = -sign * row.axes.transpose() * skew(arm) * body.inverseInertia;
    inverseMass += row.j[side].squaredNorm() / 3;
  }
  if (inverseMass > 0) row.scale = 1 / std::sqrt(inverseMass);
  for (Mat36& j : row.j) j *= row.scale;
  return row;
}

void SparseContactProblem::set(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies,
                               const VectorX& state) {
  contacts_.clear(), bodies_.clear(), pairs_.clear(), pairOf_.clear();
  std::map<int, int> known;
  const auto localOf = [&](int body) {
    if (body == kFixed) return -1;
    const auto [place, isNew] = known.try_emplace(body, static_cast<int>(bodies_.size()));
    if (isNew) {
      const RigidBody& inertia = bodies[static_cast<std::size_t>(body)];
      const Mat3 inverse = worldInverseInertia(inertia, orientation(state, body));
      bodies_.push_back({body, std::sqrt(inertia.inverseMass), Mat3(inverse.llt().matrixL())});
    }
    return place->second;
  };
  std::map<std::pair<int, int>, std::size_t> pairs;
  for (const Contact& contact : contacts) {
    const Row row = rowOf(contact, {localOf(contact.bodyA), localOf(contact.bodyB)}, state);
    const std::pair<int, int> pair(std::max(row.body[0], row.body[1]), std::min(row.body[0], row.body[1]));
    std::size_t at = SIZE_MAX;
    if (pair.second >= 0) {
      const auto [place, isNew] = pairs.try_emplace(pair, pairs_.size());
      if (isNew) pairs_.push_back(pair);
      at = place->second;
    }
    pairOf_.push_back(at);
    contacts_.push_back(row);
  }
  shift_ = 0;
  if (pairs_ == analyzed_ && bodies_.size() == analyzedBodies_) return;
  analyzed_ = pairs_, analyzedBodies_ = bodies_.size();
  factor_.analyze(static_cast<int>(bodies_.size()), pairs_);
}

VectorX SparseContactProblem::velocitiesIn(const VectorX& velocities) const {
  VectorX all = VectorX::Zero(3 * static_cast<Index>(contacts_.size()));
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side) {
      const Row& row = contacts_[i];
      if (row.body[side] < 0) continue;
      const BodyRoot& body = bodies_[static_cast<std::size_t>(row.body[side])];
      const Vec3 turn =
          body.inverseInertia.triangularView<Eigen::Lower>().solve(Vec3(angularVelocity(velocities, body.index)));
      all.segment<3>(3 * static_cast<Index>(i)) +=
          (row.j[side].leftCols<3>() * linearVelocity(velocities, body.index) / body.inverseMass +
           row.j[side].rightCols<3>() * turn) /
          row.scale;
    }
  return all;
}

void SparseContactProblem::apply(const VectorX& impulses, VectorX& state) const {
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side) {
      const Row& row = contacts_[i];
      if (row.body[side] < 0) continue;
      const BodyRoot& body = bodies_[static_cast<std::size_t>(row.body[side])];
      const Vec3 z = impulses.segment<3>(3 * static_cast<Index>(i)) / row.scale;
      linearVelocity(state, body.index) += body.inverseMass * (row.j[side].leftCols<3>().transpose() * z);
      angularVelocity(state, body.index) += body.inverseInertia * (row.j[side].rightCols<3>().transpose() * z);
    }
}

MatrixX SparseContactProblem::delassus() const {
  const Index size = 3 * static_cast<Index>(contacts_.size());
  MatrixX g = MatrixX::Zero(size, size);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t k = 0; k <= i; ++k) {
      Mat3 block = Mat3::Zero();
      for (std::size_t one = 0; one < 2; ++one)
        for (std::size_t other = 0; other < 2; ++other)
          if (contacts_[i].body[one] >= 0 && contacts_[i].body[one] == contacts_[k].body[other])
            block += contacts_[i].j[one] * contacts_[k].j[other].transpose();
      block /= contacts_[i].scale * contacts_[k].scale;
      g.block<3, 3>(3 * static_cast<Index>(i), 3 * static_cast<Index>(k)) = block;
      g.block<3, 3>(3 * static_cast<Index>(k), 3 * static_cast<Index>(i)) = block.transpose();
    }
  return g;
}

/// shift + sum over contacts of J^T stiffness J.
void SparseContactProblem::assemble(double shift, const std::vector<Mat3>& scalingBlocks) {
  factor_.clear();
  for (std::size_t body = 0; body < bodies_.size(); ++body) factor_.diagonal(body).diagonal().setConstant(shift);
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Row& row = contacts_[c];
    const std::array<Mat36, 2> kj = {scalingBlocks[c] * row.j[0], scalingBlocks[c] * row.j[1]};
    for (std::size_t side = 0; side < 2; ++side)
      if (row.body[side] >= 0)
        factor_.diagonal(static_cast<std::size_t>(row.body[side])).noalias() += row.j[side].transpose() * kj[side];
    if (pairOf_[c] == SIZE_MAX) continue;
    const std::size_t first = pairs_[pairOf_[c]].first == row.body[0] ? 0 : 1, second = 1 - first;
    factor_.firstRow(pairOf_[c]).noalias() += row.j[first].transpose() * kj[second];
    factor_.secondRow(pairOf_[c]).noalias() += row.j[second].transpose() * kj[first];
  }
  factor_.factorize();
}

void SparseContactProblem::factorize(double shift) {
  if (shift == shift_) return;
  scalingBlocks_.assign(contacts_.size(), Mat3::Identity());
  assemble(shift, scalingBlocks_);
  shift_ = shift;
}

/// J^T impulses.
void SparseContactProblem::gather(const VectorX& impulses) {
  bodyWork_.setZero(6 * static_cast<Index>(bodies_.size()));
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side)
      if (const int body = contacts_[i].body[side]; body >= 0)
        bodyWork_.segment<6>(6 * body).noalias() +=
            contacts_[i].j[side].transpose() * impulses.segment<3>(3 * static_cast<Index>(i));
}

/// J times what is left of the bodies, at one contact.
Vec3 SparseContactProblem::velocityOfBodies(std::size_t contact) const {
  const Row& row = contacts_[contact];
  Vec3 velocity = Vec3::Zero();
  for (std::size_t side = 0; side < 2; ++side)
    if (const int body = row.body[side]; body >= 0) velocity.noalias() += row.j[side] * bodyWork_.segment<6>(6 * body);
  return velocity;
}

void SparseContactProblem::solveShifted(VectorX& b) {
  gather(b);
  factor_.solve(bodyWork_);
  for (std::size_t i = 0; i < contacts_.size(); ++i) b.segment<3>(3 * static_cast<Index>(i)) -= velocityOfBodies(i);
  b /= shift_;
}

void SparseContactProblem::multiply(const VectorX& impulses, VectorX& velocities) {
  gather(impulses);
  velocities = cones_.free;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    velocities.segment<3>(3 * static_cast<Index>(i)) += velocityOfBodies(i);
}

/// Newton's method as in frictional_contact.cpp, A dz + B du = -F by contact, du = J dv: (1 + sum J^T A^-1 B J) dv =
/// -sum J^T A^-1 F by body.
void SparseContactProblem::stepByNewton(VectorX& z, VectorX& u) {
  scalingBlocks_.assign(contacts_.size(), Mat3::Zero());
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
    scalingBlocks_[i] = inverse * row.ofVelocity;
    change.segment<3>(at) = -inverse * row.value;
  }
  shift_ = 0;
  assemble(1, scalingBlocks_);
  gather(change);
  factor_.solve(bodyWork_);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    change.segment<3>(3 * static_cast<Index>(i)) -= scalingBlocks_[i] * velocityOfBodies(i);
  z += change;
  multiply(z, u);
}

/// Changes the impulses only if it converges.
bool SparseContactProblem::polish(VectorX& impulses, VectorX& velocities, double tolerance) {
  VectorX z = impulses, u = velocities;
  for (int step = 0; step < kMaxSparseNewtonSteps; ++step) {
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
double SparseContactProblem::residual(const VectorX& z, const VectorX& u) const {
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
void SparseContactProblem::approachByAdmm(int iterations, AdmmIterate& at) {
  const auto shifted = [this](VectorX& b) { solveShifted(b); };
  for (int done = 0; done < iterations; done += kIterations) {
    factorize(at.penalty + kProximal);
    iterateAdmm(cones_, kProximal, shifted, kIterations, at);
    at.penalty = std::max(balancedPenalty(at, kLargest), kMinPenalty);
  }
}

/// By the interior point method, from nothing. Returns its iterations.
long SparseContactProblem::approachFromInside(double tolerance, AdmmIterate& at) {
  shift_ = 0;
  ContactOperator op;
  op.multiply = [this](const VectorX& z, VectorX& u) { multiply(z, u); };
  op.respond = [this](const std::vector<Mat3>& scalingBlocks, bool isNew, const VectorX& c, VectorX& du) {
    if (isNew) assemble(1, scalingBlocks);
    gather(c);
    factor_.solve(bodyWork_);
    du.resize(c.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) du.segment<3>(3 * static_cast<Index>(i)) = velocityOfBodies(i);
  };
  double least = INFINITY;
  for (const Row& row : contacts_) least = std::min(least, row.scale);
  const long iterations = solveByInteriorPoint(cones_, op, kSparseInteriorRatio * least * tolerance, at.impulses);
  VectorX u;
  multiply(at.impulses, u);
  takeVelocities(u, at);
  return iterations;
}

/// The iterate's velocities from those that its impulses give.
void SparseContactProblem::takeVelocities(const VectorX& u, AdmmIterate& at) const {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    at.velocities.segment<3>(k) = correctedVelocity(u.segment<3>(k), cones_.frictions[i]);
  }
  at.unbounded = at.impulses;
}

/// Keeps impulses that obey Coulomb's law better than the best so far. True if they do as well as asked, or those do
/// that Newton's method finds from there.
bool SparseContactProblem::accept(const VectorX& impulses, double tolerance, Found& found) {
  VectorX z = impulses, u;
  multiply(z, u);
  double left = residual(z, u);
  const bool isNear = left <= tolerance || polish(z, u, tolerance);
  if (isNear) left = residual(z, u);
  if (left < found.residual) found = {std::move(z), std::move(u), left};
  return isNear;
}

/// The iterate, scaled, of where an iteration begins.
AdmmIterate SparseContactProblem::scaled(const WarmStart& start) const {
  AdmmIterate at;
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
bool SparseContactProblem::search(double tolerance, AdmmIterate& at, Found& found, long& iterations) {
  if (accept(at.impulses, tolerance, found)) return true;
  int round = kIterations;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    if (trial == kInteriorTrial) {
      iterations += approachFromInside(tolerance, at);
    } else {
      approachByAdmm(round, at);
      iterations += round;
      round *= 2;
    }
    if (accept(at.impulses, (trial > kInteriorTrial ? kHardFactor : 1) * tolerance, found)) return true;
  }
  return false;
}

ContactSolution SparseContactProblem::solve(const VectorX& free, const std::vector<double>& frictions, double tolerance,
                                            WarmStart& start, long& iterations) {
  cones_.free = free, cones_.frictions = frictions;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    cones_.free.segment<3>(3 * static_cast<Index>(i)) *= contacts_[i].scale;
  AdmmIterate at = scaled(start);
  Found found{VectorX::Zero(free.size()), cones_.free};
  ContactSolution solution;
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
