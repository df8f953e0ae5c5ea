#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "image/image.h"

namespace cradle {

/// A place in a picture: pixels to the right and down from the top left corner; the first pixel's middle is (0.5, 0.5).
struct PicturePoint {
  double x = 0, y = 0;
};

struct Ink {
  std::array<std::uint8_t, 3> color = {255, 255, 255};  // sRGB
  double opacity = 1;                                   // 0..1
};

/// A point of a line whose width (pixels) and opacity (0..1, of the ink's) may change on its way.
struct LinePoint {
  PicturePoint place;
  double width = 1, opacity = 1;
};

/// Draws with smooth edges on a finished picture: a pixel takes as much of the ink as it is covered, mixed in linear
/// light. What lies outside the picture is left out.
class Canvas {
 public:
  /// `image` must outlive this object.
  explicit Canvas(Image& image);

  int width() const { return image_.width; }
  int height() const { return image_.height; }

  void disc(const PicturePoint& middle, double radius, const Ink& ink);

  /// With round ends and joints; where it crosses itself, it covers no more than once.
  void line(const std::vector<LinePoint>& points, const Ink& ink);

  /// With round corners.
  void rectangle(const PicturePoint& topLeft, const PicturePoint& bottomRight, double cornerRadius, const Ink& ink);

  void triangle(const std::array<PicturePoint, 3>& corners, const Ink& ink);

  /// One pixel, `coverage` of it (0..1); nothing outside the picture.
  void blend(int x, int y, double coverage, const Ink& ink);

 private:
  template <typename Distance>
  void fill(const PicturePoint& low, const PicturePoint& high, const Ink& ink, const Distance& distance);
  void coverSegment(const LinePoint& a, const LinePoint& b);

  Image& image_;
  std::vector<float> covered_;                // by the line that is being drawn, of each pixel
  std::vector<std::pair<int, int>> touched_;  // pixels of covered_ that are not 0
};

}  // namespace cradle
