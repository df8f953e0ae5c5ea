#include "render/changed_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "math/rotation.h"
#include "render/camera.h"
#include "render/mirror_image.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kTile = 8;  // pixels

/// Signed distance of a point from a convex polygon, corners counter-clockwise; > 0 outside, at least.
double outside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point) {
  double farthest = -INFINITY;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d edge = (polygon[(i + 1) % polygon.size()] - polygon[i]).normalized();
    farthest = std::max(farthest, Eigen::Vector2d(edge.y(), -edge.x()).dot(point - polygon[i]));
  }
  return farthest;
}

bool contains(const std::vector<PixelRectangle>& rectangles, int x, int y) {
  return std::any_of(rectangles.begin(), rectangles.end(),
                     [&](const PixelRectangle& r) { return r.left <= x && x < r.right && r.bottom <= y && y < r.top; });
}

/// Whether nothing is left of a tile where those of a mask are left out.
bool isSet(const TileMask& mask, int x, int y) {
  TileMask one(200, 111);
  one.add({y, {{x, x}}}, &mask);
  return one.isEmpty();
}

TEST(TileMask, ContainsEveryPixelOfAPolygonAndLittleElse) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-30, 230), size(1, 90), turn(0, 2 * M_PI);
  for (int trial = 0; trial < 50; ++trial) {
    const double x = place(random), y = place(random), a = size(random), b = size(random), angle = turn(random);
    std::vector<Eigen::Vector2d> polygon;
    for (int i = 0; i < 7; ++i) {
      const double t = 2 * M_PI * i / 7, u = a * std::cos(t), v = b * std::sin(t);
      polygon.emplace_back(x + u * std::cos(angle) - v * std::sin(angle),
                           y + u * std::sin(angle) + v * std::cos(angle));
    }
    TileMask mask(200, 111);
    mask.add(mask.spansOf(polygon));
    const std::vector<PixelRectangle> rectangles = mask.rectangles();
    double near = 0;
    for (int row = 0; row < 111; ++row)
      for (int column = 0; column < 200; ++column) {
        const double distance = outside(polygon, {column + 0.5, row + 0.5});
        if (distance <= 0) {
          EXPECT_TRUE(contains(rectangles, column, row)) << trial;
        }
        near += distance <= kTile * M_SQRT2 + 3;  // a tile's diagonal, and the margin
      }
    EXPECT_LE(mask.coverage() * 14 * 25 * kTile * kTile, near + 14 * 25) << trial;
  }
}

TEST(TileMask, RectanglesCoverTheTilesAndStayInThePicture) {
  TileMask mask(100, 50);
  mask.add({2, {{1, 3}, {1, 3}, {8, 12}}});
  const std::vector<PixelRectangle> rectangles = mask.rectangles();
  EXPECT_TRUE(contains(rectangles, 8, 16));
  EXPECT_TRUE(contains(rectangles, 99, 39));
  for (const PixelRectangle& one : rectangles) {
    EXPECT_GE(one.left, 0);
    EXPECT_LE(one.right, 100);
    EXPECT_LE(one.top, 50);
  }
  EXPECT_TRUE(TileMask(100, 50).rectangles().empty());
}

TEST(TileMask, TilesInsideAPolygonAreWhollyInItAndMany) {
  const std::vector<Eigen::Vector2d> triangle = {{13, 7}, {190, 21}, {60, 105}};
  TileMask inside(200, 111);
  inside.add(inside.spansInside(triangle));
  double within = 0;
  for (int y = 0; y < 14; ++y)
    for (int x = 0; x < 25; ++x) {
      double farthest = -INFINITY;  // of the tile's corners
      for (const double u : {kTile * x, kTile * (x + 1)})
        for (const double v : {kTile * y, kTile * (y + 1)}) farthest = std::max(farthest, outside(triangle, {u, v}));
      if (isSet(inside, x, y)) {
        EXPECT_LE(farthest, 0);
      }
      within += farthest < -3.5;  // further in than the margin of 2 pixels to each side
    }
  EXPECT_GE(inside.coverage() * 14 * 25, within);
  TileMask all(200, 111), rest(200, 111);
  all.add(all.spansOf(triangle));
  rest.add(rest.spansOf(triangle), &inside);
  EXPECT_NEAR(rest.coverage() + inside.coverage(), all.coverage(), 1e-12);
}

// A picture of a point in a ball is where the normal halves the angle between the directions to the eye and the point:
// looked for among normals all over the ball.
TEST(MirrorImage, BoundsWhereAPointIsSeenInABall) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] {
    const double x = number(random), y = number(random), z = number(random);
    return Vec3(x, y, z);
  };
  int small = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const BoundingSphere mirror{vector(), 0.2}, eye{mirror.center + 4 * vector().normalized(), 0};
    const BoundingSphere seen{mirror.center + (0.5 + std::abs(number(random))) * vector().normalized(), 0.05};
    const BoundingSphere image = imageIn(mirror, eye, seen);
    small += image.radius < 0.5 * mirror.radius;
    for (int i = 0; i < 8000; ++i) {
      const Vec3 normal = vector().normalized(), place = mirror.center + mirror.radius * normal;
      const Vec3 toEye = (eye.center - place).normalized();
      if (normal.dot(toEye) <= 0) continue;
      const Vec3 ray = 2 * normal.dot(toEye) * normal - toEye, to = seen.center - place;
      if (to.dot(ray) <= 0 || (to - to.dot(ray) * ray).norm() > seen.radius) continue;
      EXPECT_LE((place - image.center).norm(), image.radius + 1e-12) << trial;
    }
  }
  EXPECT_GT(small, 12);
}

