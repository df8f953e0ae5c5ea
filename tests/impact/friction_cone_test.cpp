#include "impact/friction_cone.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

constexpr double kConeRounding = 1e-14;  // of some operations on numbers below 10

bool isInCone(const Vec3& z, double friction) {
  return z.head<2>().norm() <= friction * z.z() + kConeRounding;
}

/// Points on all sides of a cone, some in it, some in its polar cone.
template <class Check>
void forEachPlace(const Check& check) {
  for (const double friction : {0.0, 0.3, 1.0, 2.5})
    for (int i = 0; i < 12; ++i)
      for (int j = -4; j <= 4; ++j)
        check(Vec3(2 * std::cos(0.7 * i) * std::sin(i + 1), 2 * std::sin(0.7 * i) * std::sin(i + 1), j), friction);
}

// The nearest point p of a convex cone is the one that is in it, with z - p across p and in the polar cone (Moreau):
// (z - p) . c <= 0 for all c of the cone, of which those on its side in the direction of z - p are the worst.
TEST(ConeProjection, IsTheNearestPointByMoreausTheorem) {
  forEachPlace([](const Vec3& z, double friction) {
    const Vec3 p = projectOnCone(z, friction), rest = z - p;
    EXPECT_TRUE(isInCone(p, friction)) << z.transpose() << " " << friction;
    EXPECT_NEAR(rest.dot(p), 0, kConeRounding) << z.transpose() << " " << friction;
    EXPECT_LE(friction * rest.head<2>().norm() + rest.z(), kConeRounding) << z.transpose() << " " << friction;
  });
}

TEST(ConeProjection, LeavesThePointsOfTheConeAsTheyAre) {
  const Vec3 inside(0.29, 0, 1), onAxis(0, 0, 2);
  EXPECT_EQ(projectOnCone(inside, 0.3), inside);
  EXPECT_EQ(projectOnCone(onAxis, 0), onAxis);
}

// Open: no impulse, whatever the velocity along the surface as long as the gap opens. Sticking: no velocity, and an
// impulse in the cone. Sliding: the impulse is on the cone's side, against the velocity.
TEST(CoulombResidual, IsZeroInEachStateOfTheLaw) {
  constexpr double kFriction = 0.4;
  const auto isLaw = [](const Vec3& z, const Vec3& u) {
    return coulombResidual(z, u, kFriction).norm() < kConeRounding;
  };
  EXPECT_TRUE(isLaw(Vec3::Zero(), Vec3(3, -2, 0)));
  EXPECT_TRUE(isLaw(Vec3::Zero(), Vec3(0.1, 0, 5)));
  EXPECT_TRUE(isLaw(Vec3(0.2, 0.3, 1), Vec3::Zero()));
  EXPECT_TRUE(isLaw(Vec3(-0.24, -0.32, 1), Vec3(0.6, 0.8, 0)));
}

// Neither an impulse that pulls, nor one with friction that drives, or is too weak for sliding; no closing, and no
// opening under an impulse.
TEST(CoulombResidual, IsNoneWhereTheLawIsBroken) {
  constexpr double kFriction = 0.4;
  for (const auto& [z, u] : {std::pair(Vec3(0, 0, -1), Vec3(0, 0, 0)),
                             {Vec3(0.5, 0, 1), Vec3(0, 0, 0)},
                             {Vec3(0.4, 0, 1), Vec3(1, 0, 0)},
                             {Vec3(-0.3, 0, 1), Vec3(1, 0, 0)},
                             {Vec3(0, 0, 0), Vec3(0, 0, -1)},
                             {Vec3(0, 0, 1), Vec3(0, 0, 1)}})
    EXPECT_GT(coulombResidual(z, u, kFriction).norm(), 0.05) << z.transpose() << ", " << u.transpose();
}

}  // namespace
}  // namespace cradle
