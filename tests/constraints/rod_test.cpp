#include "constraints/rod.h"

#include <gtest/gtest.h>

#include "constraints/moving_ends.h"

namespace cradle {
namespace {

TEST(Rod, RateAndVelocityProductAreTheDerivativesOfItsError) {
  EXPECT_LT(largestDerivativeError(RodConstraint{2.5}), kDerivativeError);
}

// C = (d^2 - length^2) / 2, at any size: C / scale is what the ends are too far apart, to half its square over the
// length.
TEST(Rod, ErrorIsTheLengtheningAtAnySize) {
  for (const double size : {1.0, 1e-6, 1e6})
    for (const double longer : {1e-7, -1e-7, 0.5, 0.0}) {
      const RodConstraint rod{7 * size};
      const ConstraintEnd a = fixedEnd((1 + longer) * size * Vec3(2, 3, 6)), b = fixedEnd(Vec3::Zero());
      const ConstraintRow row = rowOf(blockOf(rod, {a, b}), 0);
      const double lengthening = 7 * size * longer;
      EXPECT_NEAR(row.value / row.scale, lengthening + lengthening * lengthening / (2 * rod.length), 4e-15 * size);
      EXPECT_EQ(row.rounding, kRowRounding * rod.length);
      EXPECT_EQ(row.linearA, a.position);  // the force on A for a multiplier of 1: multiplier x length, away from B
      EXPECT_EQ(row.linearB, -a.position);
    }
}

// A force along the rod has the torque arm x force, the other way at the other end; the whole row has no net force, nor
// any net torque about the world's origin.
TEST(Rod, PushesItsEndsApartWithoutNetForceOrTorque) {
  const auto [endA, endB] = someMovingEnds();
  Mat3 rotationA, rotationB;
  const ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  const ConstraintRow row = rowOf(blockOf(RodConstraint{2}, ends), 0);
  EXPECT_LT((row.angularA - ends.a.arm.cross(row.linearA)).norm(), 1e-15);
  EXPECT_LT((row.angularB - ends.b.arm.cross(row.linearB)).norm(), 1e-15);
  EXPECT_EQ(row.linearA, Vec3(-row.linearB));
  const Vec3 torque = endA.center.cross(row.linearA) + row.angularA + endB.center.cross(row.linearB) + row.angularB;
  EXPECT_LT(torque.norm(), 1e-14);
  EXPECT_GT(row.linearA.dot(ends.a.position - ends.b.position), 0);
}

// A ball on a rod around a fixed point at radius r and speed v: the centripetal acceleration v^2 / r keeps C''  = 0.
TEST(Rod, NeedsTheCentripetalForce) {
  const ConstraintEnd ball{Vec3(0, -2, 0), Vec3::Zero(), Vec3(3, 0, 0), Vec3::Zero(), nullptr};
  const ConstraintRow row = rowOf(blockOf(RodConstraint{2}, {ball, fixedEnd(Vec3::Zero())}), 0);
  EXPECT_EQ(row.value, 0);
  EXPECT_EQ(row.velocityProduct, 9);  // = -J a with J = d and a = v^2 / r towards the centre
  EXPECT_EQ(row.linearA.dot(Vec3(0, 4.5, 0)), -9);
}

}  // namespace
}  // namespace cradle
