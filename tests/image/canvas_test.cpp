#include "image/canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "image/test_pictures.h"

namespace cradle {
namespace {

const Ink kWhite{{255, 255, 255}, 1};

double linearFromLevel(int level) {
  const double c = level / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Linear light in a picture, in white pixels.
double lightIn(const Image& image) {
  double light = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) light += linearFromLevel(image.pixels[i]);
  return light;
}

/// Whether two pictures are alike outside of columns and rows [left, right) x [top, bottom).
bool isAlikeOutside(const Image& a, const Image& b, const std::array<int, 4>& box) {
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const bool isInside = x >= box[0] && x < box[2] && y >= box[1] && y < box[3];
      if (!isInside && !std::equal(a.at(x, y), a.at(x, y) + 3, b.at(x, y))) return false;
    }
  return true;
}

TEST(Canvas, MixesInLinearLight) {
  Image image(4, 1);
  Canvas canvas(image);
  canvas.rectangle({1, 0}, {2.5, 1}, 0, kWhite);
  // Half of the light of white is sRGB 0.7354 (188), not 0.5.
  EXPECT_EQ(std::vector<std::uint8_t>(image.pixels.begin(), image.pixels.end()),
            (std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255, 188, 188, 188, 0, 0, 0}));
  canvas.blend(3, 0, 1, {{255, 0, 255}, 0.5});
  EXPECT_EQ(image.at(3, 0)[0], 188);
  EXPECT_EQ(image.at(3, 0)[1], 0);
}

TEST(Canvas, InkOfItsOwnColorAndNoInkLeaveAPictureAsItIs) {
  const Image before = makeTestPicture(40, 30, 7);
  Image image = before;
  Canvas canvas(image);
  canvas.disc({20, 15}, 9, {{1, 2, 3}, 0});
  EXPECT_EQ(image, before);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      canvas.blend(x, y, 0.37, {{before.at(x, y)[0], before.at(x, y)[1], before.at(x, y)[2]}, 1});
  EXPECT_EQ(image, before);
}

TEST(Canvas, AreasAreThoseOfTheShapes) {
  // Coverage by distance misses an edge's area by less than 1 % of its length; levels by 1 / 512 of an edge's pixels.
  const auto areaOf = [](const auto& draw) {
    Image image(64, 64);
    Canvas canvas(image);
    draw(canvas);
    return lightIn(image);
  };
  EXPECT_NEAR(areaOf([](Canvas& c) { c.disc({31.3, 30.8}, 20, kWhite); }), 400 * std::numbers::pi, 1.3);
  EXPECT_NEAR(areaOf([](Canvas& c) { c.rectangle({10.5, 20.25}, {50.25, 41}, 0, kWhite); }), 39.75 * 20.75, 0.6);
  EXPECT_NEAR(areaOf([](Canvas& c) {
                c.rectangle({10, 20}, {50, 40}, 5, kWhite);
              }),
              800 - (4 - std::numbers::pi) * 25, 0.6);
  for (const bool isTurned : {false, true})
    EXPECT_NEAR(areaOf([&](Canvas& c) {
                  c.triangle({PicturePoint{10, 10}, isTurned ? PicturePoint{20, 50} : PicturePoint{50, 20},
                              isTurned ? PicturePoint{50, 20} : PicturePoint{20, 50}},
                             kWhite);
                }),
                (40 * 40 - 10 * 10) / 2.0, 2);
  // A line is a rectangle with two half discs; a thin one has less light, not less width.
  const std::vector<PicturePoint> ends = {{12, 14}, {42, 54}};
  for (const double width : {0.3, 1.0, 6.0}) {
    const double area = areaOf([&](Canvas& c) { c.line({{ends[0], width}, {ends[1], width}}, kWhite); });
    EXPECT_NEAR(area, 50 * width + std::numbers::pi * width * std::max(width, 1.0) / 4, 0.02 * 100 * width) << width;
  }
}

TEST(Canvas, LinesWidthAndOpacityChangeEvenlyOnItsWay) {
  // 50 pixels from the middle of one half disc to that of the other.
  const auto lightOf = [](const LinePoint& from, const LinePoint& to) {
    Image image(64, 64);
    Canvas(image).line({from, to}, kWhite);
    return lightIn(image);
  };
  const PicturePoint start{12, 14}, end{42, 54};
  // The sides of a line that grows by 2 pixels on either side are 0.1 % longer than it, its half discs as little off.
  EXPECT_NEAR(lightOf({start, 2}, {end, 6}), 50 * 4 + std::numbers::pi * (1 + 9) / 2, 2);
  EXPECT_NEAR(lightOf({start, 6, 1}, {end, 6, 0}), 50 * 6 * 0.5 + std::numbers::pi * 9 / 2, 2);
}

TEST(Canvas, LineOfTwoPiecesIsThatOfOne) {
  Image whole(40, 40), pieces(40, 40);
  Canvas(whole).line({{{5, 5}, 6}, {{35, 25}, 6}}, kWhite);
  Canvas(pieces).line({{{5, 5}, 6}, {{20, 15}, 6}, {{35, 25}, 6}}, kWhite);
  for (std::size_t i = 0; i < whole.pixels.size(); ++i) EXPECT_NEAR(whole.pixels[i], pieces.pixels[i], 1);
}

TEST(Canvas, LineCoversNoMoreThanOnceWhereItCrossesItself) {
  Image once(40, 40), twice(40, 40);
  const Ink half{{255, 255, 255}, 0.5};
  Canvas(once).line({{{5, 5}, 4}, {{30, 25}, 4}}, half);
  Canvas(twice).line({{{5, 5}, 4}, {{30, 25}, 4}, {{5, 5}, 4}, {{30, 25}, 4}}, half);
  EXPECT_EQ(once, twice);
}

TEST(Canvas, LineKnowsNothingOfThoseBefore) {
  Image one(40, 40), two(40, 40);
  const Ink half{{255, 255, 255}, 0.5};
  Canvas canvas(one);
  for (int i = 0; i < 2; ++i) {
    canvas.line({{{5, 5}, 4}, {{30, 25}, 4}}, half);
    Canvas(two).line({{{5, 5}, 4}, {{30, 25}, 4}}, half);
  }
  EXPECT_EQ(one, two);
}

TEST(Canvas, ShapesLeaveTheRestAlone) {
  const Image before = makeTestPicture(80, 60, 3);
  Image image = before;
  Canvas canvas(image);
  canvas.disc({20, 20}, 5, kWhite);
  canvas.rectangle({15, 30}, {25, 34}, 2, kWhite);
  canvas.triangle({PicturePoint{15, 40}, PicturePoint{25, 40}, PicturePoint{20, 45}}, kWhite);
  canvas.line({{{17, 52}, 4}, {{23, 50}, 2}}, kWhite);
  EXPECT_NE(image, before);
  EXPECT_TRUE(isAlikeOutside(image, before, {15, 15, 25, 55}));
}

TEST(Canvas, WhatLiesOutsideIsLeftOut) {
  Image image(20, 10);
  Canvas canvas(image);
  canvas.disc({-50, 5}, 20, kWhite);
  canvas.line({{{-1e9, -1e9}, 3}, {{-5, 30}, 3}}, kWhite);
  canvas.rectangle({30, -20}, {90, 90}, 3, kWhite);
  EXPECT_EQ(image, Image(20, 10));
  canvas.line({{{-1e6, 5}, 2}, {{1e6, 5}, 2}}, kWhite);
  EXPECT_NEAR(lightIn(image), 40, 0.1);
}

}  // namespace
}  // namespace cradle
