#include "constraints/joint_blocks.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "constraints/constraint_forces.h"
#include "math/rotation.h"

namespace cradle {
namespace {

// Joints as scalar rows, as findRows has them and all other solvers take them, are what blocks are held against.

/// Bodies without any symmetry, so that a wrong frame or sign shows; their states have nothing to do with each other.
struct JointedBodies {
  std::vector<RigidBody> bodies;
  Constraints constraints;
  VectorX state;
  std::vector<BodyFrame> frames;

  explicit JointedBodies(int count) : state(VectorX::Zero(stateSize(count))) {
    for (int i = 0; i < count; ++i) {
      const Mat3 turn = rotationAbout(Vec3(1, i, 2), 0.3 + i).toRotationMatrix();
      bodies.push_back(makeRigidBody(
          {1 + 0.3 * i, Vec3::Zero(), turn * Vec3(0.1 + 0.02 * i, 0.2, 0.25).asDiagonal() * turn.transpose()}));
      centerOfMass(state, i) = Vec3(0.7 * i, 0.2 - i, 0.1 * i * i);
      setOrientation(state, i, rotationAbout(Vec3(i, -1, 0.5), 0.8 - i));
      linearVelocity(state, i) = Vec3(0.4, -1.1 + i, 0.2 * i);
      angularVelocity(state, i) = Vec3(1.3 - i, -0.6, 2.2);
    }
    findBodyFrames(bodies, state, frames);
  }

  void tie(int bodyA, int bodyB) {
    const double i = static_cast<double>(constraints.size());
    constraints.push_back(
        {{bodyA, Vec3(0.3, -0.2 * i, 0.4)}, {bodyB, Vec3(-0.5, 0.1, 0.2 + 0.1 * i)}, BallJointConstraint()});
  }

