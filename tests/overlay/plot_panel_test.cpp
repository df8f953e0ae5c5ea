#include "overlay/plot_panel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "image/font.h"

namespace cradle {
namespace {

constexpr int kWidth = 640, kHeight = 360;
const Ink kRed{{255, 0, 0}, 1}, kGreen{{0, 255, 0}, 1};

/// A wave and a line over 4 s.
PlotContent waveAndLine() {
  PlotContent content{"height (m)", {}, {{"wave", {}, kRed}, {"line", {}, kGreen}}};
  for (int i = 0; i <= 240; ++i) {
    const double time = i / 60.0;
    content.times.push_back(time);
    content.curves[0].values.push_back(std::sin(2 * time));
    content.curves[1].values.push_back(time / 4);
  }
  return content;
}

Image drawn(const PlotContent& content, std::size_t now, int width = kWidth, int height = kHeight) {
  Image image(width, height);
  Canvas canvas(image);
  drawPlot(canvas, content, now);
  return image;
}

std::vector<int> pixelAt(const Image& image, const PicturePoint& place) {
  const auto* pixel = image.at(static_cast<int>(std::floor(place.x)), static_cast<int>(std::floor(place.y)));
  return {pixel[0], pixel[1], pixel[2]};
}

TEST(PlotPanel, CurvesPassThroughTheirPixelsUpToNow) {
  const PlotArea area = plotAreaOf(waveAndLine(), kWidth, kHeight);
  const Image image = drawn(waveAndLine(), 150);
  const auto colored = [&](double time, double value, std::size_t channel) {
    // Linear maps: the whole film from side to side; the values' range with 6 % above and below (line: 0..1, wave
    // -1..1).
    const double x = area.left + (area.right - area.left) * time / 4;
    const double y = area.bottom - (area.bottom - area.top) * (value + 1.12) / 2.24;
    const auto pixel = pixelAt(image, {x, y});
    return pixel[channel] > 200 && pixel[1 - channel] < 100;
  };
  for (const double time : {0.1, 0.5, 1.2, 1.8, 2.4}) {
    EXPECT_TRUE(colored(time, std::sin(2 * time), 0)) << time;
    EXPECT_FALSE(colored(time, std::sin(2 * time) + 0.3, 0)) << time;
    EXPECT_FALSE(colored(time, std::sin(2 * time) - 0.3, 0)) << time;
  }
  for (const double time : {0.3, 1.1, 2.2}) EXPECT_TRUE(colored(time, time / 4, 1)) << time;
  for (const double time : {2.7, 3.5}) EXPECT_FALSE(colored(time, std::sin(2 * time), 0) || colored(time, time / 4, 1));
}

TEST(PlotPanel, HasATitleNamesAndRules) {
  const PlotArea area = plotAreaOf(waveAndLine(), kWidth, kHeight);
  const Image image = drawn(waveAndLine(), 150);
  const auto [low, high] = plotPanelAt(PlotCorner::upperRight, 0, kWidth, kHeight);
  bool hasTitle = false, hasName = false;
  for (double y = low.y; y < area.top - 1; ++y)
    for (double x = low.x; x < high.x; ++x) {
      const auto pixel = pixelAt(image, {x, y});
      hasTitle |= x < area.left && pixel[0] > 200 && pixel[1] > 200;
      hasName |= x > area.left && pixel[1] > 180 && pixel[0] < 60;
    }
  EXPECT_TRUE(hasTitle);
  EXPECT_TRUE(hasName);
  const PicturePoint rule = area.at(3.7, 0.5);  // after the curves' end
  EXPECT_GT(pixelAt(image, {rule.x, std::round(rule.y)})[0], pixelAt(image, {rule.x, rule.y + 5})[0] + 40);
}

// Of three times the line's width, 0.42 % of the picture's height: 4.5 pixels around the end, where the line is 1.5
// above and below.
TEST(PlotPanel, CurvesEndInADot) {
  const PlotArea area = plotAreaOf(waveAndLine(), 1280, 720);
  const Image image = drawn(waveAndLine(), 150, 1280, 720);
  const auto isGreen = [&](double time, double x, double y) {
    const PicturePoint on = area.at(time, time / 4);
    const auto pixel = pixelAt(image, {on.x + x, on.y + y});
    return pixel[1] > 200 && pixel[0] < 100;
  };
  for (const double way : {-1.0, 1.0}) {
    EXPECT_TRUE(isGreen(2.5, 0, 3.4 * way));
    EXPECT_FALSE(isGreen(2.5, 0, 6 * way));
    EXPECT_FALSE(isGreen(1.2, 0, 3.4 * way));
  }
  EXPECT_TRUE(isGreen(2.5, 3.4, 0));
  EXPECT_FALSE(isGreen(2.5, 6, 0));
}

// As in a plot of energies: nothing is below 0, but for the room below the curve. Numbers end 0.4 em before the curves.
TEST(PlotPanel, ZeroHasNoSign) {
  const PlotContent content{"", {0, 1}, {{"", {0, 1}, kRed}}};
  const PlotArea area = plotAreaOf(content, 1280, 720);
  const Image image = drawn(content, 1, 1280, 720);
  const TextSize size = crispTextSize(0.028 * 720);
  const double end = area.left - 0.4 * size.em, start = end - textWidth("0", size), row = std::round(area.at(0, 0).y);
  const auto brightest = [&](double from, double to) {
    int most = 0;
    for (double x = from; x < to; ++x)
      for (double y = row - size.ascent / 2; y < row + size.ascent / 2; ++y)
        most = std::max(most, pixelAt(image, {x, y})[1]);
    return most;
  };
  EXPECT_GT(brightest(start, end), 200);
  EXPECT_LT(brightest(start - 2 * size.em, start - 1), 60);
}

/// The panel takes the upper right corner, and nothing is drawn beside it.
void expectPanel(const PlotContent& content, int width, int height) {
  const Image image = drawn(content, content.times.size() - 1, width, height);
  int left = width, top = height, right = 0, bottom = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (image.at(x, y)[0] + image.at(x, y)[1] + image.at(x, y)[2] > 0) {
        left = std::min(left, x), right = std::max(right, x + 1);
        top = std::min(top, y), bottom = std::max(bottom, y + 1);
      }
  const double edge = std::round(0.03 * height);
  EXPECT_EQ(right, width - edge);
  EXPECT_EQ(top, edge);
  EXPECT_EQ(bottom, edge + std::round(0.3 * height));
  EXPECT_NEAR(right - left, std::min(0.62 * height, width - 0.06 * height), 1);
}

TEST(PlotPanel, LiesInTheUpperRightCornerAndLeavesTheRestAlone) {
  for (const auto& [width, height] : {std::pair(1280, 720), std::pair(640, 360), std::pair(300, 600)})
    expectPanel(waveAndLine(), width, height);
}

/// Numbers with an exponent are wider than others: the curves begin further to the right.
TEST(PlotPanel, WideNumbersStayInIt) {
  PlotContent content = waveAndLine();
  for (PlotCurve& curve : content.curves)
    for (double& value : curve.values) value *= 1.7e-5;
  const PlotArea usual = plotAreaOf(waveAndLine(), kWidth, kHeight), wide = plotAreaOf(content, kWidth, kHeight);
  EXPECT_GT(wide.left, usual.left);
  EXPECT_EQ(wide.right, usual.right);
  expectPanel(content, kWidth, kHeight);
}

/// The columns (pixels) of the row of times in which something light is drawn, as runs that are less than `gap` apart.
std::vector<std::pair<int, int>> timesOf(const PlotContent& content, int gap) {
  const Image image = drawn(content, 0);
  const PlotArea area = plotAreaOf(content, kWidth, kHeight);
  const int first = static_cast<int>(area.bottom) + 3, last = first + 8;
  std::vector<std::pair<int, int>> runs;
  for (int x = 0; x < kWidth; ++x) {
    bool isLight = false;
    for (int y = first; y < last; ++y) isLight = isLight || image.at(x, y)[0] > 150;
    if (!isLight) continue;
    if (runs.empty() || x - runs.back().second > gap) runs.emplace_back(x, x);
    runs.back().second = x;
  }
  return runs;
}

/// 0.04 would run into "0.05 s": it is left out, like what stands too near to others of any film.
TEST(PlotPanel, TimesDoNotRunIntoEachOther) {
  for (const double duration : {0.051, 0.055, 1.0, 2.2, 9.9, 42.0, 810.3, 1234.5}) {
    PlotContent content = waveAndLine();
    for (double& time : content.times) time *= duration / 4;
    const TextSize text = crispTextSize(0.028 * kHeight);
    const int gap = static_cast<int>(0.45 * text.em);
    const auto runs = timesOf(content, gap);
    EXPECT_GE(runs.size(), 3u) << duration;
    const double widest = textWidth("0.0000 s", text);
    for (const auto& [begin, end] : runs) EXPECT_LT(end - begin, widest) << duration;
  }
}

TEST(PlotPanel, CornersAreThoseOfThePicture) {
  using Ends = std::pair<PicturePoint, PicturePoint>;
  const auto isAt = [](const Ends& ends, double left, double top) {
    return ends.first.x == left && ends.first.y == top && ends.second.x == left + 446 && ends.second.y == top + 216;
  };
  EXPECT_TRUE(isAt(plotPanelAt(PlotCorner::upperRight, 0, 1280, 720), 1280 - 22 - 446, 22));
  EXPECT_TRUE(isAt(plotPanelAt(PlotCorner::lowerRight, 0, 1280, 720), 1280 - 22 - 446, 720 - 22 - 216));
  EXPECT_TRUE(isAt(plotPanelAt(PlotCorner::lowerLeft, 0, 1280, 720), 22, 720 - 22 - 216));
}

TEST(PlotPanel, ValuesThatNeverChangeAreDrawn) {
  for (const double value : {0.0, 5.0, -1e-9}) {
    const PlotContent content{"c", {0, 1, 2}, {{"", {value, value, value}, kRed}}};
    const PlotArea area = plotAreaOf(content, kWidth, kHeight);
    EXPECT_GT(pixelAt(drawn(content, 2), area.at(1, value))[0], 200) << value;
  }
  drawn({"one frame", {0}, {{"", {1}, kRed}}}, 0);
}

TEST(PlotPanel, RoundNumbersAreOneTwoOrFiveTimesAPowerOfTenApart) {
  EXPECT_THAT(roundNumbers(0, 10, 5), testing::ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(roundNumbers(-0.011, 0.19, 4), testing::ElementsAre(0, 0.05, 0.1, testing::DoubleEq(0.15)));
  EXPECT_THAT(roundNumbers(-3.1e-9, 3e-9, 3),
              testing::ElementsAre(testing::DoubleEq(-2e-9), testing::DoubleEq(0), testing::DoubleEq(2e-9)));
}

// Steps of 50 are lost beside 1e18, whose neighbours are 128 apart; of 1e300 and more the difference is infinite.
TEST(PlotPanel, RoundNumbersEndWhereTheRangeIsLostInRounding) {
  for (const double low : {1e18, -1e18, 1e6, 1e99})
    for (const double width : {std::abs(low) * 1e-16, std::abs(low) * 3e-16, std::abs(low) * 1e-15}) {
      const std::vector<double> numbers = roundNumbers(low, low + width, 5);
      EXPECT_LE(numbers.size(), 11u) << low;
      EXPECT_TRUE(std::adjacent_find(numbers.begin(), numbers.end(), std::greater_equal<>()) == numbers.end()) << low;
    }
  EXPECT_THAT(roundNumbers(5, 5, 4), testing::IsEmpty());
  EXPECT_THAT(roundNumbers(-1.5e308, 1.5e308, 4), testing::IsEmpty());
  EXPECT_THAT(roundNumbers(std::nan(""), 1, 4), testing::IsEmpty());
}

TEST(PlotPanel, OneFrameAtALateTimeIsDrawn) {
  for (const double time : {1e6, 1e18}) {
    const PlotContent content{"c", {time}, {{"", {1}, kRed}}};
    EXPECT_GT(pixelAt(drawn(content, 0), plotAreaOf(content, kWidth, kHeight).at(time, 1))[0], 200) << time;
  }
}

TEST(PlotPanel, PlacesThatAreNoNumbersAreNotDrawn) {
  const double infinity = std::numeric_limits<double>::infinity();
  Image image(20, 10);
  const Image empty = image;
  Canvas canvas(image);
  for (const double odd : {std::nan(""), infinity, -infinity, 1e307, -1e307}) {
    canvas.line({{{odd, 5}}, {{odd, odd}}}, kRed);
    canvas.line({{{5, odd}}, {{odd, 5}}}, kRed);
    canvas.disc({odd, odd}, 3, kRed);
  }
  canvas.line({{{std::nan(""), 5}}, {{5, 5}}}, kRed);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x) EXPECT_EQ(image.at(x, y)[0], empty.at(x, y)[0]) << x << ' ' << y;
}

}  // namespace
}  // namespace cradle
