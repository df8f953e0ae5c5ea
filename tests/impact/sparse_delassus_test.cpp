#include "impact/sparse_delassus.h"

#include <gtest/gtest.h>

#include <random>

#include "dynamics/driven_body.h"
#include "impact/contact_delassus.h"
#include "impact/frictional_contact.h"
#include "impact/stack_of_cubes.h"

namespace cradle {
namespace {

/// Turns the normals of a stack, sets velocities, and expects of both kinds the same matrix, velocities and answer to
/// some impulses; the state after these.
VectorX stateAfterImpulses(StackOfCubes& stack, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (Contact& contact : stack.contacts) contact.normal = Vec3{uniform(random), uniform(random), 1}.normalized();
  for (double& velocity : stack.state.tail(20)) velocity = uniform(random);
  const ContactDelassus dense(stack.contacts, stack.bodies, stack.state);
  SparseDelassus sparse;
  sparse.set(stack.contacts, stack.bodies, stack.state);
  EXPECT_LT((dense.matrix() - sparse.matrix()).norm(), 1e-13 * dense.matrix().norm());
  EXPECT_LT((dense.velocitiesIn(stack.state) - sparse.velocitiesIn(stack.state)).norm(), 1e-13);
  const VectorX impulses = VectorX::LinSpaced(36, -1, 2);
  VectorX one = stack.state, other = stack.state;
  dense.apply(impulses, one), sparse.apply(impulses, other);
  EXPECT_LT((one - other).norm(), 1e-12);
  return other;
}

TEST(SparseDelassus, AreTheSameProblemAsTheDenseOnes) {
  StackOfCubes stack({1, 20, 0.3});
  stateAfterImpulses(stack, 1);
}

// A driven cube among others has velocities, and neither answers impulses nor is moved by them.
TEST(SparseDelassus, HaveTheVelocitiesOfDrivenBodiesAsTheDenseOnesDo) {
  StackOfCubes stack({1, 1, 0.3});
  stack.bodies[1] = drivenRigidBody();
  const VectorX other = stateAfterImpulses(stack, 2);
  EXPECT_EQ(linearVelocity(other, 1), linearVelocity(stack.state, 1));
  EXPECT_EQ(angularVelocity(other, 1), angularVelocity(stack.state, 1));
}

TEST(SparseDelassus, AreSolvedAsTheDenseOnesAre) {
  for (const double top : {1.0, 1000.0}) {
    StackOfCubes stack({1, 1, 1, 1, 1, 1, 1, 1, 1, top});
    for (Eigen::Index body = 0; body < 10; ++body)
      linearVelocity(stack.state, body) = Vec3(0.003, -0.01, 0.002 * static_cast<double>(body % 3));
    SparseDelassus cones;
    cones.set(stack.contacts, stack.bodies, stack.state);
    const VectorX free = cones.velocitiesIn(stack.state);
    const std::vector<double> frictions(40, 0.5);
    WarmStart start{VectorX::Zero(120), VectorX::Zero(120), 0};
    const ContactSolution sparse = solveFrictionalContact(cones.scaledOperator(), free, frictions, 1e-11, start);
    const ContactSolution dense = solveFrictionalContact(cones.matrix(), free, frictions);
    EXPECT_TRUE(sparse.converged) << sparse.residual;
    EXPECT_LT((sparse.velocities - dense.velocities).cwiseAbs().maxCoeff(), 1e-8) << top;
    // It begins where it ended.
    EXPECT_EQ(solveFrictionalContact(cones.scaledOperator(), free, frictions, 1e-11, start).iterations, 0);
  }
}

/// Five cubes on each other: the lowest is hinged to the world, the next two to each other by two hinges on one axis,
/// whose rows depend on each other, the others by a ball joint and a rod. What is heavy is at the end.
struct TiedStack : StackOfCubes {
  TiedStack() : StackOfCubes({1, 2, 0.5, 3, 100}) {
    const auto anchor = [&](int body, const Vec3& point) {
      return Attachment{body, orientation(state, body).conjugate() * (point - centerOfMass(state, body))};
    };
    const auto hinge = [&](int a, int b, const Vec3& point) {
      const auto local = [&](int body, const Vec3& direction) {
        return body == kFixed ? direction : Vec3(orientation(state, body).conjugate() * direction);
      };
      const Attachment onB = b == kFixed ? Attachment{kFixed, point} : anchor(b, point);
      const HingeConstraint kind{local(a, Vec3::UnitX()), {local(b, Vec3::UnitY()), local(b, Vec3::UnitZ())}};
      constraints.push_back({anchor(a, point), onB, kind});
    };
    hinge(0, kFixed, Vec3(0.1, 0.3, 0.2));
    hinge(1, 2, Vec3(0.2, 2, 0.1));
    hinge(1, 2, Vec3(-0.3, 2, 0.1));
    constraints.push_back({anchor(2, Vec3(0.3, 3, 0)), anchor(3, Vec3(0.3, 3, 0)), BallJointConstraint{}});
    constraints.push_back({anchor(4, Vec3(0, 5, 0)), anchor(3, Vec3(0.5, 3, 0.2)), RodConstraint{std::sqrt(4.29)}});
    solver.factorize(state);
  }
  Constraints constraints;
  ConstraintSolver solver{constraints, bodies};
};

TEST(SparseDelassus, HasConstraintsWithinTheSameImpulse) {
  TiedStack stack;
  const ContactDelassus dense(stack.contacts, ImpulseResponse(stack.bodies, stack.solver), stack.state);
  SparseDelassus sparse;
  sparse.set(stack.contacts, stack.bodies, stack.solver, stack.state);
  const DelassusOperator op = sparse.scaledOperator();
  const Eigen::Index size = 3 * std::ssize(stack.contacts);
  const VectorX scales = op.scales.replicate(1, 3).transpose().reshaped();
  const MatrixX scaled = scales.asDiagonal() * dense.matrix() * scales.asDiagonal();
  const VectorX impulses = VectorX::LinSpaced(size, -1, 2);
  EXPECT_LT((op.multiply(impulses) - scaled * impulses).norm(), 1e-12 * impulses.norm());
  VectorX one = stack.state, other = stack.state;
  dense.apply(impulses, one), sparse.apply(impulses, other);
  EXPECT_LT((one - other).norm(), 1e-12 * one.norm());
  for (std::size_t i = 0; i < stack.contacts.size(); ++i)
    EXPECT_NEAR(sparse.mobility(i), dense.mobility(i), 1e-12) << i;
}

// Equations as Newton's method has them: some contacts are open, some stick (stiff), and some slide, which makes their
// blocks unsymmetric; made for a solution that is known. Its velocities come out to rounding, 1e-16, over the
// compliance of contacts, 1e-9; impulses of stiff contacts that W does not see are rounding over that twice, and are
// not compared.
TEST(SparseDelassus, SolvesNewtonsEquationsWithConstraints) {
  TiedStack stack;
  SparseDelassus sparse;
  sparse.set(stack.contacts, stack.bodies, stack.solver, stack.state);
  const DelassusOperator op = sparse.scaledOperator();
  std::vector<ContactEquation> equations(stack.contacts.size());
  VectorX change = VectorX::LinSpaced(3 * std::ssize(stack.contacts), -1, 2);
  for (std::size_t i = 0; i < equations.size(); ++i) {
    equations[i].isOpen = i % 4 == 3;
    if (equations[i].isOpen) change.segment<3>(3 * static_cast<Eigen::Index>(i)).setZero();
    if (i % 4 == 1) equations[i].ofVelocity(0, 2) = 0.4, equations[i].ofVelocity(1, 1) = 0.6;
    equations[i].ofImpulse = (i % 4 == 0 ? 1e-9 : 1e-2) * Mat3::Identity();
  }
  const VectorX exact = op.multiply(change);
  VectorX sides = VectorX::Zero(change.size());
  for (std::size_t i = 0; i < equations.size(); ++i)
    if (const Eigen::Index at = 3 * static_cast<Eigen::Index>(i); !equations[i].isOpen)
      sides.segment<3>(at) =
          equations[i].ofImpulse * change.segment<3>(at) + equations[i].ofVelocity * exact.segment<3>(at);
  ASSERT_TRUE(op.factorize(equations));
  VectorX velocities;
  const VectorX found = op.solve(sides, &velocities);
  EXPECT_LT((velocities - exact).norm(), 1e-6 * exact.norm());
  EXPECT_LT((op.multiply(found) - exact).norm(), 1e-6 * exact.norm());
  for (std::size_t i = 3; i < equations.size(); i += 4)
    EXPECT_EQ(found.segment<3>(3 * static_cast<Eigen::Index>(i)), Vec3::Zero()) << i;
}

TEST(SparseDelassus, IsSolvedWithConstraintsAsTheDenseOneIs) {
  TiedStack stack;
  for (Eigen::Index body = 0; body < 5; ++body)
    linearVelocity(stack.state, body) = Vec3(0.003, -0.01, 0.002 * static_cast<double>(body % 3));
  stack.solver.constrainVelocities(stack.state);
  SparseDelassus sparse;
  sparse.set(stack.contacts, stack.bodies, stack.solver, stack.state);
  const ContactDelassus dense(stack.contacts, ImpulseResponse(stack.bodies, stack.solver), stack.state);
  const VectorX free = sparse.velocitiesIn(stack.state);
  const std::vector<double> frictions(stack.contacts.size(), 0.5);
  WarmStart start{VectorX::Zero(free.size()), VectorX::Zero(free.size()), 0};
  const ContactSolution found = solveFrictionalContact(sparse.scaledOperator(), free, frictions, 1e-11, start);
  EXPECT_TRUE(found.converged) << found.residual;
  const ContactSolution exact = solveFrictionalContact(dense.matrix(), free, frictions);
  EXPECT_LT((found.velocities - exact.velocities).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace cradle
