#include "math/principal_axes.h"

#include <gtest/gtest.h>

#include "math/rotation.h"
#include "rounding.h"

namespace cradle {
namespace {

TEST(PrincipalAxes, DiagonalTensorKeepsItsBits) {
  const Vec3 moments(0.4 / 12, 1.36 / 12, 1.04 / 12);
  const PrincipalAxes principal = principalAxes(moments.asDiagonal());
  EXPECT_EQ(principal.moments, moments);
  EXPECT_EQ(principal.axes, Mat3(Mat3::Identity()));
}

TEST(PrincipalAxes, TurnedTensorIsTakenApart) {
  for (const Vec3& moments : {Vec3(1, 2, 3), Vec3(2, 2, 1), Vec3(1, 1 + 1e-15, 1), Vec3(1e-9, 1, 1)}) {
    const Mat3 rotation = rotationAbout({1, -2, 0.5}, 0.9).toRotationMatrix();
    const Mat3 tensor = rotation * moments.asDiagonal() * rotation.transpose();
    const PrincipalAxes principal = principalAxes((tensor + tensor.transpose()) / 2);
    const Mat3& axes = principal.axes;
    EXPECT_LE((axes * principal.moments.asDiagonal() * axes.transpose() - tensor).norm(), 20 * kEpsilon);
    EXPECT_LE((axes * axes.transpose() - Mat3::Identity()).norm(), 20 * kEpsilon);
    EXPECT_GT(axes.determinant(), 0);
  }
}

}  // namespace
}  // namespace cradle
