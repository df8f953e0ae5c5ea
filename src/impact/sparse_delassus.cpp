// The Delassus operator by its factors. Let J0 be the Jacobian of the contacts, M the mass matrix, D the diagonal
// matrix of the contacts' scales, and J = D J0 M^-1/2. The scaled operator is W = J J^T. Equations A dz + B du = side
// with du = W dz, where A and B have a 3 x 3 block for each contact, are solved by way of v = J^T dz, the change of the
// bodies' velocities times the square roots of their masses:
//   (1 + J^T A^-1 B J) v = J^T A^-1 side   (1)
//   dz = A^-1 (side - B J v)               (2)
// The matrix of (1), which is factorised, has six rows for each body, however many contacts that has, and couples only
// bodies that touch. Constraints with the Jacobian B0, B = B0 M^-1/2, leave the bodies velocities with B v = 0 alone: W
// = J P J^T, P the projector onto these, and v = P J^T dz solves, with their multipliers m,
//   (1 + J^T A^-1 B J) v + B^T m = J^T A^-1 side,   B v = 0   (3)
// Rows of B that depend on each other would leave (3) singular: -kTieCompliance m is added to B v.

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
// Of rows of length 1. More than rounding, so that multipliers of redundant rows stay finite, and far less than the
// compliance of contacts (kNewtonShift, 1e-9), so that it is they that give way where a joint leaves them no motion.
constexpr double kTieCompliance = 1e-12;

}  // namespace

/// The contact's velocity (t1, t2, n), of one body's linear and angular velocities.
SparseDelassus::Mat36 SparseDelassus::rowsAt(const Contact& contact, int body, const VectorX& state) {
  const Mat3 axes = contactAxes(contact.normal).transpose();
  Mat36 rows;
  rows << axes, -axes * skew(contact.point - centerOfMass(state, body));
  return rows;
}

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
  constraints_ = nullptr;
  setContacts(contacts, bodies, state);
  analyze();
}

void SparseDelassus::set(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies,
                         ConstraintSolver& constraints, const VectorX& state) {
  constraints_ = &constraints, stateSize_ = state.size();
  setContacts(contacts, bodies, state);
  setTies(bodies, state);
  analyze();
}

/// Index in bodies_ of a body, which is put there if it is not; -1 if no force moves it.
int SparseDelassus::localOf(int body, const std::vector<RigidBody>& bodies, const VectorX& state) {
  if (body == kFixed || bodies[static_cast<std::size_t>(body)].isDriven()) return -1;
  const auto [place, isNew] = known_.try_emplace(body, static_cast<int>(bodies_.size()));
  if (isNew) {
    const RigidBody& inertia = bodies[static_cast<std::size_t>(body)];
    const Mat3 inverse = worldInverseInertia(inertia, orientation(state, body));
    bodies_.push_back({body, std::sqrt(inertia.inverseMass), Mat3(inverse.llt().matrixL())});
  }
  return place->second;
}

void SparseDelassus::setContacts(const std::vector<Contact>& contacts, const std::vector<RigidBody>& bodies,
                                 const VectorX& state) {
  contacts_.clear(), bodies_.clear(), known_.clear(), ties_.clear(), pairs_.clear(), pairOf_.clear();
  drivenSides_.clear();
  std::map<std::pair<int, int>, std::size_t> pairs;
  for (const Contact& contact : contacts) {
    const int a = localOf(contact.bodyA, bodies, state), b = localOf(contact.bodyB, bodies, state);
    contacts_.push_back(rowOf(contact, {a, b}, state));
    for (const auto& [body, sign] : {std::pair(contact.bodyA, -1.0), {contact.bodyB, 1.0}})
      if (body != kFixed && bodies[static_cast<std::size_t>(body)].isDriven())
        drivenSides_.push_back({contacts_.size() - 1, body, sign * rowsAt(contact, body, state)});
    std::size_t at = SIZE_MAX;
    if (const std::pair<int, int> pair(std::max(a, b), std::min(a, b)); pair.second >= 0) {
      const auto [place, isNew] = pairs.try_emplace(pair, pairs_.size());
      if (isNew) pairs_.push_back(pair);
      at = place->second;
    }
    pairOf_.push_back(at);
  }
}

/// Takes the constraints of the contacts' bodies, those of the bodies that these lead to, and so on.
void SparseDelassus::setTies(const std::vector<RigidBody>& bodies, const VectorX& state) {
  const std::vector<ConstraintBlock>& blocks = constraints_->blocks();
  std::vector<std::vector<int>> blocksOf(bodies.size());
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (const int body : {blocks[i].bodyA, blocks[i].bodyB})
      if (body != kFixed) blocksOf[static_cast<std::size_t>(body)].push_back(static_cast<int>(i));
  std::vector<char> isTaken(blocks.size(), 0);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {  // bodies_ grows
    for (const int block : blocksOf[static_cast<std::size_t>(bodies_[i].index)]) {
      if (std::exchange(isTaken[static_cast<std::size_t>(block)], 1)) continue;
      const ConstraintBlock& from = blocks[static_cast<std::size_t>(block)];
      const int a = localOf(from.bodyA, bodies, state), b = localOf(from.bodyB, bodies, state);
      ties_.push_back(tieOf(from, {a, b}));
    }
  }
  firstTiePair_ = pairs_.size();
  for (std::size_t i = 0; i < ties_.size(); ++i)
    for (const int body : ties_[i].body)
      if (body >= 0) pairs_.emplace_back(static_cast<int>(bodies_.size() + i), body);
}

