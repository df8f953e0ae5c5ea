#include "dynamics/polhode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/jacobi_elliptic.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kCurveRounding = 1e-13;  // of a dozen operations, on moments up to ten times each other

const Mat3 kAxes = rotationAbout(Vec3(1, -2, 0.5), 1.1).toRotationMatrix();
const Mat3 kInertia = kAxes * Vec3(0.2, 0.5, 0.6).asDiagonal() * kAxes.transpose();  // kg m^2

/// Angular momenta (N m s, body's frame) nearest to the axis of the smallest moment, and of the largest.
const Vec3 kMomenta[] = {3 * (kAxes * Vec3(0.9, -0.3, 0.2).normalized()),
                         3 * (kAxes * Vec3(-0.1, 0.4, -0.8).normalized())};

/// The direction and its rate (1/s) at a time.
struct Motion {
  Vec3 direction, rate;
};
Motion motionIn(const Polhode& curve, double time) {
  const JacobiElliptic functions(curve.complement);
  const double u = curve.argument + curve.rate * time;
  const auto [sn, cn, dn] = functions.at(sinCos(std::numbers::pi / 2 * u / functions.quarterPeriod()));
  const Vec3 change(-sn * dn, cn * dn, -curve.modulus * curve.modulus * sn * cn);
  return {curve.amplitude.cwiseProduct(Vec3(cn, sn, dn)), curve.rate * curve.amplitude.cwiseProduct(change)};
}

TEST(Polhode, StartsAtTheAngularMomentum) {
  for (const Vec3& momentum : kMomenta) {
    const auto curve = polhodeOf(kInertia, momentum);
    ASSERT_TRUE(curve);
    EXPECT_NEAR(curve->momentum, 3, kCurveRounding);
    EXPECT_LT((3 * (curve->bodyFromAxes * curve->start) - momentum).norm(), kCurveRounding);
    EXPECT_LT((motionIn(*curve, 0).direction - curve->start).norm(), kCurveRounding);
    EXPECT_GE(curve->start.x(), 0);
    EXPECT_GE(curve->start.z(), 0);
  }
}

TEST(Polhode, GoesRoundTheAxisOfTheLargestOrSmallestMoment) {
  for (const bool isLargest : {false, true}) {
    const auto curve = polhodeOf(kInertia, kMomenta[isLargest]);
    EXPECT_EQ(curve->sense, isLargest ? 1 : -1);
    const Vec3 moments = isLargest ? Vec3(0.2, 0.5, 0.6) : Vec3(0.6, 0.5, 0.2);
    EXPECT_LT((curve->inverseMoments - moments.cwiseInverse()).norm(), kCurveRounding);
    // The axes have these moments in the body.
    const Mat3 axes = curve->bodyFromAxes.toRotationMatrix();
    EXPECT_LT((axes.transpose() * kInertia * axes - Mat3(moments.asDiagonal())).norm(), kCurveRounding);
    EXPECT_NEAR(curve->modulus * curve->modulus + curve->complement * curve->complement, 1, kCurveRounding);
  }
}

// Euler's equation m' = |L| m x (h_1 m_1, h_2 m_2, h_3 m_3), at all times, of a direction m of unit length.
TEST(Polhode, SolvesEulersEquation) {
  for (const Vec3& momentum : kMomenta)
    for (const double time : {0.0, 0.3, -0.7, 2.0}) {
      const auto curve = polhodeOf(kInertia, momentum);
      const auto [direction, rate] = motionIn(*curve, time);
      const Vec3 euler = 3 * direction.cross(curve->inverseMoments.cwiseProduct(direction));
      EXPECT_LT((rate - euler).norm(), 1e-12) << time;  // rates of some 10 1/s
      EXPECT_NEAR(direction.norm(), 1, kCurveRounding);
    }
}

// Turned with its body, a curve is the same.
TEST(Polhode, TurnsWithItsBody) {
  const Mat3 turn = rotationAbout(Vec3(2, 1, -1), 0.7).toRotationMatrix();
  for (const Vec3& momentum : kMomenta) {
    const auto curve = polhodeOf(kInertia, momentum),
               turned = polhodeOf(turn * kInertia * turn.transpose(), turn * momentum);
    EXPECT_LT((turned->start - curve->start).norm(), kCurveRounding);
    EXPECT_LT((turned->amplitude - curve->amplitude).norm(), kCurveRounding);
    EXPECT_NEAR(turned->rate, curve->rate, kCurveRounding * curve->rate);
    EXPECT_NEAR(turned->argument, curve->argument, kCurveRounding);
  }
}

TEST(Polhode, IsNoneWhereTheDirectionStays) {
  const Mat3 straight = Vec3(0.2, 0.5, 0.6).asDiagonal();
  EXPECT_FALSE(polhodeOf(straight, Vec3::Zero()));
  for (int axis = 0; axis < 3; ++axis) EXPECT_FALSE(polhodeOf(straight, -2 * Vec3::Unit(axis)));
  EXPECT_FALSE(polhodeOf(0.5 * Mat3::Identity(), Vec3(1, 2, 3)));
  EXPECT_TRUE(polhodeOf(straight, Vec3(1, 1e-9, 0)));
}

}  // namespace
}  // namespace cradle
