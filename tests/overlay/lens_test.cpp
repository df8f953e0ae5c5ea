#include "overlay/lens.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr int kWidth = 240, kHeight = 100;
constexpr int kMiddle = 50;  // the edge of rows along which arrows go to the right
const Ink kRed{{255, 0, 0}, 1};

Image arrow(double tail, double tip, double thickness, const Ink& ink = kRed) {
  Image image(kWidth, kHeight);
  Canvas canvas(image);
  drawArrow(canvas, {tail, kMiddle}, {tip, kMiddle}, thickness, ink);
  return image;
}

/// The level of light that is `share` of all (IEC 61966-2-1).
double levelOf(double share) {
  return 255 * (1.055 * std::pow(share, 1 / 2.4) - 0.055);
}

/// Half of it or more, the rest of it light edge.
bool isInk(const std::uint8_t* pixel) {
  return pixel[0] > 200 && pixel[1] <= levelOf(0.75 / 2);
}

bool isEdge(const std::uint8_t* pixel) {
  return pixel[1] > 200 && pixel[2] > 200;
}

/// Pixels of a column that are of the ink, or of the light edge.
template <typename IsOne>
int countInColumn(const Image& image, int x, const IsOne& isOne) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) count += isOne(image.at(x, y));
  return count;
}

// The head is 4.2 thicknesses of the shaft long and 3.6 wide.
TEST(Arrow, HeadHasTheSizeThatGoesWithItsShaft) {
  const Image image = arrow(20, 220, 10);
  EXPECT_EQ(countInColumn(image, 100, isInk), 10);
  EXPECT_EQ(countInColumn(image, 177, isInk), 10);  // 42.5 pixels before its tip
  EXPECT_EQ(countInColumn(image, 178, isInk), 36);  // 41.5: 17.8 to either side
  EXPECT_EQ(countInColumn(image, 198, isInk), 18);  // 21.5: 9.2
  EXPECT_EQ(countInColumn(image, 222, isInk), 0);
}

// Shorter than its head, 42 pixels long, it is all head, in its proportions: that of a thinner arrow.
TEST(Arrow, ShrinksAsAWholeWhereItIsShorterThanItsHead) {
  EXPECT_EQ(arrow(100, 121, 10), arrow(100, 121, 5));
  const Image image = arrow(100, 121, 10);
  EXPECT_EQ(countInColumn(image, 100, isInk), 18);  // 8.8 to either side, 20.5 before the tip
  EXPECT_EQ(countInColumn(image, 111, isInk), 8);   // 4.1, 9.5
  for (int x = 0; x < 90; ++x) EXPECT_EQ(countInColumn(image, x, [](auto* pixel) { return pixel[0] > 0; }), 0) << x;
}

TEST(Arrow, ShorterThanTwoThicknessesIsNotDrawn) {
  EXPECT_EQ(arrow(100, 119.9, 10), Image(kWidth, kHeight));
  EXPECT_NE(arrow(100, 120.1, 10), Image(kWidth, kHeight));
}

// 0.45 thicknesses of white all around it, three quarters as opaque as the ink, and less with its square.
TEST(Arrow, HasALightEdge) {
  const Image image = arrow(20, 220, 10);
  for (const int x : {30, 100, 170}) {
    for (const int row : {-9, -7, 6, 8}) {
      const auto* pixel = image.at(x, kMiddle + row);
      for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(pixel[channel], levelOf(0.75), 1) << x << " " << row;
    }
    for (const int row : {-11, 10}) EXPECT_EQ(image.at(x, kMiddle + row)[1], 0);
    EXPECT_EQ(countInColumn(image, x, isInk), 10);
  }
  // Ahead of the head, behind the tail, and along the head's sides.
  EXPECT_TRUE(isEdge(image.at(225, 50)));
  EXPECT_TRUE(isEdge(image.at(12, 50)));
  EXPECT_GE(countInColumn(image, 198, isEdge), 6);

  const Image faint = arrow(20, 220, 10, {{255, 0, 0}, 0.5});
  EXPECT_NEAR(faint.at(100, 43)[2], levelOf(0.75 * 0.25), 1);
}

// What is nearer than a fiftieth of the way to the target may be anywhere in the picture.
TEST(Lens, SeesWhatIsClearlyBeforeTheCamera) {
  Lens lens;
  lens.camera.position = {0, 0, 6};
  lens.camera.target = {0, 0, 0};
  lens.camera.verticalFieldOfView = M_PI / 2;
  lens.width = kWidth, lens.height = kHeight;
  for (const double depth : {0.1201, 1.0, 6.0, 100.0}) {
    // Half the height is as far as the depth.
    const auto place = lens.see({0.5 * depth, -0.25 * depth, 6 - depth});
    ASSERT_TRUE(place) << depth;
    EXPECT_NEAR(place->x, kWidth / 2 + 0.5 * kHeight / 2, 1e-9);
    EXPECT_NEAR(place->y, kHeight / 2 + 0.25 * kHeight / 2, 1e-9);
  }
  for (const double depth : {0.1199, 0.001, 0.0, -1.0}) EXPECT_FALSE(lens.see({0, 0, 6 - depth})) << depth;
  lens.camera.target = {0, 0, 5};
  EXPECT_TRUE(lens.see({0, 0, 6 - 0.0201}));
  EXPECT_FALSE(lens.see({0, 0, 6 - 0.0199}));
}

}  // namespace
}  // namespace cradle
