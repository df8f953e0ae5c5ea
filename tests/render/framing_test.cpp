#include "render/framing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kWidth = 640, kHeight = 360;

Frame frameWithBallAt(const Vec3& position) {
  Frame frame;
  frame.states.resize(1);
  frame.states[0].position = position;
  return frame;
}

Scene ballScene(double radius) {
  Scene scene = emptyScene();
  addBody(scene, Sphere{radius}, {});
  return scene;
}

/// The part of the picture (-1..1 both ways) that balls on a path cover.
Eigen::AlignedBox2d coveredPart(const Camera& camera, const std::vector<Vec3>& path, double radius) {
  Eigen::AlignedBox2d covered;
  for (const Vec3& center : path) {
    for (int i = 0; i < 2000; ++i) {  // a spiral over the ball
      const double z = -1 + (2 * i + 1) / 2000.0, angle = 2.4 * i, across = std::sqrt(1 - z * z);
      const Vec3 point = center + radius * Vec3(across * std::cos(angle), across * std::sin(angle), z);
      const Eigen::Vector2d pixel = projectToPixel(camera, point, kWidth, kHeight);
      covered.extend(Eigen::Vector2d(2 * pixel.x() / kWidth - 1, 1 - 2 * pixel.y() / kHeight));
    }
  }
  return covered;
}

Eigen::AlignedBox2d coveredBy(const std::vector<Vec3>& path) {
  const Scene scene = ballScene(0.3);
  Framing framing(scene, kWidth, kHeight);
  for (const Vec3& place : path) framing.add(frameWithBallAt(place));
  return coveredPart(framing.view().camera, path, 0.3);
}

TEST(Framing, TallMotionFillsThePictureFromTopToBottom) {
  const auto covered = coveredBy({{0, 0, 0}, {2, 1, 0.5}, {-1, 3, -4}, {0.5, -2, 1}, {1, 7, 0}});
  EXPECT_NEAR(covered.min().y(), -0.84, 1e-3);
  EXPECT_NEAR(covered.max().y(), 0.84, 1e-3);
  EXPECT_LT(covered.max().x(), 0.84);
  EXPECT_GT(covered.min().x(), -0.84);
}

TEST(Framing, WideMotionFillsThePictureFromSideToSide) {
  const auto covered = coveredBy({{-6, 0, 0}, {3, 1, 0.5}, {-1, -1, -4}, {5, 0, 1}});
  EXPECT_NEAR(covered.min().x(), -0.84, 1e-3);
  EXPECT_NEAR(covered.max().x(), 0.84, 1e-3);
  EXPECT_LT(covered.max().y(), 0.84);
  EXPECT_GT(covered.min().y(), -0.84);
}

TEST(Framing, OrderOfFramesDoesNotMatter) {
  const Scene scene = ballScene(0.3);
  Framing forwards(scene, kWidth, kHeight), backwards(scene, kWidth, kHeight);
  for (int i = 0; i < 5; ++i) forwards.add(frameWithBallAt({0.3 * i, std::sin(i), 0}));
  for (int i = 4; i >= 0; --i) backwards.add(frameWithBallAt({0.3 * i, std::sin(i), 0}));
  EXPECT_EQ(forwards.view().camera.position, backwards.view().camera.position);
}

TEST(Framing, LooksFromAboveAndAcrossTheMotion) {
  const Scene scene = ballScene(0.1);
  Framing alongX(scene, kWidth, kHeight), alongZ(scene, kWidth, kHeight);
  for (const double s : {-2.0, 2.0}) {
    alongX.add(frameWithBallAt({s, 0, 0}));
    alongZ.add(frameWithBallAt({0, 0, s}));
  }
  for (const Framing* framing : {&alongX, &alongZ}) EXPECT_GT(framing->view().camera.position.y(), 0);
  const Vec3 fromX = alongX.view().camera.position, fromZ = alongZ.view().camera.position;
  EXPECT_GT(std::abs(fromX.z()), std::abs(fromX.x()));
  EXPECT_GT(std::abs(fromZ.x()), std::abs(fromZ.z()));
}

TEST(Framing, NeverLooksFromBehindASlope) {
  for (const double tilt : {-0.9, -0.5, 0.5, 0.9}) {
    for (const Vec3& axis : {Vec3(Vec3::UnitZ()), Vec3(Vec3::UnitX())}) {
      Scene scene = emptyScene();
      const Quat turn = rotationAbout(axis, tilt);
      addBody(scene, Plane{}, {turn, Vec3::Zero()}, Motion::fixed);
      addBody(scene, Sphere{0.5}, {Quat::Identity(), turn * Vec3(0, 0.5, 0)});
      const Camera camera = viewOfStart(scene, kWidth, kHeight).camera;
      EXPECT_GT((turn * Vec3::UnitY()).dot(camera.position), 0) << tilt << " about " << axis.transpose();
    }
  }
}

TEST(Framing, FixedBodiesAreShownUnlessTheyAreScenery) {
  Scene scene = ballScene(0.5);
  addBody(scene, Box{{1, 1, 1}}, {Quat::Identity(), {2, 0, 0}}, Motion::fixed);
  const View with = viewOfStart(scene, kWidth, kHeight);
  EXPECT_NEAR(with.bounds.max().x(), 2.5, 1e-12);
  scene.bodies.back().shape = Box{{100, 1, 100}};
  const View without = viewOfStart(scene, kWidth, kHeight);
  EXPECT_NEAR(without.bounds.max().x(), 0.5, 1e-12);
}

TEST(Framing, CameraOfTheSceneIsTaken) {
  Scene scene = ballScene(0.5);
  scene.camera = cameraAt({9, 8, 7}, {1, 2, 3}, 0.5);
  EXPECT_EQ(viewOfStart(scene, kWidth, kHeight).camera.position, Vec3(9, 8, 7));
}

}  // namespace
}  // namespace cradle
