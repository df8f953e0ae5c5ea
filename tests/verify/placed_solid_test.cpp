#include "verify/placed_solid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

const Vec3 kViewpoint(0.3, -0.2, 4);
const RigidTransform kTilted{Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized())), Vec3(0.1, 0.2, -0.3)};

/// How far a point of the body's frame is outside of a form: 0 on its surface, < 0 inside (m).
double outside(const Sphere& sphere, const Vec3& p) {
  return p.norm() - sphere.radius;
}
double outside(const Box& box, const Vec3& p) {
  return (p.cwiseAbs() - box.size / 2).maxCoeff();
}
double outside(const Cylinder& c, const Vec3& p) {
  return std::max(std::hypot(p.x(), p.z()) - c.radius, std::abs(p.y()) - c.length / 2);
}
double outside(const Capsule& c, const Vec3& p) {
  const double past = std::max(0.0, std::abs(p.y()) - c.length / 2);
  return std::sqrt(p.x() * p.x() + p.z() * p.z() + past * past) - c.radius;
}

/// Rays over the whole form: each stops at its surface, with nothing of it on the way there, and misses have none on
/// all their way.
template <class Form>
void expectFirstMeetings(const Form& form) {
  const PlacedSolid solid(0, form, kTilted, kViewpoint);
  int hits = 0;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) {
      const PictureRay ray{kViewpoint, Vec3(i * 0.013 - 0.05, j * 0.013 + 0.1, -1)};
      const auto range = solid.meet(ray);
      const auto at = [&](double depth) {
        return outside(form, kTilted.inverse() * (ray.origin + depth * ray.direction));
      };
      if (range && range->isSure) {
        ++hits;
        EXPECT_NEAR(at(range->middle()), 0, 1e-10);
        EXPECT_LT(range->most - range->least, 1e-6);
      }
      double nearest = INFINITY;  // m: of places on the way
      for (double depth = 0; depth < (range ? range->least - 1e-6 : 9); depth += 0.03)
        nearest = std::min(nearest, at(depth));
      EXPECT_GT(nearest, 0);
    }
  EXPECT_GT(hits, 200);
}

TEST(PlacedSolid, RaysEndWhereTheyFirstMeetEachForm) {
  expectFirstMeetings(Sphere{0.6});
  expectFirstMeetings(Box{{0.9, 0.5, 1.2}});
  expectFirstMeetings(Cylinder{0.4, 1.1});
  expectFirstMeetings(Capsule{0.3, 0.8});
}

TEST(PlacedSolid, TheGroundIsMetFromAboveAlone) {
  const Plane plane{Vec3(0, 1, 0)};
  const RigidTransform place{Quat::Identity(), Vec3(5, 1, 5)};
  const PlacedSolid ground(0, plane, place, Vec3(0, 3, 0));
  const auto range = ground.meet({Vec3(0, 3, 0), Vec3(0.2, -0.5, -1)});
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->middle(), 4, 1e-10);  // 2 m below, at half a metre down for each of depth
  EXPECT_FALSE(ground.meet({Vec3(0, 3, 0), Vec3(0, 0.1, -1)}));
  EXPECT_FALSE(ground.meet({Vec3(0, 0, 0), Vec3(0, 1, -1)}));
  EXPECT_FALSE(ground.meet({Vec3(0, 0, 0), Vec3(0, -1, -1)}));
}

TEST(PlacedSolid, ACameraInsideSeesTheFarSide) {
  const PlacedSolid solid(0, Sphere{2}, {}, Vec3(0, 0, 1));
  const auto range = solid.meet({Vec3(0, 0, 1), Vec3(0, 0, -1)});
  ASSERT_TRUE(range && range->isSure);
  EXPECT_NEAR(range->middle(), 3, 1e-10);
}

TEST(PlacedSolid, NormalsAreThoseOfTheSurfaceTowardsTheCamera) {
  const PictureRay ray{kViewpoint, Vec3(-0.05, 0.06, -1)};
  const PlacedSolid sphere(0, Sphere{0.6}, kTilted, kViewpoint);
  const auto range = sphere.meet(ray);
  ASSERT_TRUE(range);
  const Vec3 normal = (ray.origin + range->middle() * ray.direction - kTilted.translation) / 0.6;
  EXPECT_LT(sphere.compareNormal(ray, *range, normal).deviation, 1e-9);
  EXPECT_NEAR(sphere.compareNormal(ray, *range, -normal).deviation, 2, 1e-9);
  const PlacedSolid box(0, Box{{0.9, 0.5, 1.2}}, kTilted, kViewpoint);
  const auto face = box.meet(ray);
  ASSERT_TRUE(face);
  int faces = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      faces += box.compareNormal(ray, *face, kTilted.rotation * (side * Vec3::Unit(axis))).deviation < 1e-9;
  EXPECT_EQ(faces, 1);
}

}  // namespace
}  // namespace cradle
