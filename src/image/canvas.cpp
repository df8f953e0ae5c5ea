// A shape covers a pixel by its signed distance from the pixel's middle: half of it at distance 0, none and all half a
// pixel further out and in. That is exact for straight edges along the pixels, and off by at most 0.1 for slanting
// ones.

#include "image/canvas.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cradle {
namespace {

double linearFrom(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// sRGB levels as linear light, and the way back.
class Levels {
 public:
  Levels() {
    for (std::size_t i = 0; i < linear_.size(); ++i) linear_[i] = static_cast<float>(linearFrom(double(i) / 255));
    for (std::size_t i = 0; i + 1 < upTo_.size(); ++i)
      upTo_[i] = static_cast<float>(linearFrom((double(i) + 0.5) / 255));
    upTo_.back() = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < first_.size(); ++i) {
      const float least = static_cast<float>(i) / kSteps;
      first_[i] = static_cast<std::uint8_t>(std::upper_bound(upTo_.begin(), upTo_.end(), least) - upTo_.begin());
    }
  }

  float linear(std::uint8_t level) const { return linear_[level]; }

  /// The level nearest to linear light of 0..1.
  std::uint8_t nearest(float light) const {
    std::uint8_t level = first_[static_cast<std::size_t>(light * kSteps)];
    while (light >= upTo_[level]) ++level;
    return level;
  }

 private:
  static constexpr std::size_t kSteps = 4096;   // finer than the levels are apart, even near black
  std::array<float, 256> linear_, upTo_;        // upTo_: halfway to the next level
  std::array<std::uint8_t, kSteps + 1> first_;  // the lowest level of a step
};

const Levels kLevels;

double distanceTo(const PicturePoint& a, const PicturePoint& b) {
  const double x = a.x - b.x, y = a.y - b.y;
  return std::sqrt(x * x + y * y);
}

/// Above 0 on the right of the way from a to b, as y points down.
double side(const PicturePoint& a, const PicturePoint& b, const PicturePoint& point) {
  return ((b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x)) / std::max(distanceTo(a, b), 1e-9);
}

/// The first pixel for a place that is no number.
int pixelBelow(double place, int size) {
  return place > 0 ? static_cast<int>(std::floor(std::min(place, static_cast<double>(size)))) : 0;
}

/// 0 for a distance that is no number.
double coverageAt(double distance) {
  return distance < 0.5 ? std::min(0.5 - distance, 1.0) : 0;
}

}  // namespace

Canvas::Canvas(Image& image) : image_(image) {}

void Canvas::blend(int x, int y, double coverage, const Ink& ink) {
  if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
  const auto share = static_cast<float>(coverage * ink.opacity);
  if (!(share > 0)) return;
  std::uint8_t* pixel = image_.at(x, y);
  for (std::size_t i = 0; i < 3; ++i) {
    pixel[i] = kLevels.nearest((1 - share) * kLevels.linear(pixel[i]) + share * kLevels.linear(ink.color[i]));
  }
}

/// Whatever lies between two corners, by its signed distance (pixels) from a point.
template <typename Distance>
void Canvas::fill(const PicturePoint& low, const PicturePoint& high, const Ink& ink, const Distance& distance) {
  const int right = pixelBelow(high.x + 1.5, image_.width), bottom = pixelBelow(high.y + 1.5, image_.height);
  for (int y = pixelBelow(low.y - 0.5, image_.height); y < bottom; ++y)
    for (int x = pixelBelow(low.x - 0.5, image_.width); x < right; ++x)
      blend(x, y, coverageAt(distance(PicturePoint{x + 0.5, y + 0.5})), ink);
}

void Canvas::disc(const PicturePoint& middle, double radius, const Ink& ink) {
  fill({middle.x - radius, middle.y - radius}, {middle.x + radius, middle.y + radius}, ink,
       [&](const PicturePoint& point) { return distanceTo(point, middle) - radius; });
}

void Canvas::rectangle(const PicturePoint& topLeft, const PicturePoint& bottomRight, double cornerRadius,
                       const Ink& ink) {
  const PicturePoint middle{(topLeft.x + bottomRight.x) / 2, (topLeft.y + bottomRight.y) / 2};
  const double halfX = middle.x - topLeft.x - cornerRadius, halfY = middle.y - topLeft.y - cornerRadius;
  fill(topLeft, bottomRight, ink, [&](const PicturePoint& point) {
    const double x = std::abs(point.x - middle.x) - halfX, y = std::abs(point.y - middle.y) - halfY;
    return distanceTo({std::max(x, 0.0), std::max(y, 0.0)}, {}) + std::min(std::max(x, y), 0.0) - cornerRadius;
  });
}

void Canvas::triangle(const std::array<PicturePoint, 3>& corners, const Ink& ink) {
  const auto [lowX, highX] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
  const auto [lowY, highY] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
  const double turn = side(corners[0], corners[1], corners[2]) > 0 ? -1 : 1;
  fill({lowX, lowY}, {highX, highY}, ink, [&](const PicturePoint& point) {
    return std::max({turn * side(corners[0], corners[1], point), turn * side(corners[1], corners[2], point),
                     turn * side(corners[2], corners[0], point)});
  });
}

/// The line's part from a to b: a capsule, thicker at one end.
void Canvas::coverSegment(const LinePoint& a, const LinePoint& b) {
  const double reach = std::max(a.width, b.width) / 2;
  const auto [lowX, highX] = std::minmax(a.place.x, b.place.x);
  const auto [lowY, highY] = std::minmax(a.place.y, b.place.y);
  const double dx = b.place.x - a.place.x, dy = b.place.y - a.place.y, square = dx * dx + dy * dy;
  const int right = pixelBelow(highX + reach + 1.5, image_.width);
  const int bottom = pixelBelow(highY + reach + 1.5, image_.height);
  for (int y = pixelBelow(lowY - reach - 0.5, image_.height); y < bottom; ++y) {
    for (int x = pixelBelow(lowX - reach - 0.5, image_.width); x < right; ++x) {
      const PicturePoint point{x + 0.5, y + 0.5};
      const double along = (point.x - a.place.x) * dx + (point.y - a.place.y) * dy;
      const double share = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0;
      const double distance = distanceTo(point, {a.place.x + share * dx, a.place.y + share * dy});
      const double half = (a.width + share * (b.width - a.width)) / 2;
      // Thinner than a pixel: as much less, for the distance would make a line of a whole one.
      const double coverage = coverageAt(distance - std::max(half, 0.5)) * std::min(2 * half, 1.0);
      const auto share01 = static_cast<float>(coverage * (a.opacity + share * (b.opacity - a.opacity)));
      float& covered =
          covered_[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x)];
      if (!(share01 > covered)) continue;
      if (covered == 0) touched_.emplace_back(x, y);
      covered = share01;
    }
  }
}

void Canvas::line(const std::vector<LinePoint>& points, const Ink& ink) {
  covered_.resize(static_cast<std::size_t>(image_.width) * static_cast<std::size_t>(image_.height));
  for (std::size_t i = 0; i + 1 < points.size(); ++i) coverSegment(points[i], points[i + 1]);
  for (const auto& [x, y] : touched_) {
    float& covered =
        covered_[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x)];
    blend(x, y, covered, ink);
    covered = 0;
  }
  touched_.clear();
}

}  // namespace cradle
