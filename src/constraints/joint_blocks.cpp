// L D L^T as in sparse_ldlt.cpp, with blocks for entries: the scalar method in another order of its sums.

#include "constraints/joint_blocks.h"

#include <algorithm>
#include <map>

#include "constraints/sparse_ldlt.h"

namespace cradle {
namespace {

Mat3 crossMatrix(const Vec3& v) {
  Mat3 matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// crossMatrix(v) x matrix.
Mat3 crossed(const Vec3& v, const Mat3& matrix) {
  Mat3 result;
  for (int i = 0; i < 3; ++i) result.col(i) = v.cross(matrix.col(i));
  return result;
}

}  // namespace

double JointBlocks::factorize(const Constraints& joints, const std::vector<RigidBody>& bodies, const VectorX& state,
                              const std::vector<BodyFrame>& frames) {
  if (!hasKnownStructure(joints)) analyze(joints);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    place(joints[i].anchorA, bodies, state, frames, joints_[i].a);
    place(joints[i].anchorB, bodies, state, frames, joints_[i].b);
  }
  fill();
  return eliminate();
}

bool JointBlocks::hasKnownStructure(const Constraints& joints) const {
  return std::equal(joints.begin(), joints.end(), structure_.begin(), structure_.end(),
                    [](const Constraint& joint, const auto& bodies) {
                      return joint.anchorA.body == bodies.first && joint.anchorB.body == bodies.second;
                    });
}

void JointBlocks::analyze(const Constraints& joints) {
  structure_.clear();
  for (const Constraint& joint : joints) structure_.emplace_back(joint.anchorA.body, joint.anchorB.body);
  joints_.assign(joints.size(), {});
  pivots_.assign(joints.size(), {});
  findCouplings();
  findFill();
}

/// Which joints share a body.
void JointBlocks::findCouplings() {
  couplings_.clear();
  struct End {
    std::size_t joint;
    bool isA;
  };
  std::map<int, std::vector<End>> endsAt;
  for (std::size_t i = 0; i < structure_.size(); ++i)
    for (const bool isA : {true, false}) {
      const int body = isA ? structure_[i].first : structure_[i].second;
      if (body == kFixed) continue;
      std::vector<End>& ends = endsAt[body];
      for (const End& other : ends) couplings_.push_back({i, other.joint, isA, other.isA});
      ends.push_back({i, isA});
    }
}

/// In what order joints are eliminated, and what that fills.
void JointBlocks::findFill() {
  const std::size_t size = structure_.size();
  std::vector<std::pair<int, int>> places;
  for (const Coupling& coupling : couplings_)
    places.emplace_back(static_cast<int>(coupling.row), static_cast<int>(coupling.column));
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  const std::vector<int> order = eliminationOrder(static_cast<int>(size), places);
  std::vector<std::size_t> positions(size);
  for (std::size_t i = 0; i < size; ++i) positions[static_cast<std::size_t>(order[i])] = i;

  std::map<std::pair<std::size_t, std::size_t>, std::size_t> blockAt;  // by positions, the row's last
  std::size_t blocks = size;
  const auto blockOf = [&](std::size_t a, std::size_t b) {
    const auto [found, isNew] = blockAt.try_emplace(std::minmax(a, b), blocks);
    blocks += isNew;
    return found->second;
  };
  for (Coupling& coupling : couplings_) {
    if (positions[coupling.row] < positions[coupling.column]) {
      std::swap(coupling.row, coupling.column);
      std::swap(coupling.rowIsA, coupling.columnIsA);
    }
    coupling.block = blockOf(positions[coupling.row], positions[coupling.column]);
  }
  columns_.clear();
  for (std::size_t i = 0; i < size; ++i) {
    Column& column = columns_.emplace_back(Column{static_cast<std::size_t>(order[i]), {}, {}});
    for (auto entry = blockAt.lower_bound({i, 0}); entry != blockAt.end() && entry->first.first == i; ++entry)
      column.below.push_back({entry->second, static_cast<std::size_t>(order[entry->first.second])});
    for (const Below& right : column.below)
      for (const Below* left = &right; left != column.below.data() + column.below.size(); ++left) {
        const bool isDiagonal = left == &right;
        const std::size_t target = isDiagonal ? right.joint : blockOf(positions[left->joint], positions[right.joint]);
        column.updates.push_back({target, left->block, right.block});
      }
  }
  blocks_.resize(blocks);
  unscaled_.resize(blocks);
}

/// Where a joint is on one of its bodies, and how it moves.
void JointBlocks::place(const Attachment& anchor, const std::vector<RigidBody>& bodies, const VectorX& state,
                        const std::vector<BodyFrame>& frames, Side& side) {
  side.body = anchor.body;
  side.position = anchor.point;
  if (anchor.body == kFixed) return;
  const std::size_t body = static_cast<std::size_t>(anchor.body);
  side.inverseMass = bodies[body].inverseMass;
  side.position = centerOfMass(state, anchor.body);
  side.turns = anchor.point != Vec3::Zero();
  if (!side.turns) return;
  side.arm = frames[body].rotation * anchor.point;
  side.position += side.arm;
  const Mat3 &inverseInertia = frames[body].inverseInertia, cross = crossMatrix(side.arm);
  if (bodies[body].isSpherical)
    side.turn = inverseInertia(0, 0) * cross;
  else
    side.turn = inverseInertia * cross;
  const Vec3 spin = angularVelocity(state, anchor.body);
  side.centripetal = spin.cross(spin.cross(side.arm));
}

void JointBlocks::fill() {
  // The part of row and column that act on the same body: J M^-1 J^T with J = (1, -[arm x]).
  const auto couple = [](const Side& row, const Side& column, double sign, Mat3& block) {
    block.diagonal().array() += sign * column.inverseMass;
    if (row.turns && column.turns) block -= sign * crossed(row.arm, column.turn);
  };
  std::fill(blocks_.begin(), blocks_.end(), Mat3::Zero());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const JointSides& joint = joints_[i];
    if (joint.a.body != kFixed) couple(joint.a, joint.a, 1, blocks_[i]);
    if (joint.b.body != kFixed) couple(joint.b, joint.b, 1, blocks_[i]);
  }
  for (const Coupling& coupling : couplings_) {
    const JointSides &row = joints_[coupling.row], &column = joints_[coupling.column];
    couple(coupling.rowIsA ? row.a : row.b, coupling.columnIsA ? column.a : column.b,
           coupling.rowIsA == coupling.columnIsA ? 1 : -1, blocks_[coupling.block]);
  }
}

