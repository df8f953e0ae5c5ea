#include "render/occlusion_culling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kWidth = 97, kHeight = 61;  // odd: the last cells are cut

RenderSetup setupSeenFrom(const Vec3& position) {
  RenderSetup setup;
  setup.width = kWidth;
  setup.height = kHeight;
  setup.camera = cameraAt(position, {0, 0, 0}, 0.7);
  return setup;
}

/// Numbers without a pattern, the same in every run: fractions of multiples of the golden section.
class Numbers {
 public:
  double between(double low, double high) {
    fraction_ += 0.6180339887498949;
    fraction_ -= std::floor(fraction_);
    return low + (high - low) * fraction_;
  }

 private:
  double fraction_ = 0.5;
};

struct Ball {
  Vec3 center;
  double radius;
};

/// Whether the ray from the eye through a pixel's place (from the lower left corner) meets a ball nearer than `depth`.
bool isCovered(const RenderSetup& setup, double x, double y, double depth, const std::vector<Ball>& balls) {
  const Mat3 axes = cameraAxes(setup.camera);
  const double focal = kHeight / (2 * std::tan(setup.camera.verticalFieldOfView / 2));
  const Vec3 ray = axes * Vec3((x - kWidth / 2.0) / focal, (y - kHeight / 2.0) / focal, -1);  // depth 1
  for (const Ball& ball : balls) {
    const Vec3 to = ball.center - setup.camera.position;
    const double along = to.dot(ray), square = ray.squaredNorm();
    const double root = along * along - square * (to.squaredNorm() - ball.radius * ball.radius);
    if (root >= 0 && (along - std::sqrt(root)) / square < depth) return true;
  }
  return false;
}

TEST(OcclusionCulling, WhatIsHiddenHasABallBeforeEachOfItsPixels) {
  Numbers numbers;
  long hidden = 0;
  for (int scene = 0; scene < 20; ++scene) {
    const RenderSetup setup = setupSeenFrom({numbers.between(-3, 3), numbers.between(1, 4), numbers.between(4, 8)});
    std::vector<Ball> balls;
    for (int i = 0; i < 40; ++i) {
      const double x = numbers.between(-2, 2), y = numbers.between(-2, 2), z = numbers.between(-2, 3);
      balls.push_back({{x, y, z}, numbers.between(0.1, 0.8)});
    }
    OcclusionCulling occlusion(setup);
    for (const Ball& ball : balls) occlusion.add(ball.center, ball.radius);
    for (int i = 0; i < 200; ++i) {
      const int left = static_cast<int>(numbers.between(-3, kWidth)),
                bottom = static_cast<int>(numbers.between(-3, kHeight));
      const PixelRectangle pixels{left, bottom, left + 1 + static_cast<int>(numbers.between(0, 8)),
                                  bottom + 1 + static_cast<int>(numbers.between(0, 8))};
      const double nearest = numbers.between(2, 12);
      if (!occlusion.hides(pixels, nearest)) continue;
      ++hidden;
      for (int x = 4 * std::max(pixels.left, 0); x <= 4 * std::min(pixels.right, kWidth); ++x)
        for (int y = 4 * std::max(pixels.bottom, 0); y <= 4 * std::min(pixels.top, kHeight); ++y)
          ASSERT_TRUE(isCovered(setup, x / 4.0, y / 4.0, nearest, balls));
    }
  }
  EXPECT_GT(hidden, 100);  // of 4000
}

TEST(OcclusionCulling, BallHidesWhatIsBehindItsMiddleAndNotWhatIsBeforeOrBesideIt) {
  const RenderSetup setup = setupSeenFrom({0, 0, 5});
  OcclusionCulling occlusion(setup);
  const PixelRectangle middle{kWidth / 2 - 3, kHeight / 2 - 3, kWidth / 2 + 4, kHeight / 2 + 4};
  EXPECT_FALSE(occlusion.hides(middle, 100));
  occlusion.add({0, 0, 0}, 1);
  EXPECT_NEAR(occlusion.depthOf({1, 2, -3}), 8, 1e-14);
  EXPECT_TRUE(occlusion.hides(middle, 5.02));
  EXPECT_FALSE(occlusion.hides(middle, 5));
  const double radius = kHeight / (2 * std::tan(0.35)) / 5;  // pixels of the disc: 16.7
  const int inside = static_cast<int>(0.96 * radius) - 3, row = kHeight / 2;
  EXPECT_TRUE(occlusion.hides({kWidth / 2, row, kWidth / 2 + inside, row + 1}, 6));
  EXPECT_FALSE(occlusion.hides({kWidth / 2, row, kWidth / 2 + static_cast<int>(radius) + 2, row + 1}, 6));
  // The camera is inside, or the near plane may cut it: it hides nothing.
  OcclusionCulling near(setup);
  near.add({0, 0, 3.5}, 1);
  EXPECT_FALSE(near.hides(middle, 100));
}

}  // namespace
}  // namespace cradle
