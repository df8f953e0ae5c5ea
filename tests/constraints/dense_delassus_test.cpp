#include "constraints/dense_delassus.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "constraints/bodies_on_ground.h"
#include "constraints/constraint_row.h"

namespace cradle {
namespace {

struct TestRow {
  Vec3 linear, angularA, angularB;
  double velocityProduct;
};
ConstraintBlock testBlock(int bodyA, int bodyB, const std::vector<TestRow>& rows) {
  ConstraintBlock block;
  block.bodyA = bodyA, block.bodyB = bodyB;
  block.turnsA = bodyA != kFixed, block.turnsB = bodyB != kFixed;
  for (const TestRow& row : rows) {
    block.linear.row(block.rows) = row.linear;
    block.angularA.row(block.rows) = row.angularA, block.angularB.row(block.rows) = row.angularB;
    block.velocityProduct[static_cast<std::size_t>(block.rows++)] = row.velocityProduct;
  }
  return block;
}

/// Three lopsided bodies that move, two of them on rods, and blocks of rows between them and the world.
struct DelassusProblem {
  Mechanism mechanism = manyOnEarth(3);
  VectorX state = restingState(3);
  std::vector<BodyFrame> frames;
  std::vector<ConstraintBlock> blocks;

  DelassusProblem() {
    for (int body = 0; body < 3; ++body) {
      mechanism.bodies[static_cast<std::size_t>(body)] = lopsided(1 + body);
      centerOfMass(state, body) = Vec3(body, 0.3 * body * body, -0.2 * body);
      setOrientation(state, body, rotationAbout(Vec3(1, body, 0.5), 0.4 + body));
      linearVelocity(state, body) = Vec3(0.3, 1 - body, 0.2 * body);
      angularVelocity(state, body) = Vec3(body, -0.5, 0.7);
    }
    const auto rod = [&](const Attachment& a, const Attachment& b) {
      mechanism.constraints.push_back(
          {a, b, RodConstraint{(motionOf(a, state).position - motionOf(b, state).position).norm()}});
    };
    rod({0, Vec3(0.1, 0.2, -0.1)}, {1, Vec3(-0.2, 0.1, 0.3)});
    rod({1, Vec3(0, 0.2, 0.1)}, {kFixed, Vec3(1, 2, 0)});
    findBodyFrames(mechanism.bodies, state, frames);
    const Vec3 none = Vec3::Zero();
    blocks = {testBlock(0, 1,
                        {{Vec3(1, 0, 0.5), Vec3(0.2, -0.1, 0.4), Vec3(0.3, 0.1, 0), 0.7},
                         {Vec3(0, 1, -0.3), Vec3(0.5, 0.2, -0.1), Vec3(-0.2, 0, 0.6), -0.4},
                         {Vec3(0.2, 0.4, 1), Vec3(-0.3, 0.6, 0.1), Vec3(0.1, -0.7, 0.2), 1.1}}),
              testBlock(2, kFixed, {{Vec3(0, 1, 0), Vec3(0.1, 0, -0.3), none, -1.3}}),
              testBlock(1, 2, {{Vec3(0, 0.6, 0.8), Vec3(-0.2, 0.4, 0.1), Vec3(0, 0.5, 0.2), 2.1}})};
  }