SparseDelassus::Tie SparseDelassus::tieOf(const ConstraintBlock& block, const std::array<int, 2>& bodies) const {
  Tie tie{bodies, {Mat6::Zero(), Mat6::Zero()}, block.rows};
  for (std::size_t side = 0; side < 2; ++side) {
    if (bodies[side] < 0) continue;
    const BodyRoot& body = bodies_[static_cast<std::size_t>(bodies[side])];
    const double sign = side == 0 ? 1 : -1;
    const bool turns = side == 0 ? block.turnsA : block.turnsB;
    tie.b[side].leftCols<3>() = sign * body.inverseMass * block.linear;
    if (turns) tie.b[side].rightCols<3>() = (side == 0 ? block.angularA : block.angularB) * body.inverseInertia;
    tie.b[side].bottomRows(ConstraintBlock::kMaxRows - block.rows).setZero();
  }
  for (int row = 0; row < block.rows; ++row) {
    const double length = std::sqrt(tie.b[0].row(row).squaredNorm() + tie.b[1].row(row).squaredNorm());
    for (Mat6& b : tie.b) b.row(row) /= length;
  }
  return tie;
}

void SparseDelassus::analyze() {
  if (pairs_ == analyzed_ && bodies_.size() == analyzedBodies_ && ties_.size() == analyzedTies_) return;
  analyzed_ = pairs_, analyzedBodies_ = bodies_.size(), analyzedTies_ = ties_.size();
  factor_.analyze(static_cast<int>(bodies_.size()), static_cast<int>(ties_.size()), pairs_);
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
  for (const DrivenSide& side : drivenSides_)
    all.segment<3>(3 * static_cast<Index>(side.contact)) +=
        side.j * velocities.segment<kVelocitySize>(velocityOffset(velocities, side.body));
  return all;
}

void SparseDelassus::apply(const VectorX& impulses, VectorX& state) const {
  if (ties_.empty()) return applyAlone(impulses, state);
  VectorX response = VectorX::Zero(state.size());
  applyAlone(impulses, response);
  constraints_->constrainVelocities(response);
  const Index velocities = bodyCount(state) * kVelocitySize;
  state.segment(poseComponents(state), velocities) += response.segment(poseComponents(state), velocities);
}

/// As if the bodies had no constraints.
void SparseDelassus::applyAlone(const VectorX& impulses, VectorX& state) const {
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

double SparseDelassus::mobility(std::size_t contact) const {
  if (ties_.empty()) return 1;
  const Index normal = 3 * static_cast<Index>(contact) + 2;
  VectorX impulses = VectorX::Zero(3 * std::ssize(contacts_)), response = VectorX::Zero(stateSize_);
  impulses[normal] = 1;
  applyAlone(impulses, response);
  const double alone = velocitiesIn(response)[normal];
  constraints_->constrainVelocities(response);
  return velocitiesIn(response)[normal] / alone;
}

/// Assembles and factorises the matrix of (1) or (3): 1 + sum over the contacts of J^T (A^-1 B) J.
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
  placeTies();
  factor_.factorize();
}

void SparseDelassus::placeTies() {
  std::size_t pair = firstTiePair_;
  for (std::size_t i = 0; i < ties_.size(); ++i) {
    const Tie& tie = ties_[i];
    auto diagonal = factor_.diagonal(bodies_.size() + i).diagonal();
    diagonal.setOnes();
    diagonal.head(tie.rows).setConstant(-kTieCompliance);
    for (std::size_t side = 0; side < 2; ++side) {
      if (tie.body[side] < 0) continue;
      factor_.firstRow(pair) = tie.b[side];
      factor_.secondRow(pair++) = tie.b[side].transpose();
    }
  }
}

VectorX SparseDelassus::solve(const VectorX& sides, VectorX* velocities) {
  VectorX change(sides.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    change.segment<3>(at) = inverses_[i] * sides.segment<3>(at);
  }
  gather(change);
  factor_.solve(bodyWork_);
  if (!ties_.empty()) removeCompliance();
  if (velocities) velocities->resize(sides.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const Vec3 velocity = velocityOfBodies(i);
    change.segment<3>(at) -= stiffnesses_[i] * velocity;
    if (velocities) velocities->segment<3>(at) = velocity;
  }
  return change;
}

/// Takes out of the solution what constraints have given way, B v, but for the square of kTieCompliance: contacts
/// divide by their own.
void SparseDelassus::removeCompliance() {
  correction_.setZero(bodyWork_.size());
  for (std::size_t i = 0; i < ties_.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side)
      if (const int body = ties_[i].body[side]; body >= 0)
        correction_.segment<6>(6 * static_cast<Index>(bodies_.size() + i)).noalias() -=
            ties_[i].b[side] * bodyWork_.segment<6>(6 * body);
  factor_.solve(correction_);
  bodyWork_ += correction_;
}

/// J^T impulses.
void SparseDelassus::gather(const VectorX& impulses) {
  bodyWork_.setZero(6 * static_cast<Index>(bodies_.size() + ties_.size()));
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
  if (!ties_.empty()) return multiplyTied(z);
  gather(z);
  VectorX u(z.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) u.segment<3>(3 * static_cast<Index>(i)) = velocityOfBodies(i);
  return u;
}

VectorX SparseDelassus::multiplyTied(const VectorX& z) const {
  VectorX scaled = z, response = VectorX::Zero(stateSize_);
  for (std::size_t i = 0; i < contacts_.size(); ++i) scaled.segment<3>(3 * static_cast<Index>(i)) *= contacts_[i].scale;
  applyAlone(scaled, response);
  constraints_->constrainVelocities(response);
  VectorX u = velocitiesIn(response);
  for (std::size_t i = 0; i < contacts_.size(); ++i) u.segment<3>(3 * static_cast<Index>(i)) *= contacts_[i].scale;
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
  op.minShift = kMinSparseShift;
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
