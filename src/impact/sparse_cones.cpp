// The matrix by its factors. With J = D J' M^-1/2, D the scale of each contact, (J J^T + s)^-1 b = (b - J (J^T J +
// s)^-1 J^T b) / s: what is factorised has six rows a body, whatever the number of its contacts, and couples only
// bodies that touch.

#include "impact/sparse_cones.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "impact/contact_cones.h"
#include "math/rotation.h"

namespace cradle {

using Index = Eigen::Index;

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
void SparseCones::assemble(double shift, const std::vector<Mat3>& stiffnesses) {
  factor_.clear();
  for (std::size_t body = 0; body < bodies_.size(); ++body) factor_.diagonal(body).diagonal().setConstant(shift);
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Row& row = contacts_[c];
    const std::array<Mat36, 2> kj = {stiffnesses[c] * row.j[0], stiffnesses[c] * row.j[1]};
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
  stiffnesses_.assign(contacts_.size(), Mat3::Identity());
  assemble(shift, stiffnesses_);
  shift_ = shift;
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

/// J times what is left of the bodies, at one contact.
Vec3 SparseCones::velocityOfBodies(std::size_t contact) const {
  const Row& row = contacts_[contact];
  Vec3 velocity = Vec3::Zero();
  for (std::size_t side = 0; side < 2; ++side)
    if (const int body = row.body[side]; body >= 0) velocity.noalias() += row.j[side] * bodyWork_.segment<6>(6 * body);
  return velocity;
}

void SparseCones::solveShifted(VectorX& b) {
  gather(b);
  factor_.solve(bodyWork_);
  for (std::size_t i = 0; i < contacts_.size(); ++i) b.segment<3>(3 * static_cast<Index>(i)) -= velocityOfBodies(i);
  b /= shift_;
}

void SparseCones::multiply(const VectorX& impulses, VectorX& velocities) {
  gather(impulses);
  velocities = cones_.free;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    velocities.segment<3>(3 * static_cast<Index>(i)) += velocityOfBodies(i);
}

}  // namespace cradle
