#pragma once

#include <optional>
#include <string>

#include "image/image.h"

namespace cradle {

/// Pixels with a channel off by more than `level` (0..255) may be at most max(share of the picture, `always`).
struct DifferenceLimit {
  int level;
  double share;  // 0..1
  long always;   // pixels
};

/// What passes as rounding. Another CPU rounds otherwise and moves a few pixels of edges; an error of motion of 0.1 ms
/// moves 0.01 % of a picture of 1280x720: the limits lie between.
struct ImageLimits {
  DifferenceLimit visible{2, 0.005e-2, 4};
  DifferenceLimit striking{32, 0.001e-2, 1};
};

/// A part of a picture: columns and rows from the top left, first included, last not.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// How two pictures differ, and whether that passes as rounding.
struct ImageComparison {
  bool isSame = false;        // every byte equal
  bool passes = false;        // equal, or within the limits
  long differingPixels = 0;   // any channel off
  long visiblePixels = 0;     // beyond the visible level
  long strikingPixels = 0;    // beyond the striking level
  int largestDifference = 0;  // of any channel, 0..255
  PixelBox where;             // of all pixels that differ
  std::string sentence;       // for the user
};

/// That of two pictures whose sizes differ; nothing if they do not.
std::optional<ImageComparison> compareSizes(PictureSize expected, PictureSize actual);

/// Compares two pictures of one size row by row.
class RowComparison {
 public:
  /// `limits` must outlive it.
  RowComparison(PictureSize size, const ImageLimits& limits) : size_(size), limits_(limits) {}

  /// The next row of both, from the top: red, green, blue of each pixel.
  void add(const std::uint8_t* expected, const std::uint8_t* actual);
  /// Once all rows are added.
  ImageComparison result() const;

 private:
  PictureSize size_;
  const ImageLimits& limits_;
  int row_ = 0;
  ImageComparison counted_;
};

ImageComparison compareImages(const Image& expected, const Image& actual, const ImageLimits& limits = {});

/// The difference of every channel, times the factor that makes the largest 255; black where both are equal. The
/// pictures have one size.
Image amplifiedDifference(const Image& expected, const Image& actual);

}  // namespace cradle
