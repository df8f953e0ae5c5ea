#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/free_bodies.h"

namespace cradle {
namespace {

/// An independent way to the same motion: Runge-Kutta's classical method on q' = (1/2) (0, w) q, w = q I^-1 q* L, with
/// L constant, in long double. Error about (rate * timeStep)^4 * turned angle / 100.
RotationState integrated(const Case& body, double time, double timeStep) {
  using Real = long double;
  using Turn = Eigen::Quaternion<Real>;
  using Four = Eigen::Matrix<Real, 4, 1>;
  const Turn start = body.start.worldFromBody.cast<Real>().normalized();
  const Eigen::Matrix<Real, 3, 3> tensor = body.inertiaTensor.cast<Real>(), inverse = tensor.inverse();
  const Eigen::Matrix<Real, 3, 1> spin = body.start.angularVelocity.cast<Real>();
  const Eigen::Matrix<Real, 3, 1> momentum = start * (tensor * (start.conjugate() * spin));
  const auto velocity = [&](const Turn& q) -> Eigen::Matrix<Real, 3, 1> {
    return q * (inverse * (q.conjugate() * momentum));
  };
  const auto rate = [&](const Four& coefficients) -> Four {
    const Turn q = Turn(coefficients).normalized();
    const Eigen::Matrix<Real, 3, 1> half = velocity(q) / 2;
    return (Turn(0, half.x(), half.y(), half.z()) * q).coeffs();
  };
  const auto steps = static_cast<int>(std::ceil(time / timeStep));
  const Real h = static_cast<Real>(time) / steps;
  Four q = start.coeffs();
  for (int i = 0; i < steps; ++i) {
    const Four k1 = rate(q), k2 = rate(q + h / 2 * k1), k3 = rate(q + h / 2 * k2), k4 = rate(q + h * k3);
    q = (q + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)).normalized();
  }
  return {Turn(q).cast<double>(), velocity(Turn(q)).cast<double>()};
}

void expectAgreement(const Case& body, double time, double tolerance) {
  const RotationState expected = integrated(body, time, 5e-4);
  const RotationState actual = FreeRotation(body.inertiaTensor, body.start).at(time);
  EXPECT_LE(distance(actual.worldFromBody, expected.worldFromBody), tolerance);
  EXPECT_LE((actual.angularVelocity - expected.angularVelocity).norm(), tolerance * expected.angularVelocity.norm());
}

// Runge-Kutta's error is below (2 * 5e-4)^4 * 20 / 100 = 2e-13 for rates up to 2 rad/s.
TEST(FreeRotation, AnyBodyMatchesAnIntegration) {
  Random random;
  for (int i = 0; i < 20; ++i) expectAgreement(anyBody(random), 10, 4e-13);
}

// Round the axis of the largest moment, and of the smallest.
TEST(FreeRotation, BothSidesOfTheSeparatrixMatchAnIntegration) {
  Random random;
  for (int i = 0; i < 5; ++i) {
    expectAgreement(turned({1, 2, 2.5}, {0.2, 0.5, 1}, random), 10, 4e-13);
    expectAgreement(turned({1, 2, 2.5}, {-1, 0.5, -0.3}, random), 10, 4e-13);
  }
}

TEST(FreeRotation, NearlySymmetricBodiesMatchAnIntegration) {
  Random random;
  for (int power = 3; power <= 16; power += 2) {
    const double same = 1 + std::pow(10, -power);
    for (const Vec3& moments : {Vec3(1, same, 1.5), Vec3(0.6, 1, same), Vec3(1, same, same * same)}) {
      expectAgreement(straight(moments, {0.5, -0.7, 0.9}), 10, 4e-13);
      expectAgreement(turned(moments, {0.5, -0.7, 0.9}, random), 10, 4e-13);
    }
  }
}

// The growth rate next to the unstable axis, sqrt((1/I1 - 1/I2) (1/I2 - 1/I3)) M2 = 0.45, makes 1e-14 of the rounding
// of the start; the rest is Runge-Kutta's.
TEST(FreeRotation, NearlyPrincipalRotationsMatchAnIntegration) {
  for (int power = 1; power <= 20; power += 2) {
    const double little = std::pow(10, -power);
    for (int axis = 0; axis < 3; ++axis) {
      expectAgreement(straight({1, 2, 2.5}, Vec3::Unit(axis) + little * Vec3(1, -0.5, 0.7)), 10, 4e-13);
      expectAgreement(straight({1, 2, 2.5}, -Vec3::Unit(axis) + little * Vec3(0, 1, -0.7)), 10, 4e-13);
    }
  }
}

// On the separatrix (1/I1 - 1/I2) M1^2 = (1/I2 - 1/I3) M3^2, here M1 = 1 and M3 = sqrt(5): the period is infinite.
TEST(FreeRotation, NextToTheSeparatrixMatchesAnIntegration) {
  const Vec3 onSeparatrix(1, 0.4, std::sqrt(5.0) / 2.5);
  for (int power = 3; power <= 17; power += 2) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 spin = onSeparatrix + side * std::pow(10, -power) * Vec3::UnitX();
      expectAgreement(straight({1, 2, 2.5}, spin), 10, 4e-13);
      expectAgreement(straight({1, 2, 2.5}, Vec3(-spin.x(), spin.y(), spin.z())), 10, 4e-13);
    }
  }
}

}  // namespace
}  // namespace cradle
