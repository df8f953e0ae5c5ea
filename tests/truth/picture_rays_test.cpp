#include "truth/picture_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "render/camera.h"
#include "truth/truth_scene.h"

namespace cradle {
namespace {

constexpr double kRounding = 1e-12;  // of closed forms of lengths of about 1 m

/// Calls check(x, y, seen) for each pixel's centre.
template <class Check>
void forEachPixel(TruthScene& truth, const Check& check) {
  std::size_t pixel = 0;
  for (int row = 0; row < truth.height; ++row)
    for (int column = 0; column < truth.width; ++column, ++pixel)
      check(column + 0.5, row + 0.5, truth.first().seen()[pixel]);
}

TEST(Pinhole, SeesPointsWherePicturesDrawThem) {
  Camera camera = cameraAt({3, 2, 5}, {0.3, 0.1, -0.2}, 0.7);
  camera.up = Vec3(0.1, 1, 0.2).normalized();
  const Pinhole pinhole(camera, 640, 360);
  for (const Vec3& point : {Vec3(0, 0, 0), Vec3(1, 0.5, -3), Vec3(-2, 1, 0.7)}) {
    const auto place = pinhole.project(pinhole.inCamera(point));
    ASSERT_TRUE(place);
    EXPECT_NEAR((*place - projectToPixel(camera, point, 640, 360)).norm(), 0, 1e-10);
    const Vec3 ray = pinhole.rayAt(place->x(), place->y());
    EXPECT_EQ(ray.z(), 1);
    EXPECT_NEAR(pinhole.inCamera(point).normalized().dot(ray.normalized()), 1, kRounding);
    const Vec3 homogeneous = pinhole.intrinsics() * pinhole.inCamera(point);
    EXPECT_NEAR(homogeneous.x() / homogeneous.z(), place->x(), 1e-10);
    EXPECT_NEAR(homogeneous.y() / homogeneous.z(), place->y(), 1e-10);
  }
  EXPECT_FALSE(pinhole.project(pinhole.inCamera({3, 2, 6})));  // behind
}

TEST(PictureRays, MeetASphereAtItsNearerRoot) {
  const Vec3 center(0.2, -0.1, 0.3);
  const double radius = 0.8;
  TruthScene truth(96, 64);
  addBody(truth.scene, Sphere{radius}, {Quat::Identity(), center}, Motion::fixed);
  truth.camera = cameraAt({0.5, 1, 4}, {0, 0, 0}, 0.8);
  int met = 0;
  forEachPixel(truth, [&](double x, double y, const SeenPoint& seen) {
    // |o + t d - c|^2 = r^2 with d of depth 1, so that t is the depth.
    const Vec3 d = truth.first().pinhole().worldFromCamera() * truth.first().pinhole().rayAt(x, y);
    const Vec3 o = truth.camera.position - center;
    const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius, root = b * b - a * c;
    ASSERT_EQ(seen.isSky(), root < 0);
    if (seen.isSky()) return;
    ++met;
    EXPECT_NEAR(seen.depth, (-b - std::sqrt(root)) / a, 1e-10);  // roots near the outline lose half of their digits
    const Vec3 point = truth.first().rays().pointAt(x, y, seen);
    EXPECT_NEAR((point - center).norm(), radius, 1e-10);
    EXPECT_NEAR((truth.first().rays().normalAt(x, y, seen) - (point - center) / radius).norm(), 0, 1e-9);
  });
  EXPECT_GT(met, 500);
}

TEST(PictureRays, DepthIsAlongTheViewAndNotAlongTheRay) {
  TruthScene truth(64, 48);
  addBody(truth.scene, Box{{20, 20, 1}}, {Quat::Identity(), {0, 0, -0.5}}, Motion::fixed);
  truth.camera = cameraAt({0, 0, 3}, {0, 0, 0}, 1.2);
  forEachPixel(truth, [&](double x, double y, const SeenPoint& seen) {
    EXPECT_NEAR(seen.depth, 3, kRounding);
    EXPECT_NEAR((truth.first().rays().normalAt(x, y, seen) - Vec3::UnitZ()).norm(), 0, kRounding);
  });
}

TEST(PictureRays, MeetTurnedShapesOnTheirSurfaces) {
  const Quat turn = rotationAbout(Vec3(1, 2, 3).normalized(), 0.9);
  const RigidTransform place{turn, {0.1, 0.2, 0}};
  const std::vector<std::pair<Shape, std::function<double(const Vec3&)>>> shapes = {
      {Box{{1, 0.6, 0.8}},
       [](const Vec3& p) {
         const Vec3 beyond = p.cwiseAbs() - Vec3(0.5, 0.3, 0.4);
         return beyond.maxCoeff();
       }},
      {Cylinder{0.4, 1.2},
       [](const Vec3& p) { return std::max(std::hypot(p.x(), p.z()) - 0.4, std::abs(p.y()) - 0.6); }},
      {Capsule{0.3, 0.8}, [](const Vec3& p) { return (p - Vec3(0, std::clamp(p.y(), -0.4, 0.4), 0)).norm() - 0.3; }}};
  for (const auto& [shape, distance] : shapes) {
    TruthScene truth(80, 80);
    addBody(truth.scene, shape, place, Motion::fixed);
    truth.camera = cameraAt({0, 0.5, 3}, {0, 0, 0}, 0.6);
    int met = 0;
    forEachPixel(truth, [&](double x, double y, const SeenPoint& seen) {
      if (seen.isSky()) return;
      ++met;
      const Vec3 point = truth.first().rays().pointAt(x, y, seen), local = place.inverse() * point;
      EXPECT_NEAR(distance(local), 0, 1e-9);
      // Outwards: the distance grows along the normal as fast as one goes.
      const Vec3 normal = truth.first().rays().normalAt(x, y, seen);
      EXPECT_NEAR(distance(place.inverse() * (point + 1e-4 * normal)), 1e-4, 2e-8);
      EXPECT_LT(normal.dot(point - truth.camera.position), 0);
    });
    EXPECT_GT(met, 400);
  }
}

TEST(PictureRays, NoneSlipsThroughBetweenTriangles) {
  TruthScene truth(160, 160);
  truth.addMesh(tessellate(Sphere{1}, 48), {rotationAbout(Vec3(1, 1, 0).normalized(), 0.3), Vec3::Zero()});
  truth.camera = cameraAt({0, 0, 4}, {0, 0, 0}, 0.6);
  const double inner = std::cos(std::numbers::pi / 48);  // as far as every facet reaches
  const Pinhole& pinhole = truth.first().pinhole();
  int inside = 0;
  forEachPixel(truth, [&](double x, double y, const SeenPoint& seen) {
    const Vec3 ray = pinhole.worldFromCamera() * pinhole.rayAt(x, y).normalized();
    const double passes = truth.camera.position.cross(ray).norm();
    if (passes > inner * inner) return;
    ++inside;
    ASSERT_FALSE(seen.isSky()) << x << " " << y;
    EXPECT_GE(truth.first().rays().pointAt(x, y, seen).norm(),
              inner * inner - kRounding);  // the near side, not the far one
    EXPECT_LT((truth.first().rays().pointAt(x, y, seen)).z() * -1, 0.2);
  });
  EXPECT_GT(inside, 8000);
}

TEST(PictureRays, RaysBetweenPixelsMeetWhatIsThere) {
  TruthScene truth(40, 30);
  truth.addMesh(tessellate(Box{{1, 1, 1}}), {});
  addBody(truth.scene, Sphere{0.3}, {Quat::Identity(), {0.1, 0.1, 1}}, Motion::fixed);
  truth.camera = cameraAt({1, 1.5, 4}, {0, 0, 0}, 0.7);
  forEachPixel(truth, [&](double x, double y, const SeenPoint& seen) {
    const SeenPoint again = truth.first().rays().seenAt(x, y);
    EXPECT_EQ(again.surface, seen.surface);
    EXPECT_EQ(again.triangle, seen.triangle);
    if (!seen.isSky()) {
      EXPECT_NEAR(again.depth, seen.depth, kRounding);
    }
  });
}

TEST(PictureRays, TrianglesThatReachBehindTheCameraAreMetBeforeIt) {
  TruthScene truth(32, 32);
  truth.addMesh(tessellate(Box{{2, 0.2, 40}}), {Quat::Identity(), {0, -1, 0}});  // a road below, from behind on
  truth.camera = cameraAt({0, 0, 5}, {0, 0, 0}, 1);
  forEachPixel(truth, [&](double x, double y, const SeenPoint& seen) {
    if (seen.isSky()) return;
    EXPECT_GT(y, 16) << x;
    if (std::abs(truth.first().rays().pointAt(x, y, seen).y() + 0.9) > 1e-9) {
      EXPECT_NEAR(truth.first().rays().pointAt(x, y, seen).z(), 20, 1e-9);  // the end that faces the camera
    }
  });
  EXPECT_FALSE(truth.first().seen()[32 * 31 + 16].isSky());
}

TEST(PictureRays, CountWhatIsHidden) {
  TruthScene truth(100, 100);
  addBody(truth.scene, Box{{1, 1, 0.1}}, {Quat::Identity(), {0, 0, -0.05}}, Motion::fixed);
  addBody(truth.scene, Box{{0.5, 2, 0.1}}, {Quat::Identity(), {0.25, 0, 0.95}},
          Motion::fixed);                                                       // before its right half
  truth.camera = cameraAt({0, 0, 1001}, {0, 0, 0}, 2 * std::atan(1.0 / 1001));  // 2 m across, nearly parallel
  const std::vector<WholeExtent>& wholes = truth.first().wholes();
  EXPECT_EQ(wholes[0].pixels, 50 * 50);
  EXPECT_EQ(wholes[0].left, 25);
  EXPECT_EQ(wholes[0].right, 75);
  EXPECT_EQ(wholes[0].top, 25);
  EXPECT_EQ(wholes[0].bottom, 75);
  long visible = 0;
  for (const SeenPoint& seen : truth.first().seen()) visible += seen.surface == 0;
  EXPECT_NEAR(static_cast<double>(visible), 25 * 50, 50);  // the other's edge is on centres of pixels but for 1e-3
}

}  // namespace
}  // namespace cradle
