#include "render/changed_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/camera.h"
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

TEST(DrawnHull, OutlineOfABallIsItsSilhouette) {
  // Points of the ball farthest in the picture to each side: with slope s, tan of the angle to the axis plus that of
  // the ball, asin(r/d).
  const Scene scene = makeSpringScene();
  View view = viewOfStart(scene, 200, 100);
  view.camera = cameraAt(Vec3(0, 0, 5), Vec3::Zero(), 1);
  const Stage stage = makeStage(scene, view, std::nullopt, 200, 100);
  SphereItem ball{Vec3(1, 0, 0), 0.5};
  const auto outline = outlineOf(hullOf(ball), stage);
  ASSERT_TRUE(outline);
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : *outline) box.extend(point);
  const double pixels = 100 / (2 * std::tan(0.5)), angle = std::atan2(1, 5), half = std::asin(0.5 / std::sqrt(26.0));
  EXPECT_NEAR(box.min().x(), 100 + pixels * std::tan(angle - half), 1e-9);
  EXPECT_NEAR(box.max().x(), 100 + pixels * std::tan(angle + half), 1e-9);
  EXPECT_NEAR(box.max().y(), 50 + pixels * std::tan(std::asin(0.5 / 5)), 1e-9);
  ball.center = Vec3(0, 0, 4.6);
  EXPECT_FALSE(outlineOf(hullOf(ball), stage));  // around the camera
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

TEST(ChangedArea, HasTheBytesOfThePictureDrawnWhole) {
  for (const Scene& scene : {makeCradleScene(), makeSpringScene()}) {
    Renderer renderer(scene, viewOfStart(scene, 320, 180), 320, 180);
    Frame frame = startFrame(scene);
    renderer.render(frame);
    for (int step = 0; step < 5; ++step) {
      frame.states[0].position += Vec3(0.004, 0.003, -0.002);
      const Image changed = renderer.render(frame);
      EXPECT_LT(renderer.drawnShare(), 1);
      renderer.forgetPicture();
      EXPECT_EQ(renderer.render(frame), changed) << step;
    }
  }
}

}  // namespace
}  // namespace cradle
