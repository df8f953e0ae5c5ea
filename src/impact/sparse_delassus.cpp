// The Delassus operator by its factors. Let J0 be the Jacobian of the contacts, M the mass matrix, D the diagonal
// matrix of the contacts' scales, and J = D J0 M^-1/2. The scaled operator is W = J J^T. Equations A dz + B du = side
// with du = W dz, where A and B have a 3 x 3 block for each contact, are solved by way of v = J^T dz, the change of the
// bodies' velocities times the square roots of their masses:
//   (1 + J^T A^-1 B J) v = J^T A^-1 side   (1)
//   dz = A^-1 (side - B J v)               (2)
// The matrix of (1), which is factorised, has six rows for each body, however many contacts that has, and couples only
// bodies that touch.

#include "impact/sparse_delassus.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "impact/contact_delassus.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

// Scaled inverse mass: the eigenvalues of W are seldom larger where a body has a few contacts, since each of them has
// scaled inverse mass 1. It bounds the penalty of ADMM alone.
constexpr double kUsualEigenvalue = 4;
// Scaled inverse mass: with a shift A, dz in (2) is a difference divided by A, which multiplies rounding by 1 / A.
constexpr double kMinSparseShift = 1e-6;

}  // namespace

SparseDelassus::Row SparseDelassus::rowOf(const Contact& contact, const std::array<int, 2>& bodies,
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

void SparseDelassus::set(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies,
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
  if (pairs_ == analyzed_ && bodies_.size() == analyzedBodies_) return;
  analyzed_ = pairs_, analyzedBodies_ = bodies_.size();
  factor_.analyze(static_cast<int>(bodies_.size()), pairs_);
}

VectorX SparseDelassus::velocitiesIn(const VectorX& velocities) const {
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

void SparseDelassus::apply(const VectorX& impulses, VectorX& state) const {
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

MatrixX SparseDelassus::matrix() const {
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

/// Assembles and factorises the matrix of (1): 1 + sum over the contacts of J^T (A^-1 B) J.
void SparseDelassus::factorize(const std::vector<ContactEquation>& equations) {
  inverses_.assign(equations.size(), Mat3::Zero());
  stiffnesses_.assign(equations.size(), Mat3::Zero());
  factor_.clear();
  for (std::size_t body = 0; body < bodies_.size(); ++body) factor_.diagonal(body).setIdentity();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (equations[c].isOpen) continue;
    inverses_[c] = equations[c].ofImpulse.inverse();
    stiffnesses_[c] = inverses_[c] * equations[c].ofVelocity;
    const Row& row = contacts_[c];
    const std::array<Mat36, 2> kj = {stiffnesses_[c] * row.j[0], stiffnesses_[c] * row.j[1]};
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

VectorX SparseDelassus::solve(const VectorX& sides, VectorX* velocities) {
  VectorX change(sides.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    change.segment<3>(at) = inverses_[i] * sides.segment<3>(at);
  }
  gather(change);
  factor_.solve(bodyWork_);
  if (velocities) velocities->resize(sides.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const Vec3 velocity = velocityOfBodies(i);
    change.segment<3>(at) -= stiffnesses_[i] * velocity;
    if (velocities) velocities->segment<3>(at) = velocity;
  }
  return change;
}

/// J^T impulses.
void SparseDelassus::gather(const VectorX& impulses) {
  bodyWork_.setZero(6 * static_cast<Index>(bodies_.size()));
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side)
      if (const int body = contacts_[i].body[side]; body >= 0)
        bodyWork_.segment<6>(6 * body).noalias() +=
            contacts_[i].j[side].transpose() * impulses.segment<3>(3 * static_cast<Index>(i));
}

/// The rows of J of one contact times the bodies' part of the solution, v of (1).
Vec3 SparseDelassus::velocityOfBodies(std::size_t contact) const {
  const Row& row = contacts_[contact];
  Vec3 velocity = Vec3::Zero();
  for (std::size_t side = 0; side < 2; ++side)
    if (const int body = row.body[side]; body >= 0) velocity.noalias() += row.j[side] * bodyWork_.segment<6>(6 * body);
  return velocity;
}

VectorX SparseDelassus::multiply(const VectorX& z) {
  gather(z);
  VectorX u(z.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) u.segment<3>(3 * static_cast<Index>(i)) = velocityOfBodies(i);
  return u;
}

/// An upper bound on the largest component of |W| |z|: that of |J| |J^T| |z|.
double SparseDelassus::magnitude(const VectorX& z) {
  bodyWork_.setZero(6 * static_cast<Index>(bodies_.size()));
  double largest = 0;
  const auto forEachSide = [this](const auto& visit) {
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      for (std::size_t side = 0; side < 2; ++side)
        if (const int body = contacts_[i].body[side]; body >= 0)
          visit(3 * static_cast<Index>(i), contacts_[i].j[side].cwiseAbs(), bodyWork_.segment<6>(6 * body));
  };
  forEachSide([&z](Index at, const auto& j, auto work) { work += j.transpose() * z.segment<3>(at).cwiseAbs(); });
  forEachSide([&largest](Index, const auto& j, auto work) { largest = std::max(largest, (j * work).maxCoeff()); });
  return largest;
}

DelassusOperator SparseDelassus::scaledOperator() {
  DelassusOperator op;
  op.scales.resize(std::ssize(contacts_));
  for (std::size_t i = 0; i < contacts_.size(); ++i) op.scales[static_cast<Index>(i)] = contacts_[i].scale;
  op.largest = kUsualEigenvalue;
  op.leastShift = kMinSparseShift;
  op.multiply = [this](const VectorX& z) { return multiply(z); };
  op.magnitude = [this](const VectorX& z) { return magnitude(z); };
  op.factorize = [this](const std::vector<ContactEquation>& equations) {
    factorize(equations);
    return true;
  };
  op.factorizeShifted = [this](double shift) {
    factorize(std::vector<ContactEquation>(contacts_.size(), {shift * Mat3::Identity(), Mat3::Identity()}));
  };
  op.solve = [this](const VectorX& sides, VectorX* velocities) { return solve(sides, velocities); };
  return op;
}

}  // namespace cradle
