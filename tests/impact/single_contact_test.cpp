#include "impact/single_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "impact/friction_cone.h"

namespace cradle {
namespace {

/// A random symmetric positive definite matrix: a body's inverse masses at a point, with a random ratio up to 100.
Mat3 randomDelassus(std::mt19937& random) {
  std::uniform_real_distribution<double> entry(-1, 1);
  Mat3 root;
  for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = entry(random);
  return root * root.transpose() + 0.05 * Mat3::Identity();
}

// Coulomb's law with u = free + G z: the residual is rounding, some 1e-14 of impulses below 1e3 N s that conditions of
// 1e2 enlarge.
TEST(SingleContact, KeepsCoulombsLaw) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> speed(-2, 2), frictions(0, 1.2);
  int sticking = 0, sliding = 0, open = 0;
  for (int i = 0; i < 2000; ++i) {
    const Mat3 g = randomDelassus(random);
    const Vec3 free(speed(random), speed(random), speed(random));
    const double friction = frictions(random);
    const Vec3 z = solveSingleContact(g, free, friction), u = free + g * z;
    EXPECT_LT(coulombResidual(z, u, friction).norm(), 1e-10 * (1 + z.norm())) << i;
    (z.z() == 0 ? open : u.head<2>().norm() < 1e-9 ? sticking : sliding)++;
  }
  EXPECT_GT(open, 500);
  EXPECT_GT(sticking, 100);
  EXPECT_GT(sliding, 100);
}

// A sphere that strikes with v along and w into the surface: G = diag(7/2, 7/2, 1) / m. It sticks with (2/7) v m along
// up to friction = 2 v / (7 w), and slides with friction w m beyond.
TEST(SingleContact, OfASphereSlidesBeyondTwoSevenths) {
  constexpr double kMass = 2, kAlong = 3, kInto = 1.5;
  const Mat3 g = Vec3(3.5, 3.5, 1).asDiagonal() * (1 / kMass);
  const Vec3 direction(0.6, -0.8, 0), free = kAlong * direction - kInto * Vec3::UnitZ();
  const double border = 2 * kAlong / (7 * kInto);
  for (const double friction : {0.5 * border, 0.99 * border, 1.01 * border, 3 * border}) {
    const double along = std::min(friction * kInto, 2 * kAlong / 7) * kMass;
    EXPECT_LT((solveSingleContact(g, free, friction) - Vec3(-along * direction + kInto * kMass * Vec3::UnitZ())).norm(),
              1e-13);
  }
}

TEST(SingleContact, IsOpenWhereNothingClosesOrNothingCanMove) {
  const Mat3 g = Vec3(2, 3, 1).asDiagonal();
  EXPECT_EQ(solveSingleContact(g, Vec3(1, 2, 0), 0.5), Vec3(0, 0, 0));
  EXPECT_EQ(solveSingleContact(g, Vec3(1, 2, 1), 0.5), Vec3(0, 0, 0));
  EXPECT_EQ(solveSingleContact(Mat3::Zero(), Vec3(1, 2, -1), 0.5), Vec3(0, 0, 0));
  EXPECT_EQ(solveSingleContact(g, Vec3(1, 2, -4), 0), Vec3(0, 0, 4));
}

// Turned about the normal, the solution turns along.
TEST(SingleContact, TurnsWithItsProblem) {
  std::mt19937 random(7);
  const Mat3 g = randomDelassus(random), turn = Eigen::AngleAxisd(0.8, Vec3::UnitZ()).toRotationMatrix();
  const Vec3 free(1.5, -0.4, -1);
  const Vec3 turned = solveSingleContact(turn * g * turn.transpose(), turn * free, 0.2);
  EXPECT_LT((turned - turn * solveSingleContact(g, free, 0.2)).norm(), 1e-12);
}

}  // namespace
}  // namespace cradle
