#include "image/compare_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "core/error.h"

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

void RowComparison::add(const std::uint8_t* expected, const std::uint8_t* actual) {
  const int y = row_++;
  if (std::memcmp(expected, actual, 3 * static_cast<std::size_t>(size_.width)) == 0) return;
  for (int x = 0; x < size_.width; ++x, expected += 3, actual += 3) {
    const int difference = pixelDifference(expected, actual);
    if (difference == 0) continue;
    ++counted_.differingPixels;
    if (difference > limits_.visible.level) ++counted_.visiblePixels;
    if (difference > limits_.striking.level) ++counted_.strikingPixels;
    counted_.largestDifference = std::max(counted_.largestDifference, difference);
    take(counted_.where, x, y);
  }
}

ImageComparison RowComparison::result() const {
  CRADLE_CHECK(row_ == size_.height);
  ImageComparison result = counted_;
  const long total = static_cast<long>(size_.width) * size_.height;
  const long mostVisible = mostPixels(limits_.visible, total), mostStriking = mostPixels(limits_.striking, total);
  result.isSame = result.differingPixels == 0;
  result.passes = result.visiblePixels <= mostVisible && result.strikingPixels <= mostStriking;
  if (result.isSame)
    result.sentence = "equal";
  else
    result.sentence = fmt::format(
        "{} of {} pixels differ, by {} at most; {} by more than {} ({} allowed), {} by more than {} ({} allowed)",
        result.differingPixels, total, result.largestDifference, result.visiblePixels, limits_.visible.level,
        mostVisible, result.strikingPixels, limits_.striking.level, mostStriking);
  return result;
}

ImageComparison compareImages(const Image& expected, const Image& actual, const ImageLimits& limits) {
  const PictureSize size{expected.width, expected.height};
  if (const auto different = compareSizes(size, {actual.width, actual.height})) return *different;
  RowComparison rows(size, limits);
  for (int y = 0; y < size.height; ++y) rows.add(expected.at(0, y), actual.at(0, y));
  return rows.result();
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
