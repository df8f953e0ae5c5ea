#include "render/frame_layout.h"

#include <gtest/gtest.h>

#include <numbers>

#include "math/rotation.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kWidth = 160, kHeight = 90;

Box2 box(double left, double bottom, double right, double top) {
  return {Eigen::Vector2d(left, bottom), Eigen::Vector2d(right, top)};
}

const Box2 kHome = box(-4, 6, 4, 14);

TEST(MapPlace, IsHomeWhereThatHoldsAll) {
  EXPECT_EQ(placeAround({}, kHome, 0), MapPlace());
  EXPECT_EQ(placeAround(box(-4, 6, 4, 14), kHome, 0), MapPlace());
  EXPECT_EQ(placeAround(box(3, 13, 3.5, 14), kHome, 0), MapPlace());
}

TEST(MapPlace, MovesByTheFewestQuarters) {
  EXPECT_EQ(placeAround(box(3, 7, 5, 8), kHome, 0), (MapPlace{0, {1, 0}}));      // -2..6
  EXPECT_EQ(placeAround(box(-9, 4, -3, 6), kHome, 0), (MapPlace{0, {-3, -1}}));  // -10..-2, 4..12
  EXPECT_EQ(placeAround(box(99, 7, 100, 8), kHome, 0), (MapPlace{0, {48, 0}}));  // 92..100
}

TEST(MapPlace, GrowsByPowersOfTwoAroundItsMiddle) {
  EXPECT_EQ(placeAround(box(-4.1, 7, 4, 8), kHome, 0), (MapPlace{1, {0, 0}}));   // -8..8
  EXPECT_EQ(placeAround(box(-3, 7, 11, 8), kHome, 0), (MapPlace{1, {1, 0}}));    // -4..12
  EXPECT_EQ(placeAround(box(-30, 7, 30, 8), kHome, 0), (MapPlace{3, {0, 0}}));   // -32..32
  EXPECT_EQ(placeAround(box(-30, 7, 999, 8), kHome, 0), (MapPlace{3, {0, 0}}));  // too large for any
}

// At home a border of a tenth leaves -3.2..3.2, and -6.4..6.4 where it is twice as large.
TEST(MapPlace, LeavesItsBorderClearInPartsOfItsOwnSize) {
  EXPECT_EQ(placeAround(box(-3.2, 7, 3.2, 8), kHome, 0.1), MapPlace());
  EXPECT_EQ(placeAround(box(-3.3, 7, 3.2, 8), kHome, 0.1), (MapPlace{1, {0, 0}}));
  EXPECT_EQ(placeAround(box(-6.3, 7, 6.3, 8), kHome, 0.1), (MapPlace{1, {0, 0}}));
  EXPECT_EQ(placeAround(box(-6.5, 7, 6.4, 8), kHome, 0.1), (MapPlace{2, {0, 0}}));
}

/// A ball half a metre over the ground in slanting light, its shadow as far beside it.
Scene ballOverGround() {
  Scene scene = emptyScene();
  addBody(scene, Sphere{0.2}, {Quat::Identity(), {0, 0.5, 0}});
  addBody(scene, Plane{}, {}, Motion::fixed);
  scene.lights[0].direction = Vec3(-1, -1, 0).normalized();
  scene.camera = cameraAt({0, 3, 3}, {0, 0, 0}, 0.7);
  return scene;
}

Frame frameAt(const Scene& scene, const Vec3& place) {
  Frame frame = startFrame(scene);
  frame.states[0].position = place;
  return frame;
}

Camera cameraBeside(const Scene& scene, const Vec3& way) {
  Camera camera = *scene.camera;
  camera.position += way;
  camera.target += way;
  return camera;
}

int greenAt(const Image& image, const Camera& camera, const Vec3& point) {
  const Eigen::Vector2d pixel = projectToPixel(camera, point, kWidth, kHeight);
  return image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()))[1];
}

// The height of the picture is 3 m where the ball starts, and the map 2.6 times as wide.
TEST(FrameLayout, ShadowsAreThereHoweverFarThingsGo) {
  const Scene scene = ballOverGround();
  Renderer renderer(scene, viewOfStart(scene, kWidth, kHeight), kWidth, kHeight);
  for (const double x : {0.0, 3.0, 5.0, -7.0, 40.0, 1000.0}) {
    const Vec3 way(x, 0, -x / 2);
    const Camera camera = cameraBeside(scene, way);
    const Image image = renderer.render(frameAt(scene, way + Vec3(0, 0.5, 0)), camera);
    const int lit = greenAt(image, camera, way + Vec3(0.5, 0, 0)),
              dark = greenAt(image, camera, way + Vec3(-0.5, 0, 0));
    EXPECT_LT(dark, 0.8 * lit) << x;
  }
}

