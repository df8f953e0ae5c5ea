// Newton's method (cone_newton.h), helped by ADMM (cone_iteration.h) and interior points (cone_interior.h). With J = D
// J' M^-1/2, D the scale of each contact, (J J^T + s)^-1 b = (b - J (J^T J + s)^-1 J^T b) / s: what is factorised has
// six rows a body, whatever the number of its contacts, and couples only bodies that touch.

#include "impact/sparse_cones.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "impact/cone_interior.h"
#include "impact/cone_newton.h"
#include "impact/contact_cones.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kLargest = 4;          // bound that a few contacts a body stay below, of scaled inverse masses
constexpr double kProximal = 1e-7;      // eta, scaled
constexpr double kFirstPenalty = 1e-4;  // rho, scaled
constexpr double kLeastPenalty = 1e-6;  // of the same: below, the difference b - ... is rounding
constexpr int kMostTrials = 4;          // to come near enough for Newton's method
constexpr int kInteriorTrial = 1;       // of them: by the interior point method, the others by ADMM
constexpr int kIterations = 10;         // of ADMM before Newton's method is tried again
constexpr double kInteriorPart = 1e-9;  // of the velocities: where the interior point method ends
constexpr double kRegular = 1e-9;       // scaled inverse mass: makes redundant contacts solvable
constexpr int kMostNewtonSteps = 6;     // 1 or 2 from the step before, where nothing changes

}  // namespace