TEST(DrawnHull, OutlineOfABallIsItsSilhouette) {
  // Points of the ball farthest in the picture to each side: with slope s, tan of the angle to the axis plus that of
  // the ball, asin(r/d).
  const Scene scene = makeSpringScene();
  View view = viewOfStart(scene, 200, 100);
  view.camera = cameraAt(Vec3(0, 0, 5), Vec3::Zero(), 1);
  const RenderSetup setup = makeRenderSetup(scene, view, std::nullopt, 200, 100);
  SphereItem ball{Vec3(1, 0, 0), 0.5};
  const auto outline = outlineOf(hullOf(ball), setup);
  ASSERT_TRUE(outline);
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : *outline) box.extend(point);
  const double pixels = 100 / (2 * std::tan(0.5)), angle = std::atan2(1, 5), half = std::asin(0.5 / std::sqrt(26.0));
  EXPECT_NEAR(box.min().x(), 100 + pixels * std::tan(angle - half), 1e-9);
  EXPECT_NEAR(box.max().x(), 100 + pixels * std::tan(angle + half), 1e-9);
  EXPECT_NEAR(box.max().y(), 50 + pixels * std::tan(std::asin(0.5 / 5)), 1e-9);
  ball.center = Vec3(0, 0, 4.6);
  EXPECT_FALSE(outlineOf(hullOf(ball), setup));  // around the camera
}

TEST(ChangedArea, NothingMovedIsACopy) {
  const Scene scene = makeCradleScene();
  Renderer renderer(scene, viewOfStart(scene, 160, 90), 160, 90);
  const Frame frame = startFrame(scene);
  const Image first = renderer.render(frame);
  EXPECT_EQ(renderer.drawnShare(), 1);
  EXPECT_EQ(renderer.render(frame), first);
  EXPECT_EQ(renderer.drawnShare(), 0);
}

/// Expects pictures in which the first body goes on by `way` (m), drawn as changes of those before, to be those drawn
/// whole.
void expectBytesOfWhole(Renderer& renderer, Frame frame, const Vec3& way) {
  renderer.render(frame);
  for (int step = 0; step < 4; ++step) {
    frame.states[0].position += way;
    const Image changed = renderer.render(frame);
    EXPECT_LT(renderer.drawnShare(), 1);
    renderer.forgetPicture();
    EXPECT_EQ(renderer.render(frame), changed) << step;
  }
}

TEST(ChangedArea, HasTheBytesOfThePictureDrawnWhole) {
  for (const Scene& scene : {makeCradleScene(), makeSpringScene()}) {
    Renderer renderer(scene, viewOfStart(scene, 320, 180), 320, 180);
    expectBytesOfWhole(renderer, startFrame(scene), {0.004, 0.003, -0.002});
  }
}

// Boxes of several heights whose front sides lie in one plane across the view: their depths are equal to the last bit,
// and which of two is seen depends on the order of drawing alone. A rod before their upper ends lets many small areas
// be drawn next to each other.
TEST(ChangedArea, HasTheBytesOfThePictureDrawnWholeWhereDepthsAreEqual) {
  Scene scene = emptyScene();
  scene.materials.resize(2, scene.materials[0]);
  scene.materials[1].baseColor = Vec3f(0.9f, 0.1f, 0.1f);
  addBody(scene, Box{{3, 2, 0.2}}, {Quat::Identity(), {0, 0, -0.1}}, Motion::fixed);
  constexpr int kBoxes = 120;
  const double slope = std::tan(0.5);
  for (int i = 0; i < kBoxes; ++i) {
    const double place = 2.4 * (static_cast<double>(i) / kBoxes - 0.5), top = slope * place + 0.02 * ((i * 7) % 11 - 5);
    Body& box = addBody(scene, Box{{0.015, 0.8, 0.2}}, {Quat::Identity(), {place, top - 0.4, -0.1}}, Motion::fixed);
    box.material = 1;
  }
  addBody(scene, Cylinder{0.005, 3}, {rotationAbout(Vec3::UnitZ(), 0.5 - M_PI / 2), {0, 0.055, 0.1}});
  const View view{cameraAt({0, 0, 5}, Vec3::Zero(), 0.4), Bounds(Vec3(-1.5, -1, -0.2), Vec3(1.5, 1, 1))};
  Renderer renderer(scene, view, 640, 360);
  expectBytesOfWhole(renderer, startFrame(scene), {0, 0.011, 0});
}

// What moves outside the picture, and throws its shadow on nothing that is seen, changes no pixel; but what comes into
// its shadow later does.
TEST(ChangedArea, ShadowsOfWhatMovedUnseenAreThereLater) {
  Scene scene = emptyScene();
  scene.lights[0].direction = Vec3(0, -1, 0);
  addBody(scene, Sphere{0.3}, {Quat::Identity(), {-0.6, 1.5, 0}});
  addBody(scene, Sphere{0.2}, {Quat::Identity(), {0.2, 0, 0}});
  const View view{cameraAt({0, 0, 5}, Vec3::Zero(), 0.2), Bounds(Vec3(-1, -1, -1), Vec3(1, 2, 1))};
  Renderer renderer(scene, view, 320, 180);
  Frame frame = startFrame(scene);
  renderer.render(frame);
  frame.states[0].position = Vec3(-0.5, 1.5, 0);
  renderer.render(frame);
  EXPECT_EQ(renderer.drawnShare(), 0);
  frame.states[1].position = Vec3(-0.02, 0, 0);
  const Image changed = renderer.render(frame);
  renderer.forgetPicture();
  EXPECT_EQ(renderer.render(frame), changed);
}

}  // namespace
}  // namespace cradle
