#include "render/camera_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "math/rotation.h"
#include "render/body_place.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 640, kHeight = 360;
constexpr double kFieldOfView = M_PI / 2;  // 180 pixels are a slope of 1

/// A ball "lead" of radius 0.1 at the origin, seen from `position`.
Scene ballScene(const Vec3& position, const Vec3& target) {
  Scene scene = emptyScene();
  addBody(scene, Sphere{0.1}, {}).name = "lead";
  scene.camera = cameraAt(position, target, kFieldOfView);
  scene.camera->where = "s.json:3:5 /camera";
  return scene;
}

/// The last camera of a film in which the ball is at place(time), `steps` frames up to `end` (s).
template <typename Place>
Camera cameraAfter(const Scene& scene, double end, int steps, const Place& place) {
  CameraPath path(scene);
  Camera camera;
  for (int i = 0; i <= steps; ++i) {
    const double time = end * i / steps;
    camera = path.next(time, {{Quat::Identity(), place(time)}});
  }
  return camera;
}

Vec3 atOrigin(double) {
  return Vec3::Zero();
}

/// The pixel of a point that is so far to the right, up, and ahead of a camera.
void expectSeenAt(const Camera& camera, const Vec3& point, const Vec3& rightUpAhead) {
  const Eigen::Vector2d pixel = projectToPixel(camera, point, kWidth, kHeight);
  EXPECT_NEAR(pixel.x(), kWidth / 2.0 + 180 * rightUpAhead.x() / rightUpAhead.z(), 1e-9);
  EXPECT_NEAR(pixel.y(), kHeight / 2.0 - 180 * rightUpAhead.y() / rightUpAhead.z(), 1e-9);
}

TEST(CameraPath, WithoutMotionIsTheSceneSCamera) {
  const Scene scene = ballScene({1, 2, 5}, {1, 2, 0});
  const Camera camera = cameraAfter(scene, 2, 3, [](double t) { return Vec3(t, 0, 0); });
  EXPECT_EQ(camera, *scene.camera);
  expectSeenAt(camera, {2, 3, 1}, {1, 1, 4});
}

TEST(CameraPath, LookAtKeepsTheCentreOfMassInTheMiddle) {
  Scene scene = ballScene({0, 1, 5}, {9, 9, 9});
  scene.cameraMotion.targetBody = 0;
  scene.bodies[0].massProperties.centerOfMass = {0.5, 0, 0};
  // The centre of mass is then at (4.5, 1, 0.5), its own height: the camera is level and looks along (4.5, 0, -4.5).
  const Camera camera = cameraAfter(scene, 2, 4, [](double t) { return Vec3(2 * t, t / 2, t / 4); });
  EXPECT_EQ(camera.position, Vec3(0, 1, 5));
  expectSeenAt(camera, {4.5, 1, 0.5}, {0, 0, 1});
  // As much to the right as ahead, along (1, 0, 1) / sqrt(2).
  expectSeenAt(camera, Vec3(0, 1, 5) + Vec3(1, 0, -1) * 2 + Vec3(1, 0, 1) + Vec3(0, std::sqrt(2.0), 0), {1, 1, 2});
}

TEST(CameraPath, OrbitTurnsOnceInItsPeriod) {
  Scene scene = ballScene({1, 3, 4}, {1, 1, 0});
  scene.cameraMotion.orbitPeriod = 8;
  // A quarter: what was in front (+z) of the target is now on its right (+x), seen from above counter-clockwise.
  const Camera quarter = cameraAfter(scene, 2, 7, atOrigin);
  EXPECT_NEAR((quarter.position - Vec3(5, 3, 0)).norm(), 0, 1e-14);
  EXPECT_EQ(quarter.target, Vec3(1, 1, 0));
  // The target and what is at its height, on a line with it: to the camera's right is now -z.
  expectSeenAt(quarter, {1, 1, 0}, {0, 0, 1});
  expectSeenAt(quarter, {1, 1, -1}, {1, 0, std::sqrt(20.0)});
  for (const double turns : {1.0, 3.0})
    EXPECT_NEAR((cameraAfter(scene, 8 * turns, 5, atOrigin).position - Vec3(1, 3, 4)).norm(), 0, 1e-13);
  scene.cameraMotion.orbitPeriod = -8;
  EXPECT_NEAR((cameraAfter(scene, 2, 7, atOrigin).position - Vec3(-3, 3, 0)).norm(), 0, 1e-14);
}

