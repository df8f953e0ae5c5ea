#include "image/compare_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace cradle {
namespace {

constexpr double kShareRounding =
    1e-9;  // relative: 0.005 % of 1000 x 1000 pixels are 50, whatever the product rounds to

int pixelDifference(const std::uint8_t* a, const std::uint8_t* b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

void take(PixelBox& box, int x, int y) {
  const bool isEmpty = box.left == box.right;
  box.left = isEmpty ? x : std::min(box.left, x);
  box.top = isEmpty ? y : std::min(box.top, y);
  box.right = std::max(box.right, x + 1);
  box.bottom = std::max(box.bottom, y + 1);
}

void countDifferences(const Image& expected, const Image& actual, const ImageLimits& limits, ImageComparison& result) {
  for (int y = 0; y < expected.height; ++y)
    for (int x = 0; x < expected.width; ++x) {
      const int difference = pixelDifference(expected.at(x, y), actual.at(x, y));
      if (difference == 0) continue;
      ++result.differingPixels;
      if (difference > limits.visible.level) ++result.visiblePixels;
      if (difference > limits.striking.level) ++result.strikingPixels;
      result.largestDifference = std::max(result.largestDifference, difference);
      take(result.where, x, y);
    }
}

long mostPixels(const DifferenceLimit& limit, long total) {
  const double share = limit.share * static_cast<double>(total) * (1 + kShareRounding);
  return std::max(limit.always, static_cast<long>(share));
}

}  // namespace

std::optional<ImageComparison> compareSizes(PictureSize expected, PictureSize actual) {
  if (expected == actual) return std::nullopt;
  ImageComparison result;
  result.sentence = fmt::format("sizes differ: {}x{} expected, {}x{} found", expected.width, expected.height,
                                actual.width, actual.height);
  return result;
}

ImageComparison compareImages(const Image& expected, const Image& actual, const ImageLimits& limits) {
  if (const auto different = compareSizes({expected.width, expected.height}, {actual.width, actual.height}))
    return *different;
  ImageComparison result;
  countDifferences(expected, actual, limits, result);
  const long total = static_cast<long>(expected.width) * expected.height;
  const long mostVisible = mostPixels(limits.visible, total), mostStriking = mostPixels(limits.striking, total);
  result.isSame = result.differingPixels == 0;
  result.passes = result.visiblePixels <= mostVisible && result.strikingPixels <= mostStriking;
  if (result.isSame)
    result.sentence = "equal";
  else
    result.sentence = fmt::format(
        "{} of {} pixels differ, by {} at most; {} by more than {} ({} allowed), {} by more than {} ({} allowed)",
        result.differingPixels, total, result.largestDifference, result.visiblePixels, limits.visible.level,
        mostVisible, result.strikingPixels, limits.striking.level, mostStriking);
  return result;
}

Image amplifiedDifference(const Image& expected, const Image& actual) {
  Image difference(expected.width, expected.height);
  int largest = 1;
  for (std::size_t i = 0; i < expected.pixels.size(); ++i)
    largest = std::max(largest, std::abs(expected.pixels[i] - actual.pixels[i]));
  for (std::size_t i = 0; i < expected.pixels.size(); ++i)
    difference.pixels[i] = static_cast<std::uint8_t>(std::abs(expected.pixels[i] - actual.pixels[i]) * 255 / largest);
  return difference;
}

}  // namespace cradle