TEST(FrameLayout, ChangesHaveTheBytesOfThePictureDrawnWholeWhereMapsMove) {
  const Scene scene = ballOverGround();
  const View view = viewOfStart(scene, kWidth, kHeight);
  Renderer changing(scene, view, kWidth, kHeight), whole(scene, view, kWidth, kHeight);
  int drawnWhole = 0;
  for (int step = 0; step < 40; ++step) {  // out of the picture, over its ground, and high above
    const Frame frame = frameAt(scene, Vec3(0.1 * step, 0.5 + 0.02 * step, -0.3 * step));
    const Image image = changing.render(frame);
    drawnWhole += changing.drawnShare() == 1;
    whole.forgetPicture();
    EXPECT_EQ(whole.render(frame), image) << step;
  }
  EXPECT_GT(drawnWhole, 2);   // places did change
  EXPECT_LT(drawnWhole, 25);  // 12 m are 10 quarters of the shaded ground, 6 of the shadow map; and the near plane
}

// A second ball goes away until the map has to be larger, some 13.6 m, and comes back: at the same places, the same
// pictures. The border of the larger map, 10 texels of it, would make up a decimetre.
TEST(FrameLayout, FollowsFromItsFrameAlone) {
  Scene scene = ballOverGround();
  addBody(scene, Sphere{0.2}, {Quat::Identity(), {0, 0.5, 1}});
  Renderer film(scene, viewOfStart(scene, kWidth, kHeight), kWidth, kHeight);
  const auto pictureAt = [&](int step) {
    Frame frame = startFrame(scene);
    frame.states[1].position.x() = 12.6 + 0.02 * step;
    return film.render(frame);
  };
  constexpr int kSteps = 100;
  std::vector<Image> away;
  int drawnWhole = 0;
  for (int step = 0; step < kSteps; ++step) {
    away.push_back(pictureAt(step));
    drawnWhole += film.drawnShare() == 1;
  }
  EXPECT_GT(drawnWhole, 1);  // besides the first
  for (int step = kSteps - 1; step >= 0; --step)
    EXPECT_EQ(pictureAt(step), away[static_cast<std::size_t>(step)]) << step;
}

// A wall wider than the shadow map, 16 mm before the camera, is not cut off: it hides the ball and the ground.
TEST(FrameLayout, LargeThingsNearTheCameraAreSeen) {
  Scene scene = ballOverGround();
  const View view = viewOfStart(scene, kWidth, kHeight);
  scene.lights[0].direction = Vec3(-1, -0.3, 0.4).normalized();  // the wall throws no shadow onto what it hides
  const Camera& camera = *scene.camera;
  const auto contrast = [&](const Image& image) {  // beside the ball's shadow, and in it
    return greenAt(image, camera, {0.5, 0, 0}) - greenAt(image, camera, {-0.5 / 0.3, 0, 0.2 / 0.3});
  };
  EXPECT_GT(contrast(Renderer(scene, view, kWidth, kHeight).render(startFrame(scene))), 20);
  addBody(scene, Box{Vec3(40, 0.01, 40)}, {rotationAbout(Vec3::UnitX(), std::numbers::pi / 4), {0, 2.985, 2.985}},
          Motion::fixed);
  EXPECT_LT(std::abs(contrast(Renderer(scene, view, kWidth, kHeight).render(startFrame(scene)))), 5);
}

// What is seen from nearer is not cut off: the near plane is before everything.
TEST(FrameLayout, ThingsThatComeNearTheCameraAreSeen) {
  const Scene scene = ballOverGround();
  const View view = viewOfStart(scene, kWidth, kHeight);
  Renderer renderer(scene, view, kWidth, kHeight);
  const Vec3 towards = scene.camera->position.normalized();
  const Vec3 place = scene.camera->position - 0.23 * towards;  // its surface 3 cm before the eye
  const Image image = renderer.render(frameAt(scene, place));
  const Image far = renderer.render(frameAt(scene, Vec3(0, 0.5, 300)));
  EXPECT_NE(image.at(kWidth / 2, kHeight / 2)[1], far.at(kWidth / 2, kHeight / 2)[1]);
}

}  // namespace
}  // namespace cradle
