#include <gtest/gtest.h>

#include "scene/scene.h"

namespace cradle {
namespace {

Vec3 upWith(const Vec3& gravity) {
  Scene scene;
  scene.gravity = gravity;
  return upOf(scene);
}

TEST(Up, IsTheAxisAgainstGravity) {
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
    EXPECT_EQ(upWith(-9.81 * axis), axis);
}

TEST(Up, IsYWithoutGravityAndAlongNoAxis) {
  for (const Vec3& gravity : {Vec3(0, 0, 0), Vec3(5, -9, 0), Vec3(0, 1e-9, -9.81)})
    EXPECT_EQ(upWith(gravity), Vec3::UnitY());
}

}  // namespace
}  // namespace cradle