  std::vector<ConstraintRow> rows() const {
    std::vector<ConstraintRow> found;
    findRows(constraints, state, frames, found);
    return found;
  }
};

/// M^-1 J^T of a row, in the layout of the velocities.
VectorX responseOf(const JointedBodies& jointed, const ConstraintRow& row) {
  VectorX response = VectorX::Zero(jointed.state.size());
  const auto add = [&](int body, const Vec3& linear, const Vec3& angular) {
    if (body == kFixed) return;
    const std::size_t at = static_cast<std::size_t>(body);
    linearVelocity(response, body) += jointed.bodies[at].inverseMass * linear;
    angularVelocity(response, body) += jointed.frames[at].inverseInertia * angular;
  };
  add(row.bodyA, row.linearA, row.angularA);
  add(row.bodyB, row.linearB, row.angularB);
  return response;
}

/// Holds all that blocks say against the rows. Entries are of the size of 1 to 10, condition numbers below 1e3.
void expectAsRows(const JointedBodies& jointed) {
  JointBlocks blocks;
  const double least = blocks.factorize(jointed.constraints, jointed.bodies, jointed.state, jointed.frames);
  EXPECT_GT(least, 1e-3);
  const std::vector<ConstraintRow> rows = jointed.rows();
  const Eigen::Index size = static_cast<Eigen::Index>(rows.size());
  MatrixX matrix(size, size);
  VectorX b(size), response = VectorX::Zero(jointed.state.size());
  for (Eigen::Index i = 0; i < size; ++i) b[i] = 1 + 0.5 * static_cast<double>(i * i % 7);
  VectorX x = b;
  blocks.solve(x);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Index at = static_cast<Eigen::Index>(i);
    const VectorX answer = responseOf(jointed, rows[i]);
    for (std::size_t j = 0; j < rows.size(); ++j) matrix(static_cast<Eigen::Index>(j), at) = rateOf(rows[j], answer);
    response += x[at] * answer;
    EXPECT_NEAR(blocks.value(i / 3)[at % 3], rows[i].value, 1e-14);
    EXPECT_NEAR(blocks.velocityProduct(i / 3)[at % 3], rows[i].velocityProduct, 1e-13);
    EXPECT_NEAR(blocks.rateOf(i / 3, jointed.state)[at % 3], rateOf(rows[i], jointed.state), 1e-14);
    EXPECT_DOUBLE_EQ(blocks.rounding(i / 3), rows[i].rounding);
  }
  EXPECT_LT((x - matrix.partialPivLu().solve(b)).cwiseAbs().maxCoeff(), 1e-12 * x.cwiseAbs().maxCoeff());
  blocks.addResponse(x, [&](int body, const Vec3& linear, const Vec3& angular) {
    linearVelocity(response, body) -= linear;
    angularVelocity(response, body) -= angular;
  });
  EXPECT_LT(response.cwiseAbs().maxCoeff(), 1e-13 * x.cwiseAbs().maxCoeff());
}

TEST(JointBlocks, AreTheRowsOfAChain) {
  JointedBodies chain(4);
  chain.tie(0, kFixed), chain.tie(1, 0), chain.tie(1, 2), chain.tie(3, 2), chain.tie(kFixed, 3);
  expectAsRows(chain);
}

TEST(JointBlocks, AreTheRowsOfATreeWithJointsAtCentersOfMass) {
  JointedBodies tree(5);
  tree.tie(0, kFixed), tree.tie(1, 0), tree.tie(2, 0), tree.tie(0, 3), tree.tie(4, 3);
  for (const std::size_t joint : {1U, 3U}) tree.constraints[joint].anchorB.point.setZero();
  expectAsRows(tree);
}

/// Eliminating a joint of a ring fills in what was empty.
TEST(JointBlocks, AreTheRowsOfARing) {
  JointedBodies ring(6);
  for (int i = 0; i < 6; ++i) ring.tie(i, (i + 1) % 6);
  ring.tie(2, kFixed);
  expectAsRows(ring);
}

TEST(JointBlocks, SayThatRowsDependOnEachOther) {
  JointedBodies twice(2);
  twice.tie(0, 1);
  twice.constraints.push_back(twice.constraints[0]);
  JointBlocks blocks;
  EXPECT_LT(blocks.factorize(twice.constraints, twice.bodies, twice.state, twice.frames), 1e-12);
}

TEST(JointBlocks, FollowAChangeOfWhatIsTied) {
  JointedBodies first(3), second(3);
  first.tie(0, 1), first.tie(1, 2);
  second.tie(kFixed, 1), second.tie(1, 2), second.tie(0, 2);
  JointBlocks blocks, fresh;
  VectorX after = VectorX::LinSpaced(9, 1, 2), expected = after;
  blocks.factorize(first.constraints, first.bodies, first.state, first.frames);
  blocks.factorize(second.constraints, second.bodies, second.state, second.frames);
  fresh.factorize(second.constraints, second.bodies, second.state, second.frames);
  blocks.solve(after), fresh.solve(expected);
  EXPECT_EQ(after, expected);
}

/// Where blocks are of no use, rows take over: a joint that is there twice does what one does.
TEST(ConstraintForces, TwoEqualJointsDoWhatOneDoes) {
  JointedBodies one(2), two(2);
  one.tie(0, 1);
  two.constraints = {one.constraints[0], one.constraints[0]};
  ConstraintSolver single(one.constraints, one.bodies), twin(two.constraints, two.bodies);
  single.factorize(one.state), twin.factorize(two.state);
  single.constrainVelocities(one.state), twin.constrainVelocities(two.state);
  EXPECT_LT((one.state - two.state).cwiseAbs().maxCoeff(), 1e-12);
}

/// A rope beside joints goes taut and slack again: rows, blocks, and the same rows.
TEST(ConstraintForces, HaveAMultiplierForEachRowWhateverWasTiedBefore) {
  JointedBodies jointed(2);
  jointed.tie(0, 1);
  const Constraint rod{{0, Vec3(0.1, 0.2, 0.3)}, {kFixed, Vec3(1, 2, 3)}, RodConstraint{2}};
  ConstraintSolver solver(jointed.constraints, jointed.bodies);
  VectorX rate = VectorX::Zero(jointed.state.size());
  for (const bool isTaut : {true, false, true}) {
    jointed.constraints.resize(1);
    if (isTaut) jointed.constraints.push_back(rod);
    solver.factorize(jointed.state);
    EXPECT_EQ(solver.constrainAccelerations(rate).size(), isTaut ? 4 : 3);
  }
}

}  // namespace
}  // namespace cradle
