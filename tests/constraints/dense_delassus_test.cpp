#include "constraints/dense_delassus.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "constraints/bodies_on_ground.h"

namespace cradle {
namespace {

/// Three lopsided bodies that move, two of them on rods, and rows between them and the world.
struct DelassusProblem {
  Mechanism mechanism = manyOnEarth(3);
  VectorX state = restingState(3);
  std::vector<BodyFrame> frames;
  std::vector<ConstraintRow> rows;

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
    rows = {{0, 1, Vec3(1, 0, 0.5), Vec3(0.2, -0.1, 0.4), Vec3(-1, 0, -0.5), Vec3(0.3, 0.1, 0), 0, 0.7},
            {2, kFixed, Vec3(0, 1, 0), Vec3(0.1, 0, -0.3), Vec3(0, -1, 0), Vec3::Zero(), 0, -1.3},
            {1, 2, Vec3(0, 0.6, 0.8), Vec3(-0.2, 0.4, 0.1), Vec3(0, -0.6, -0.8), Vec3(0, 0.5, 0.2), 0, 2.1}};
  }

  /// J of rows as a matrix, by the velocities of all bodies.
  MatrixX jacobian(const std::vector<ConstraintRow>& of) const {
    MatrixX matrix = MatrixX::Zero(std::ssize(of), 18);
    for (std::size_t i = 0; i < of.size(); ++i)
      for (Eigen::Index k = 0; k < 18; ++k) {
        VectorX unit = VectorX::Zero(state.size());
        unit[poseComponents(state) + k] = 1;
        matrix(static_cast<Eigen::Index>(i), k) = rateOf(of[i], unit);
      }
    return matrix;
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
    std::vector<ConstraintRow> rods;
    findRows(mechanism.constraints, state, frames, rods);
    const MatrixX b = jacobian(rods), inverse = inverseMasses();
    return inverse - inverse * b.transpose() * (b * inverse * b.transpose()).inverse() * b * inverse;
  }
};

constexpr double kDelassusError = 1e-12;  // 1/kg: entries up to 50, and a solution of two rows by another factorisation

TEST(DenseDelassus, IsTheProductOfItsMatrices) {
  DelassusProblem problem;
  ConstraintSolver solver(problem.mechanism.constraints, problem.mechanism.bodies);
  solver.factorize(problem.state, problem.frames);
  const MatrixX j = problem.jacobian(problem.rows);
  const DenseDelassus alone(problem.rows, problem.mechanism.bodies, problem.frames, nullptr);
  EXPECT_LT((alone.matrix() - j * problem.inverseMasses() * j.transpose()).norm(), kDelassusError);
  const DenseDelassus held(problem.rows, problem.mechanism.bodies, problem.frames, &solver);
  EXPECT_LT((held.matrix() - j * problem.constrainedInverseMasses() * j.transpose()).norm(), kDelassusError);
  EXPECT_EQ(held.matrix(), held.matrix().transpose().eval());
  EXPECT_GT((held.matrix() - alone.matrix()).norm(), 0.1);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(held.unconstrainedDiagonal(i), alone.matrix()(i, i), kDelassusError);
    EXPECT_FALSE(held.isImmobile(i));
  }
}

// What impulses change of the rows' velocities is W times them; the rods keep their lengths meanwhile.
TEST(DenseDelassus, ImpulsesChangeVelocitiesByIt) {
  DelassusProblem problem;
  ConstraintSolver solver(problem.mechanism.constraints, problem.mechanism.bodies);
  solver.factorize(problem.state, problem.frames);
  const DenseDelassus delassus(problem.rows, problem.mechanism.bodies, problem.frames, &solver);
  const Vec3 impulses(1, -2, 0.5);
  const VectorX before = delassus.velocities(problem.state);
  EXPECT_LT((before - problem.jacobian(problem.rows) * problem.state.segment(poseComponents(problem.state), 18)).norm(),
            1e-14);
  const VectorX poses = problem.state.head(poseComponents(problem.state));
  std::vector<ConstraintRow> rods;
  findRows(problem.mechanism.constraints, problem.state, problem.frames, rods);
  const double rodRate = rateOf(rods[0], problem.state);
  delassus.apply(impulses, problem.state);
  EXPECT_LT((delassus.velocities(problem.state) - before - delassus.matrix() * impulses).norm(), kDelassusError);
  EXPECT_NEAR(rateOf(rods[0], problem.state), rodRate, kDelassusError);
  EXPECT_EQ(problem.state.head(poses.size()), poses);
  // As forces: J a + (dJ/dt) v.
  VectorX rate = VectorX::Zero(problem.state.size());
  delassus.apply(impulses, rate);
  EXPECT_LT((delassus.accelerations(rate) - delassus.matrix() * impulses - Vec3(0.7, -1.3, 2.1)).norm(),
            kDelassusError);
}

// A row along a rod has no velocity but the one it has; at 1e-5 rad from it, it has: W grows with the square, 1e-10.
TEST(DenseDelassus, ARowAlongARodIsImmobile) {
  DelassusProblem problem;
  ConstraintSolver solver(problem.mechanism.constraints, problem.mechanism.bodies);
  solver.factorize(problem.state, problem.frames);
  std::vector<ConstraintRow> rods;
  findRows(problem.mechanism.constraints, problem.state, problem.frames, rods);
  ConstraintRow aside = rods[1];
  aside.linearA += 1e-5 * aside.linearA.norm() * aside.linearA.unitOrthogonal();
  const DenseDelassus delassus({rods[0], aside, problem.rows[0]}, problem.mechanism.bodies, problem.frames, &solver);
  EXPECT_TRUE(delassus.isImmobile(0));
  EXPECT_FALSE(delassus.isImmobile(1));
  EXPECT_FALSE(delassus.isImmobile(2));
  EXPECT_TRUE(isImmobile(1e-13, 1));
  EXPECT_FALSE(isImmobile(1e-11, 1));
  EXPECT_TRUE(isImmobile(0, 0));
}

}  // namespace
}  // namespace cradle