  /// J of blocks as a matrix, row by row, by the velocities of all bodies.
  MatrixX jacobian(const std::vector<ConstraintBlock>& of) const {
    std::vector<ConstraintRow> rows;
    for (const ConstraintBlock& block : of)
      for (int i = 0; i < block.rows; ++i) rows.push_back(rowOf(block, i));
    MatrixX matrix(rows.size(), 18);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (Eigen::Index k = 0; k < 18; ++k) {
        VectorX unit = VectorX::Zero(state.size());
        unit[poseComponents(state) + k] = 1;
        matrix(static_cast<Eigen::Index>(i), k) = rateOf(rows[i], unit);
      }
    return matrix;
  }
  std::vector<ConstraintBlock> rods() const {
    std::vector<ConstraintBlock> found(mechanism.constraints.size());
    for (std::size_t i = 0; i < found.size(); ++i) findRows(mechanism.constraints[i], state, frames, found[i]);
    return found;
  }
  MatrixX inverseMasses() const {
    MatrixX matrix = MatrixX::Zero(18, 18);
    for (Eigen::Index body = 0; body < 3; ++body) {
      const auto index = static_cast<std::size_t>(body);
      const Eigen::Index at = velocityOffset(state, body) - poseComponents(state);
      matrix.block<3, 3>(at, at) = Mat3::Identity() / (1.0 + static_cast<double>(body));
      const Mat3 turn = orientation(state, body).toRotationMatrix();
      matrix.block<3, 3>(at + 3, at + 3) = turn * mechanism.bodies[index].inertiaTensor.inverse() * turn.transpose();
    }
    return matrix;
  }
  /// M^-1 - M^-1 B^T (B M^-1 B^T)^-1 B M^-1, of the rods' rows B.
  MatrixX constrainedInverseMasses() const {
    const MatrixX b = jacobian(rods()), inverse = inverseMasses();
    return inverse - inverse * b.transpose() * (b * inverse * b.transpose()).inverse() * b * inverse;
  }
};

constexpr double kDelassusError = 1e-12;  // 1/kg: entries up to 50, and a solution of two rows by another factorisation

TEST(DenseDelassus, IsTheProductOfItsMatrices) {
  DelassusProblem problem;
  ConstraintSolver solver(problem.mechanism.constraints, problem.mechanism.bodies);
  solver.factorize(problem.state, problem.frames);
  const MatrixX j = problem.jacobian(problem.blocks);
  const DenseDelassus alone(problem.blocks, problem.mechanism.bodies, problem.frames, nullptr);
  EXPECT_LT((alone.matrix() - j * problem.inverseMasses() * j.transpose()).norm(), kDelassusError);
  const DenseDelassus held(problem.blocks, problem.mechanism.bodies, problem.frames, &solver);
  EXPECT_LT((held.matrix() - j * problem.constrainedInverseMasses() * j.transpose()).norm(), kDelassusError);
  EXPECT_EQ(held.matrix(), held.matrix().transpose().eval());
  EXPECT_GT((held.matrix() - alone.matrix()).norm(), 0.1);
  for (Eigen::Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(held.unconstrainedDiagonal(i), alone.matrix()(i, i), kDelassusError);
    EXPECT_FALSE(held.isImmobile(i));
  }
}

// What impulses change of the rows' velocities is W times them; the rods keep their lengths meanwhile.
TEST(DenseDelassus, ImpulsesChangeVelocitiesByIt) {
  DelassusProblem problem;
  ConstraintSolver solver(problem.mechanism.constraints, problem.mechanism.bodies);
  solver.factorize(problem.state, problem.frames);
  const DenseDelassus delassus(problem.blocks, problem.mechanism.bodies, problem.frames, &solver);
  const Eigen::Vector<double, 5> impulses(1, -2, 0.5, 0.8, -0.3);
  const VectorX before = delassus.velocities(problem.state);
  EXPECT_LT(
      (before - problem.jacobian(problem.blocks) * problem.state.segment(poseComponents(problem.state), 18)).norm(),
      1e-14);
  const VectorX poses = problem.state.head(poseComponents(problem.state));
  const ConstraintBlock rod = problem.rods()[0];
  const double rodRate = rateOf(rod, 0, problem.state);
  delassus.apply(impulses, problem.state);
  EXPECT_LT((delassus.velocities(problem.state) - before - delassus.matrix() * impulses).norm(), kDelassusError);
  EXPECT_NEAR(rateOf(rod, 0, problem.state), rodRate, kDelassusError);
  EXPECT_EQ(problem.state.head(poses.size()), poses);
  // As forces: J a + (dJ/dt) v.
  VectorX rate = VectorX::Zero(problem.state.size());
  delassus.apply(impulses, rate);
  EXPECT_LT((delassus.accelerations(rate) - delassus.matrix() * impulses -
             Eigen::Vector<double, 5>(0.7, -0.4, 1.1, -1.3, 2.1))
                .norm(),
            kDelassusError);
}

// A row along a rod has no velocity but the one it has; at 1e-5 rad from it, it has: W grows with the square, 1e-10.
TEST(DenseDelassus, ARowAlongARodIsImmobile) {
  DelassusProblem problem;
  ConstraintSolver solver(problem.mechanism.constraints, problem.mechanism.bodies);
  solver.factorize(problem.state, problem.frames);
  const std::vector<ConstraintBlock> rods = problem.rods();
  ConstraintBlock aside = rods[1];
  const Vec3 along = aside.linear.row(0);
  aside.linear.row(0) += 1e-5 * along.norm() * along.unitOrthogonal();
  const DenseDelassus delassus({rods[0], aside, problem.blocks[0]}, problem.mechanism.bodies, problem.frames, &solver);
  EXPECT_TRUE(delassus.isImmobile(0));
  EXPECT_FALSE(delassus.isImmobile(1));
  EXPECT_FALSE(delassus.isImmobile(2));
  EXPECT_TRUE(isImmobile(1e-13, 1));
  EXPECT_FALSE(isImmobile(1e-11, 1));
  EXPECT_TRUE(isImmobile(0, 0));
}

}  // namespace
}  // namespace cradle
