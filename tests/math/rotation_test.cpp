#include "math/rotation.h"
#include "core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cradle {
namespace {

using std::numbers::pi;

// Sine, cosine and a dozen products of numbers up to 1, each rounded once.
constexpr double kRounding = 3e-15;

Mat3 matrix(const Quat& rotation) {
  return rotation.toRotationMatrix();
}

// Rotation matrices written out, as in textbooks.
Mat3 aboutX(double a) {
  return Mat3{{1, 0, 0}, {0, std::cos(a), -std::sin(a)}, {0, std::sin(a), std::cos(a)}};
}
Mat3 aboutY(double a) {
  return Mat3{{std::cos(a), 0, std::sin(a)}, {0, 1, 0}, {-std::sin(a), 0, std::cos(a)}};
}
Mat3 aboutZ(double a) {
  return Mat3{{std::cos(a), -std::sin(a), 0}, {std::sin(a), std::cos(a), 0}, {0, 0, 1}};
}

TEST(Rotation, QuarterTurnIsCounterClockwise) {
  EXPECT_LE((rotationAbout({0, 0, 5}, pi / 2) * Vec3(1, 2, 3) - Vec3(-2, 1, 3)).norm(), kRounding);
  EXPECT_LE((rotationAbout({7, 0, 0}, pi / 2) * Vec3(1, 2, 3) - Vec3(1, -3, 2)).norm(), kRounding);
}

TEST(Rotation, AboutAnyAxisMatchesRodrigues) {
  const Vec3 axis = Vec3(1, -2, 0.5).normalized(), v(0.3, 0.9, -1.1);
  const double angle = 2.3;
  const Vec3 expected =
      std::cos(angle) * v + std::sin(angle) * axis.cross(v) + (1 - std::cos(angle)) * axis.dot(v) * axis;
  EXPECT_LE((rotationAbout(3 * axis, angle) * v - expected).norm(), kRounding);
  EXPECT_NEAR(rotationAbout(3 * axis, angle).norm(), 1, kRounding);
}

TEST(Rotation, EulerAnglesMultiplyInTheOrderOfTheLetters) {
  const double a = 0.4, b = -1.1, c = 2.5;
  EXPECT_LE((matrix(rotationFromEuler({a, b, c}, "zyx")) - aboutZ(a) * aboutY(b) * aboutX(c)).norm(), kRounding);
  EXPECT_LE((matrix(rotationFromEuler({a, b, c}, "xyz")) - aboutX(a) * aboutY(b) * aboutZ(c)).norm(), kRounding);
  EXPECT_LE((matrix(rotationFromEuler({a, b, c}, "zxz")) - aboutZ(a) * aboutX(b) * aboutZ(c)).norm(), kRounding);
}

TEST(Rotation, RateOfOrientationTurnsPointsWithTheWorldAngularVelocity) {
  // d/dt (q p) = w x (q p), with q' by a central difference of the exact rotation: error h^2 |w|^3 / 6, and 1e-16 / h.
  const Quat start = rotationFromEuler({0.4, -1.1, 2.5}, "zyx");
  const Vec3 angularVelocity(0.7, -0.2, 1.3);
  const double h = 1e-5;
  const auto after = [&](double time) {
    return (rotationAbout(angularVelocity, angularVelocity.norm() * time) * start).coeffs();
  };
  const Eigen::Vector4d difference = (after(h) - after(-h)) / (2 * h);
  EXPECT_LE((orientationRate(start, angularVelocity).coeffs() - difference).norm(), 1e-10);
}

TEST(Rotation, SkewMatrixIsTheCrossProduct) {
  const Vec3 a(1, -2, 3), b(0.5, 4, -1);
  EXPECT_EQ(Vec3(skew(a) * b), a.cross(b));
  EXPECT_EQ(Mat3(skew(a).transpose()), Mat3(-skew(a)));
}

TEST(Rotation, BetweenTwoDirectionsIsTheShortest) {
  // Of nearly opposite directions the axis is lost: rounding is divided by the length of their sum, 1e-4 at the least.
  for (const double angle : {0.0, 1e-9, 0.3, 2.5, pi - 1e-3, pi - 1e-6, pi}) {
    const Vec3 axis = Vec3(1, -2, 0.5).normalized(), from = axis.cross(Vec3(0.2, 0.3, 1)).normalized();
    const Vec3 to = std::cos(angle) * from + std::sin(angle) * axis.cross(from);
    const Quat rotation = rotationBetween(3 * from, 0.2 * to);
    EXPECT_NEAR(rotation.norm(), 1, 3e-12) << angle;
    EXPECT_LE((rotation * from - to).norm(), 3e-12) << angle;
    const double rounding = angle < pi - 1e-2 ? 10 * kRounding : 3;  // of the axis; a rotation by pi may have another
    EXPECT_LE((rotation * axis - axis).norm(), rounding) << angle;
    EXPECT_NEAR(std::abs(rotation.w()), std::cos(angle / 2), 1e-6) << angle;
  }
}

TEST(Rotation, OrderOfThreeLettersIsRequired) {
  EXPECT_THROW(rotationFromEuler({0, 0, 0}, "zy"), FailedCheck);
  EXPECT_THROW(rotationFromEuler({0, 0, 0}, "zya"), FailedCheck);
}

TEST(RigidTransform, MapsPointsAndChains) {
  const RigidTransform a{rotationAbout({0, 0, 1}, pi / 2), Vec3(1, 2, 3)},
      b{rotationAbout({1, 0, 0}, pi / 2), Vec3(4, 5, 6)};
  const Vec3 p(0.1, 0.2, 0.3);
  EXPECT_LE((a * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm(), kRounding);
  EXPECT_LE(((a * b) * p - a * (b * p)).norm(), 10 * kRounding);
  EXPECT_LE((a.inverse() * (a * p) - p).norm(), 10 * kRounding);
}

}  // namespace
}  // namespace cradle