TEST(CameraPath, OrbitTurnsAboutUp) {
  Scene scene = ballScene({0, 4, 0}, {0, 0, 0});
  scene.camera->up = {0, 0, -1};
  scene.cameraMotion.orbitPeriod = 4;
  // About -z, +y goes to +x.
  EXPECT_NEAR((cameraAfter(scene, 1, 1, atOrigin).position - Vec3(4, 0, 0)).norm(), 0, 1e-14);
}

TEST(CameraPath, FollowIsTheClosedFormBehindABodyOfConstantVelocity) {
  Scene scene = ballScene({0, 1, 5}, {0, 1, 0});
  const double lag = 0.4, w = 2 / lag;
  scene.cameraMotion.follow = CameraMotion::Follow{0, lag};
  const Vec3 velocity(1.5, -0.5, 2);
  for (const double time : {0.1, 0.5, 1.7}) {
    // e'' + 2 w e' + w^2 e = 2 w v, e(0) = 0, e'(0) = v: e = 2 v / w - (2 / w + t) v exp(-w t).
    const Vec3 behind = velocity * (2 / w - (2 / w + time) * std::exp(-w * time));
    const Vec3 moved = velocity * time - behind;
    for (const int steps : {1, 60}) {  // of any length: the closed form goes on from frame to frame
      const Camera camera = cameraAfter(scene, time, steps, [&](double t) { return Vec3(velocity * t); });
      EXPECT_NEAR((camera.position - Vec3(0, 1, 5) - moved).norm(), 0, 1e-14);
      EXPECT_NEAR((camera.target - Vec3(0, 1, 0) - moved).norm(), 0, 1e-14);
      expectSeenAt(camera, moved + Vec3(1, 2, 1), {1, 1, 4});
    }
  }
  // In the end it is the lag behind.
  const Camera late = cameraAfter(scene, 20, 300, [&](double t) { return Vec3(velocity * t); });
  EXPECT_NEAR((late.position - Vec3(0, 1, 5) - velocity * (20 - lag)).norm(), 0, 1e-12);
}

TEST(CameraPath, FollowSolvesItsEquationForABodyThatSwings) {
  Scene scene = ballScene({0, 1, 5}, {0, 1, 0});
  scene.cameraMotion.follow = CameraMotion::Follow{0, 0.5};
  const auto swing = [](double t) { return Vec3(std::sin(3 * t), 0, 0); };
  // s'' = w^2 (c - s) - 2 w s' by small steps of the midpoint rule (error 1e-7).
  const double w = 4, step = 1e-4;
  double place = 0, speed = 0;
  for (int i = 0; i < 20000; ++i) {
    const double middle = (i + 0.5) * step;
    const double halfPlace = place + step / 2 * speed;
    const double halfSpeed = speed + step / 2 * (w * w * (swing(i * step).x() - place) - 2 * w * speed);
    place += step * halfSpeed;
    speed += step * (w * w * (swing(middle).x() - halfPlace) - 2 * w * halfSpeed);
  }
  // Between frames the body goes straight on, off by at most 9 h^2 / 8 in acceleration x h^2 / 8: 2e-5 at h = 1/240.
  EXPECT_NEAR(cameraAfter(scene, 2, 480, swing).position.x(), place, 3e-5);
}

