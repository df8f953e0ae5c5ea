#include "collision/core.h"

#include <gtest/gtest.h>

#include "collision/sample_cores.h"
#include "rounding.h"

namespace cradle {
namespace {

// Of the size: a support value is some 16 rounded products and sums.
constexpr double kCoreRounding = 32 * kEpsilon;

// In the frame that a pose leads to, for directions of any length, and along the axes of the core, where a rim or an
// edge has many farthest points.
TEST(Core, SupportPointIsOnTheCoreAndAsFarAsItReaches) {
  RandomPoses random(1);
  for (const double size : {1.0, 1e-6, 1e6})
    for (const SampleCore& sample : sampleCores(size)) {
      const RigidTransform pose = random.pose(size);
      const Core core(sample.collider, pose);
      std::vector<Vec3> directions{Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitZ(),
                                   Vec3::UnitY(), Vec3(1, 1, 0),  Vec3(-1, 0, 1)};
      for (int i = 0; i < 50; ++i) directions.push_back(random.direction());
      for (const Vec3& own : directions)
        for (const double length : {1.0, 1e-9, 1e9}) {
          const Vec3 direction = pose.rotation * own, point = core.supportPoint(length * direction);
          EXPECT_LE(sample.outside(pose.inverse() * point), kCoreRounding * size) << sample.name;
          const double reach = direction.dot(pose.translation) + sample.supportValue(own);
          EXPECT_NEAR(direction.dot(point), reach, kCoreRounding * 2 * size) << sample.name << own.transpose();
          EXPECT_NEAR(core.supportValue(direction), reach, kCoreRounding * 2 * size) << sample.name;
        }
    }
}

TEST(Core, MovesAsAWhole) {
  RandomPoses random(2);
  for (const SampleCore& sample : sampleCores(1)) {
    const Core core(sample.collider, random.pose(1));
    const Vec3 way = random.vector(3), direction = random.direction();
    const Core moved = core.moved(way);
    EXPECT_LT((moved.supportPoint(direction) - core.supportPoint(direction) - way).norm(), kCoreRounding * 6);
    EXPECT_LT((moved.center() - core.center() - way).norm(), kCoreRounding * 6);
    EXPECT_LT((core.turnedBack(core.turned(direction)) - direction).norm(), 8 * kEpsilon);
  }
}

TEST(Core, EndsAndRimsOfACylinderAreWhereItsPoseLeads) {
  const SampleCore drum = cylinderCore("drum", 0.5, 0.8);
  const RigidTransform pose{rotationAbout(Vec3::UnitZ(), M_PI / 2), Vec3(1, 2, 3)};  // y to -x
  const Core core(drum.collider, pose);
  EXPECT_LT((core.end(1) - Vec3(0.6, 2, 3)).norm(), kCoreRounding * 4);
  EXPECT_LT((core.end(-1) - Vec3(1.4, 2, 3)).norm(), kCoreRounding * 4);
  EXPECT_LT((core.axis() + Vec3::UnitX()).norm(), 4 * kEpsilon);
  EXPECT_LT((core.rimPoint(1, Vec3(7, 3, 4)) - Vec3(0.6, 2.3, 3.4)).norm(), kCoreRounding * 4);
  EXPECT_LT((core.rimPoint(-1, Vec3(7, -3, 4)) - Vec3(1.4, 1.7, 3.4)).norm(), kCoreRounding * 4);
}

// A direction at an angle to the axis: the part across it is known to the rounding of the direction over the angle, but
// is a unit vector across the axis to rounding always; along the axis it is any.
TEST(UnitAcross, IsAcrossTheAxisToRoundingHoweverNearTheDirectionIs) {
  RandomPoses random(3);
  for (const double angle : {1.5, 0.1, 1e-4, 1e-8, 1e-12, 1e-15, 3e-16, 1e-16, 0.0})
    for (int i = 0; i < 100; ++i) {
      const Vec3 axis = random.direction(), side = axis.cross(random.direction()).normalized();
      const Vec3 direction = (i % 2 ? -1 : 1) * std::cos(angle) * axis + std::sin(angle) * side;
      const Vec3 across = unitAcross(axis, direction);
      EXPECT_NEAR(across.norm(), 1, 4 * kEpsilon) << angle;
      EXPECT_NEAR(across.dot(axis), 0, 5 * kEpsilon) << angle;  // kPerpendicularCosine
      if (angle > 1e-14) {
        EXPECT_LT((across - side).norm(), 4 * kEpsilon / std::min(angle, 1.0));
      }
    }
}

}  // namespace
}  // namespace cradle
