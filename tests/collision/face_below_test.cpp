#include "collision/face_below.h"

#include <gtest/gtest.h>

#include "collision/random_poses.h"
#include "mesh/sample_meshes.h"
#include "rounding.h"

namespace cradle {
namespace {

double noMotion(const Vec3&) {
  return 0;
}

Collider movingCollider(Collider collider) {
  collider.body = 0;
  return collider;
}

// A ball of 0.25 m over the top of a box of 2 x 1 x 3 m, in any frame: the face is there as long as the ball, and its
// motion along the face, stay within the outline.
TEST(FaceBelow, IsTheOneThatHoldsTheWholeBodyInItsOutline) {
  const Collider ball = movingCollider(colliderOf(Sphere{0.25}, {})), box = colliderOf(Box{Vec3(2, 1, 3)}, {});
  for (const RigidTransform& worldFromBox : {RigidTransform(), askew()}) {
    const auto below = [&](const Vec3& place, double motion) {
      Vec3 seen = Vec3::Zero();
      const auto motionAlong = [&](const Vec3& normal) { return seen = normal, motion; };
      const auto face =
          faceBelow(ball, worldFromBox * RigidTransform{Quat::Identity(), place}, box, worldFromBox, motionAlong);
      if (face) {
        EXPECT_LT((seen - worldFromBox.rotation * face->normal).norm(), 8 * kEpsilon);  // asked for in the world
      }
      return face;
    };
    const auto top = below(Vec3(0.7, 0.6, -1.2), 0.0499);
    ASSERT_TRUE(top);
    EXPECT_EQ(top->normal, Vec3::UnitY());
    EXPECT_EQ(top->point.y(), 0.5);
    EXPECT_FALSE(top->isOfA);
    EXPECT_FALSE(below(Vec3(0.7, 0.6, -1.2), 0.0501));
    EXPECT_FALSE(below(Vec3(0.76, 0.6, 0), 0));   // over the rim in x,
    EXPECT_FALSE(below(Vec3(0, 0.6, -1.26), 0));  // and in z
    EXPECT_TRUE(below(Vec3(0, 0.6, -1.24), 0));
    EXPECT_EQ(below(Vec3(-1.2, 0.2, 0), 0)->normal, -Vec3::UnitX());
    EXPECT_FALSE(below(Vec3(0, 0.4, 0), 0));  // its centre is inside
  }
}

// Only points that move: not what is fixed, not round sides, and not over meshes.
TEST(FaceBelow, IsNoneOfBodiesWithoutPointsOrOverOthersThanPolytopes) {
  const RigidTransform above{Quat::Identity(), Vec3(0, 1, 0)};
  const Collider box = colliderOf(Box{Vec3(3, 1, 3)}, {}),
                 small = movingCollider(colliderOf(Box{Vec3(0.2, 0.2, 0.2)}, {}));
  EXPECT_TRUE(faceBelow(small, above, box, {}, noMotion));
  EXPECT_TRUE(faceBelow(movingCollider(colliderOf(Capsule{0.1, 0.2}, {})), above, box, {}, noMotion));
  EXPECT_FALSE(faceBelow(colliderOf(Box{Vec3(0.2, 0.2, 0.2)}, {}), above, box, {}, noMotion));
  EXPECT_FALSE(faceBelow(movingCollider(colliderOf(Cylinder{0.1, 0.2}, {})), above, box, {}, noMotion));
  EXPECT_FALSE(faceBelow(small, above, colliderOf(Cylinder{3, 1}, {}), {}, noMotion));
  EXPECT_FALSE(faceBelow(small, above, colliderOf(Sphere{0.5}, {}), {}, noMotion));
}

TEST(FaceBelow, HeightIsThatOverThePlaneWhereTheBodyIs) {
  RandomPoses random(1);
  for (int i = 0; i < 20; ++i) {
    const RigidTransform pose = random.pose(3);
    const FaceBelow face{false, Vec3(0.6, 0.8, 0), Vec3(1, 2, 3)};
    const Vec3 across(0.8 * 2, -0.6 * 2, 5);
    const double height = random.number(-1, 1);
    EXPECT_NEAR(heightOver(face, pose, pose * (face.point + across + height * face.normal)), height, 64 * kEpsilon);
  }
}

}  // namespace
}  // namespace cradle