TEST(CameraPath, FollowWithoutLagKeepsTheBodyOnItsPixel) {
  Scene scene = ballScene({0, 1, 5}, {0, 1, 0});
  scene.cameraMotion.follow = CameraMotion::Follow{0, 0};
  const auto place = [](double t) { return Vec3(std::cos(t) - 1, t * t, -t); };
  expectSeenAt(cameraAfter(scene, 1.3, 9, place), place(1.3), {0, -1, 5});
}

Scene keyedScene() {
  Scene scene = ballScene({0, 0, 9}, {0, 0, 0});
  scene.cameraMotion.keys = {{1, {0, 0, 9}, {0, 0, 0}, 1.0},
                             {2, {4, 1, 8}, {0, 0, 0}, 0.5},
                             {4, {5, 1, 2}, {1, 1, -2}, 0.5},
                             {5, {-3, 2, 7}, {1, 0, 0}, 2.0}};
  return scene;
}

using Numbers = Eigen::Matrix<double, 7, 1>;

/// Position, target, and field of view at a time, of a scene whose ball rests.
Numbers numbersAt(const Scene& scene, double time) {
  const Camera camera = cameraAfter(scene, time, 1, atOrigin);
  Numbers numbers;
  numbers << camera.position, camera.target, camera.verticalFieldOfView;
  return numbers;
}

TEST(CameraPath, KeyFramesArePassedAndHeldAtBothEnds) {
  const Scene scene = keyedScene();
  for (const CameraMotion::Key& key : scene.cameraMotion.keys) {
    const Numbers numbers = numbersAt(scene, key.time);
    EXPECT_EQ(Vec3(numbers.head<3>()), key.position);
    EXPECT_EQ(Vec3(numbers.segment<3>(3)), key.target);
    EXPECT_EQ(numbers[6], key.verticalFieldOfView);
  }
  EXPECT_EQ(numbersAt(scene, 0.2), numbersAt(scene, 1));
  EXPECT_EQ(numbersAt(scene, 99), numbersAt(scene, 5));
  expectSeenAt(cameraAfter(ballScene({1, 2, 5}, {1, 2, 0}), 1, 1, atOrigin), {2, 2, 4}, {1, 0, 1});
}

TEST(CameraPath, KeyFramesHaveAContinuousRateOfChange) {
  const Scene scene = keyedScene();
  const double h = 1e-5;
  for (const double time : {1.0, 2.0, 4.0, 5.0}) {
    const Numbers before = (numbersAt(scene, time) - numbersAt(scene, time - h)) / h;
    const Numbers after = (numbersAt(scene, time + h) - numbersAt(scene, time)) / h;
    // Differences of rates over h are below h times the greatest second derivative, 6 x 10 m / 1 s^2.
    EXPECT_LT((after - before).cwiseAbs().maxCoeff(), 60 * 2 * h) << time;
  }
  EXPECT_GT((numbersAt(scene, 2 + h) - numbersAt(scene, 2)).norm() / h, 0.1);  // passed by, not stopped at
}

TEST(CameraPath, KeyFramesAreNeverOvershot) {
  const Scene scene = keyedScene();
  for (double time = 2; time <= 4; time += 0.01) {
    const Numbers numbers = numbersAt(scene, time);
    EXPECT_GE(numbers[0], 4);
    EXPECT_LE(numbers[0], 5);
    EXPECT_EQ(numbers[1], 1);  // equal keys stand still
    EXPECT_EQ(numbers[6], 0.5);
  }
}

TEST(CameraPath, MotionsAddUp) {
  Scene scene = ballScene({0, 1, 5}, {0, 1, 0});
  scene.cameraMotion.follow = CameraMotion::Follow{0, 0};
  scene.cameraMotion.orbitPeriod = 4;
  const Camera camera = cameraAfter(scene, 1, 10, [](double t) { return Vec3(0, 0, 2 * t); });
  EXPECT_NEAR((camera.target - Vec3(0, 1, 2)).norm(), 0, 1e-14);
  EXPECT_NEAR((camera.position - Vec3(5, 1, 2)).norm(), 0, 1e-14);
}

