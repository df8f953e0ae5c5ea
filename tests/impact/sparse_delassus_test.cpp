#include "impact/sparse_delassus.h"

#include <gtest/gtest.h>

#include <random>

#include "impact/contact_delassus.h"
#include "impact/frictional_contact.h"
#include "impact/row_of_balls.h"
#include "math/rotation.h"

namespace cradle {
namespace {

/// Cubes of edge 1 on each other on a floor at y = 0, turned by `turn` (rad) about y one against the other.
struct Stack {
  std::vector<RigidBody> bodies;
  std::vector<Contact> contacts;
  VectorX state;

  explicit Stack(const std::vector<double>& masses) : state(statesAtRest(std::ssize(masses))) {
    for (int body = 0; body < std::ssize(masses); ++body) {
      const double mass = masses[static_cast<std::size_t>(body)];
      bodies.push_back(makeRigidBody({mass, Vec3::Zero(), Mat3(mass / 12 * Vec3(2, 2.2, 1.9).asDiagonal())}));
      centerOfMass(state, body).y() = 0.5 + body;
      setOrientation(state, body, rotationAbout(Vec3(1, 2, 3), 0.3 * body));
      for (const double x : {-0.5, 0.45})
        for (const double z : {-0.4, 0.5}) contacts.push_back({0, body, body - 1, Vec3(x, body, z), -Vec3::UnitY(), 0});
    }
  }
};

TEST(SparseDelassus, AreTheSameProblemAsTheDenseOnes) {
  Stack stack({1, 20, 0.3});
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
    Stack stack({1, 1, 1, 1, 1, 1, 1, 1, 1, top});
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