SparseCones::Row SparseCones::rowOf(const Contact& contact, const std::array<int, 2>& bodies,
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

void SparseCones::set(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies,
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

VectorX SparseCones::velocitiesIn(const VectorX& velocities) const {
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

void SparseCones::apply(const VectorX& impulses, VectorX& state) const {
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

MatrixX SparseCones::inverseMass() const {
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
template <class Stiffness>
void SparseCones::assemble(double shift, const Stiffness& stiffness) {
  factor_.clear();
  for (std::size_t body = 0; body < bodies_.size(); ++body) factor_.diagonal(body).diagonal().setConstant(shift);
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Row& row = contacts_[c];
    const Mat3 k = stiffness(c);
    const std::array<Mat36, 2> kj = {k * row.j[0], k * row.j[1]};
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

void SparseCones::factorize(double shift) {
  if (shift == shift_) return;
  shift_ = shift;
  assemble(shift, [](std::size_t) { return Mat3(Mat3::Identity()); });
}

/// J^T impulses.
void SparseCones::gather(const VectorX& impulses) {
  bodyWork_.setZero(6 * static_cast<Index>(bodies_.size()));
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side)
      if (const int body = contacts_[i].body[side]; body >= 0)
        bodyWork_.segment<6>(6 * body).noalias() +=
            contacts_[i].j[side].transpose() * impulses.segment<3>(3 * static_cast<Index>(i));
}

void SparseCones::solveShifted(VectorX& b) {
  gather(b);
  factor_.solve(bodyWork_);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side)
      if (const int body = contacts_[i].body[side]; body >= 0)
        b.segment<3>(3 * static_cast<Index>(i)).noalias() -= contacts_[i].j[side] * bodyWork_.segment<6>(6 * body);
  b /= shift_;
}

void SparseCones::multiply(const VectorX& impulses, VectorX& velocities) {
  gather(impulses);
  velocities = cones_.free;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side)
      if (const int body = contacts_[i].body[side]; body >= 0)
        velocities.segment<3>(3 * static_cast<Index>(i)).noalias() +=
            contacts_[i].j[side] * bodyWork_.segment<6>(6 * body);
}

/// Newton's method as in cone_problem.cpp, A dz + B du = -F by contact, du = J dv: (1 + sum J^T A^-1 B J) dv = -sum J^T
/// A^-1 F by body.
void SparseCones::stepByNewton(VectorX& z, VectorX& u) {
  std::vector<Mat3> stiffness(contacts_.size(), Mat3::Zero());
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
    stiffness[i] = inverse * row.ofVelocity;
    change.segment<3>(at) = -inverse * row.value;
  }
  shift_ = 0;
  assemble(1, [&](std::size_t i) { return stiffness[i]; });
  gather(change);
  factor_.solve(bodyWork_);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side)
      if (const int body = contacts_[i].body[side]; body >= 0)
        change.segment<3>(3 * static_cast<Index>(i)) -=
            stiffness[i] * (contacts_[i].j[side] * bodyWork_.segment<6>(6 * body));
  z += change;
  multiply(z, u);
}

/// Changes the impulses only if it converges.
bool SparseCones::finish(VectorX& impulses, VectorX& velocities, double tolerance) {
  VectorX z = impulses, u = velocities;
  for (int step = 0; step < kMostNewtonSteps; ++step) {
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

long SparseCones::approachFromInside(VectorX& impulses) {
  shift_ = 0;
  ConeOperator op;
  op.multiply = [this](const VectorX& z, VectorX& u) { multiply(z, u); };
  op.respond = [this](const std::vector<Mat3>& stiffnesses, bool isNew, const VectorX& c, VectorX& du) {
    if (isNew) assemble(1, [&](std::size_t i) { return stiffnesses[i]; });
    gather(c);
    factor_.solve(bodyWork_);
    du.resize(c.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      Vec3 sum = Vec3::Zero();
      for (std::size_t side = 0; side < 2; ++side)
        if (const int body = contacts_[i].body[side]; body >= 0)
          sum += contacts_[i].j[side] * bodyWork_.segment<6>(6 * body);
      du.segment<3>(3 * static_cast<Index>(i)) = sum;
    }
  };
  return solveByInteriorPoint(cones_, op, kInteriorPart * cones_.free.cwiseAbs().maxCoeff(), impulses);
}

/// The iterate's velocities from those that its impulses give.
void SparseCones::takeVelocities(const VectorX& u, ConeIterate& at) const {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    at.velocities.segment<3>(k) = correctedVelocity(u.segment<3>(k), cones_.frictions[i]);
  }
  at.unbounded = at.impulses;
}

ConeSolution SparseCones::solve(const VectorX& free, const std::vector<double>& frictions, double tolerance,
                                ConeStart& start, long& iterations) {
  cones_.free = free, cones_.frictions = frictions;
  ConeIterate at;
  at.impulses = start.impulses, at.velocities = start.velocities;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    cones_.free.segment<3>(k) *= contacts_[i].scale;
    at.impulses.segment<3>(k) /= contacts_[i].scale, at.velocities.segment<3>(k) *= contacts_[i].scale;
  }
  at.unbounded = at.impulses;
  at.penalty = start.penalty > 0 ? start.penalty : kFirstPenalty;
  ConeSolution solution;
  VectorX u;
  const auto shifted = [this](VectorX& b) { solveShifted(b); };
  multiply(at.impulses, u);
  const auto isFound = [&] { return residual(at.impulses, u) <= tolerance || finish(at.impulses, u, tolerance); };
  solution.converged = isFound();
  for (int trial = 0; trial < kMostTrials && !solution.converged; ++trial) {
    if (trial == kInteriorTrial) {
      iterations += approachFromInside(at.impulses);
      multiply(at.impulses, u);
      takeVelocities(u, at);
    } else {
      factorize(at.penalty + kProximal);
      iterateCones(cones_, kProximal, shifted, kIterations, at);
      at.penalty = std::max(balancedPenalty(at, kLargest), kLeastPenalty);
      iterations += kIterations;
      multiply(at.impulses, u);
    }
    solution.converged = isFound();
  }
  solution.residual = residual(at.impulses, u);
  if (solution.converged) takeVelocities(u, at);
  solution.impulses = at.impulses, solution.velocities = u;
  start.impulses = at.impulses, start.velocities = at.velocities, start.penalty = at.penalty;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index k = 3 * static_cast<Index>(i);
    solution.impulses.segment<3>(k) *= contacts_[i].scale, solution.velocities.segment<3>(k) /= contacts_[i].scale;
    start.impulses.segment<3>(k) *= contacts_[i].scale, start.velocities.segment<3>(k) /= contacts_[i].scale;
  }
  return solution;
}

}  // namespace cradle