std::string messageOf(const Scene& scene, const Vec3& place) {
  try {
    CameraPath(scene).next(0.25, {{Quat::Identity(), place}});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    return error.what();
  }
  return "";
}

TEST(CameraPath, CameraInsideABodyIsRefused) {
  Scene scene = ballScene({0, 0, 5}, {0, 0, 0});
  EXPECT_EQ(messageOf(scene, {0, 0, 4.899}), "");
  const std::string message = messageOf(scene, {0, 0, 4.901});
  EXPECT_THAT(message, HasSubstr("s.json:3:5 /camera: at 0.25 s the camera is inside body \"lead\"; allowed is"));
  // Points on either side of each surface: closed forms, and the winding number of a model.
  const auto expectSurface = [&](const Shape& shape, const Vec3& out, double reach) {
    scene.bodies[0].shape = shape;
    scene.camera->position = out * (reach - 1e-6);
    scene.camera->target = out * 9;
    EXPECT_NE(messageOf(scene, Vec3::Zero()), "");
    scene.camera->position = out * (reach + 1e-6);
    EXPECT_EQ(messageOf(scene, Vec3::Zero()), "");
  };
  expectSurface(Box{{2, 4, 6}}, Vec3::UnitZ(), 3);
  expectSurface(Cylinder{1, 2}, Vec3(0.6, 0, 0.8), 1);
  expectSurface(Capsule{1, 2}, Vec3(0.6, 0.8, 0), 1.25 * 1.28);  // (0, 1) + unit: |s (0.6, 0.8) - (0, 1)| = 1, s = 1.6
  Model model;
  for (const Vec3& corner : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
    model.solid.vertices.push_back(corner);
  model.solid.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  model.drawn.vertices = model.solid.vertices;
  scene.models = {model};
  expectSurface(ModelShape{0}, Vec3(-1, -1, -1).normalized(), 1 / std::sqrt(3.0));  // the face across from (1, 1, 1)
}

TEST(CameraPath, CameraThatComesToLookAlongUpOrAtItselfIsRefused) {
  Scene scene = ballScene({0, 3, 0}, {0, 0, 0});
  scene.cameraMotion.targetBody = 0;
  EXPECT_EQ(messageOf(scene, {1, 0, 0}), "");
  EXPECT_THAT(messageOf(scene, {0, 0, 0}), HasSubstr("looks along its up vector"));
  scene.bodies[0].shape = Plane{};
  EXPECT_THAT(messageOf(scene, {0, 3, 0}), HasSubstr("is where it looks"));
}

TEST(CameraPath, CameraOfTheStartIsCheckedBeforeAnythingMoves) {
  Scene scene = ballScene({0, 0.05, 0}, {0, 0, 5});
  EXPECT_THROW(requireUsableCamera(scene), Error);
  scene.camera->position.y() = 0.2;
  requireUsableCamera(scene);
  scene.camera.reset();
  requireUsableCamera(scene);
}

TEST(Renderer, MovingCameraDrawsTheBytesOfOneThatStandsThere) {
  Scene scene = makeCradleScene();
  const View view = viewOfStart(scene, 160, 90);
  std::vector<Camera> cameras(4, view.camera);
  cameras[1].position.x() += 0.03;
  cameras[2].position.x() += 0.12;
  cameras[3].position.x() += 0.12;  // stands still
  Renderer moving(scene, view, 160, 90);
  Frame frame = startFrame(scene);
  Image before;
  for (std::size_t number = 0; number < cameras.size(); ++number) {
    frame.states[0].position.x() += 0.01;
    const Image film = moving.render(frame, cameras[number]);
    EXPECT_NE(film, before);
    before = film;
    if (number % 2 == 0) continue;
    Renderer alone(scene, view, 160, 90);
    EXPECT_EQ(alone.render(frame, cameras[number]), film) << number;
  }
  EXPECT_LT(moving.drawnShare(), 1);  // the last one again as a change
}

}  // namespace
}  // namespace cradle
