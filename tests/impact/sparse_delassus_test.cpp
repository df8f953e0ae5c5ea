#include "impact/sparse_delassus.h"

#include <gtest/gtest.h>

#include <random>

#include "impact/contact_delassus.h"
#include "impact/frictional_contact.h"
#include "impact/stack_of_cubes.h"

namespace cradle {
namespace {

TEST(SparseDelassus, AreTheSameProblemAsTheDenseOnes) {
  StackOfCubes stack({1, 20, 0.3});
  std::mt19937 random(1);
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

}  // namespace
}  // namespace cradle
