#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/scene_builder.h"

namespace cradle {
namespace {

TEST(Camera, AxesAreRightHandedAndLookAtTheTarget) {
  const Mat3 axes = cameraAxes({1, 2, 3}, {-4, 0.5, 2});
  EXPECT_NEAR(axes.determinant(), 1, 1e-15);
  EXPECT_NEAR((axes.transpose() * axes - Mat3::Identity()).norm(), 0, 1e-15);
  EXPECT_NEAR((axes.col(2) + (Vec3(-4, 0.5, 2) - Vec3(1, 2, 3)).normalized()).norm(), 0, 1e-15);
  EXPECT_GT(axes.col(1).y(), 0);
  EXPECT_EQ(axes.col(0).y(), 0);
}

TEST(Camera, LookingStraightDownHasMinusZUp) {
  const Mat3 axes = cameraAxes({0, 5, 0}, {0, 0, 0});
  EXPECT_EQ(axes.col(0), Vec3::UnitX());
  EXPECT_EQ(axes.col(1), Vec3(0, 0, -1));
}

TEST(Camera, LookingStraightUpHasPlusZUp) {
  const Mat3 axes = cameraAxes({0, 0, 0}, {0, 5, 0});
  EXPECT_EQ(axes.col(0), Vec3::UnitX());
  EXPECT_EQ(axes.col(1), Vec3(0, 0, 1));
}

TEST(Camera, TargetAtThePositionLooksAlongMinusZ) {
  EXPECT_EQ(cameraAxes({1, 1, 1}, {1, 1, 1}), Mat3::Identity());
}

TEST(Camera, KnownPointFallsOnItsPixel) {
  // 90 degrees over 400 rows: 200 pixels are a slope of 1. The point is 1 right, 0.5 up, 2 ahead.
  const Camera camera = cameraAt({3, 1, 7}, {3, 1, 0}, M_PI / 2);
  const Eigen::Vector2d pixel = projectToPixel(camera, {4, 1.5, 5}, 600, 400);
  EXPECT_NEAR(pixel.x(), 300 + 200 * 0.5, 1e-12);
  EXPECT_NEAR(pixel.y(), 200 - 200 * 0.25, 1e-12);
}

TEST(Camera, MatrixAgreesWithTheFormulaFarFromTheOrigin) {
  const Vec3 far(2.3e6, -4e5, 1e6);
  const Camera camera = cameraAt(far + Vec3(1, 2, 3), far + Vec3(0.2, 0, -1), 0.7);
  const Vec3 point = far + Vec3(0.3, 0.4, -2);
  const Eigen::Vector4f clip = clipFromWorld(camera, far, 1280, 720, 0.1) * (point - far).cast<float>().homogeneous();
  const Eigen::Vector2d pixel = projectToPixel(camera, point, 1280, 720);
  // Single precision: 2^-24 of a coordinate of about 5 m, seen at 200 pixels a metre, a few times over.
  EXPECT_NEAR(1280 * (1 + clip.x() / clip.w()) / 2, pixel.x(), 1e-3);
  EXPECT_NEAR(720 * (1 - clip.y() / clip.w()) / 2, pixel.y(), 1e-3);
}

TEST(Camera, DepthRunsFromTheNearPlaneToInfinity) {
  const Camera camera = cameraAt(Vec3::Zero(), -Vec3::UnitZ(), 0.7);
  const Eigen::Matrix4f matrix = clipFromWorld(camera, Vec3::Zero(), 640, 480, 0.25);
  const auto depth = [&](const Eigen::Vector4f& point) { return (matrix * point).z() / (matrix * point).w(); };
  EXPECT_NEAR(depth({0, 0, -0.25f, 1}), -1, 1e-6);
  EXPECT_LE(depth({0, 0, -1, 0}), 1);  // infinitely far, and still inside
  EXPECT_NEAR(depth({0, 0, -1, 0}), 1, 1e-5);
}

}  // namespace
}  // namespace cradle
