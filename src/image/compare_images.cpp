#include "image/compare_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace cradle {
namespace {

// Another CPU rounds otherwise and moves a few pixels of edges; an error of motion of 0.1 ms moves 0.01 % of a
// picture of 1280x720. The limits lie between.
constexpr int kVisible = 2;
constexpr int kStriking = 32;
constexpr long kVisibleParts = 20000;    // one pixel of so many: 0.005 %
constexpr long kStrikingParts = 100000;  // 0.001 %
constexpr long kVisibleAlways = 4;
constexpr long kStrikingAlways = 1;

int pixelDifference(const std::uint8_t* a, const std::uint8_t* b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

void countDifferences(const Image& expected, const Image& actual, ImageComparison& result) {
  for (std::size_t i = 0; i < expected.pixels.size(); i += 3) {
    const int difference = pixelDifference(&expected.pixels[i], &actual.pixels[i]);
    if (difference > 0) ++result.differingPixels;
    if (difference > kVisible) ++result.visiblePixels;
    if (difference > kStriking) ++result.strikingPixels;
    result.largestDifference = std::max(result.largestDifference, difference);
  }
}

}  // namespace

ImageComparison compareImages(const Image& expected, const Image& actual) {
  ImageComparison result;
  if (expected.width != actual.width || expected.height != actual.height) {
    result.sentence = fmt::format("sizes differ: {}x{} expected, {}x{} found", expected.width, expected.height,
                                  actual.width, actual.height);
    return result;
  }
  countDifferences(expected, actual, result);
  const long total = static_cast<long>(expected.width) * expected.height;
  const long visibleLimit = std::max(kVisibleAlways, total / kVisibleParts);
  const long strikingLimit = std::max(kStrikingAlways, total / kStrikingParts);
  result.isSame = result.differingPixels == 0;
  result.passes = result.visiblePixels <= visibleLimit && result.strikingPixels <= strikingLimit;
  if (result.isSame)
    result.sentence = "equal";
  else
    result.sentence = fmt::format(
        "{} of {} pixels differ, by {} at most; {} by more than {} ({} allowed), {} by more than {} ({} allowed)",
        result.differingPixels, total, result.largestDifference, result.visiblePixels, kVisible, visibleLimit,
        result.strikingPixels, kStriking, strikingLimit);
  return result;
}

}  // namespace cradle