double JointBlocks::eliminate() {
  for (std::size_t i = 0; i < joints_.size(); ++i) pivots_[i].before = blocks_[i].diagonal();
  double least = 1;
  for (const Column& column : columns_) {
    least = std::min(least, findPivot(column.joint));
    const Pivot& pivot = pivots_[column.joint];
    for (const Below& below : column.below) {
      Mat3 &block = blocks_[below.block], &unscaled = unscaled_[below.block];
      unscaled.col(0) = block.col(0);
      unscaled.col(1) = block.col(1) - pivot.l10 * unscaled.col(0);
      unscaled.col(2) = block.col(2) - pivot.l20 * unscaled.col(0) - pivot.l21 * unscaled.col(1);
      for (int i = 0; i < 3; ++i) block.col(i) = pivot.inverse[i] * unscaled.col(i);
    }
    for (const Update& update : column.updates)
      blocks_[update.target] -= blocks_[update.left] * unscaled_[update.right].transpose();
  }
  return least;
}

/// L D L^T of a diagonal block, of which the lower triangle counts. Returns the smallest entry of D as a part of what
/// stood there before the elimination of others.
double JointBlocks::findPivot(std::size_t joint) {
  const Mat3& block = blocks_[joint];
  Pivot& pivot = pivots_[joint];
  const auto inverseOf = [](double x) { return x > 0 ? 1 / x : 0; };
  const double d0 = block(0, 0), i0 = inverseOf(d0);
  pivot.l10 = block(1, 0) * i0;
  pivot.l20 = block(2, 0) * i0;
  const double d1 = block(1, 1) - pivot.l10 * block(1, 0), i1 = inverseOf(d1);
  const double below = block(2, 1) - pivot.l20 * block(1, 0);
  pivot.l21 = below * i1;
  const double d2 = block(2, 2) - pivot.l20 * block(2, 0) - pivot.l21 * below;
  pivot.inverse = Vec3(i0, i1, inverseOf(d2));
  const auto partOf = [](double d, double before) { return before > 0 ? d / before : 0; };
  return std::min({partOf(d0, pivot.before[0]), partOf(d1, pivot.before[1]), partOf(d2, pivot.before[2])});
}

void JointBlocks::solve(VectorX& x) const {
  const auto of = [&x](std::size_t joint) { return x.segment<3>(static_cast<Eigen::Index>(3 * joint)); };
  for (const Column& column : columns_) {
    const Pivot& pivot = pivots_[column.joint];
    auto own = of(column.joint);
    own[1] -= pivot.l10 * own[0];
    own[2] -= pivot.l20 * own[0] + pivot.l21 * own[1];
    for (const Below& below : column.below) of(below.joint) -= blocks_[below.block] * own;
  }
  for (auto column = columns_.rbegin(); column != columns_.rend(); ++column) {
    const Pivot& pivot = pivots_[column->joint];
    Vec3 own = pivot.inverse.cwiseProduct(of(column->joint));
    for (const Below& below : column->below) own -= blocks_[below.block].transpose() * of(below.joint);
    own[1] -= pivot.l21 * own[2];
    own[0] -= pivot.l10 * own[1] + pivot.l20 * own[2];
    of(column->joint) = own;
  }
}

double JointBlocks::rounding(std::size_t joint) const {
  const auto& [a, b] = joints_[joint];
  return kRowRounding * (a.position.norm() + a.arm.norm() + b.arm.norm());
}

Vec3 JointBlocks::rateOf(std::size_t joint, const VectorX& state) const {
  const auto velocityOf = [&state](const Side& side) {
    if (side.body == kFixed) return Vec3(Vec3::Zero());
    Vec3 velocity = linearVelocity(state, side.body);
    if (side.turns) velocity += Vec3(angularVelocity(state, side.body)).cross(side.arm);
    return velocity;
  };
  return velocityOf(joints_[joint].a) - velocityOf(joints_[joint].b);
}

}  // namespace cradle
