// The bar is a grid of rows along x and angles around it. On top a rectangle of the grid is left out; rings of
// vertices lead from its rim to the curve where the two cylinders meet, which is also the foot of the stem.

#include "t_handle.h"

#include <cmath>
#include <functional>
#include <numbers>

namespace cradle::assets {
namespace {

constexpr double kBarRadius = 0.015, kBarLength = 0.16;  // m
constexpr double kStemRadius = 0.012, kStemTop = 0.09;   // m, height above the bar's axis
constexpr double kGapHalfLength = 0.02;                  // m, of the rectangle, along x
constexpr std::size_t kSides = 48, kGapSides = 10;  // around the bar; the rectangle reaches 75 degrees to each side
constexpr std::size_t kGapRows = 16, kRings = 3;
constexpr std::uint32_t kBarGroup = 1, kStemGroup = 2;

// Height of the bar's upper half over (x, z).
Vec3 onBar(double x, double z) {
  return {x, std::sqrt(kBarRadius * kBarRadius - z * z), z};
}

// Indices of the bar's vertices: rows 0 .. kGapRows + 2 along x, sides 0 .. kSides - 1 from +y towards +z.
class BarGrid {
 public:
  explicit BarGrid(Surface& surface) : surface_(surface), indices_((kGapRows + 3) * kSides, 0) {
    for (std::size_t row = 0; row < kGapRows + 3; ++row)
      for (std::size_t side = 0; side < kSides; ++side) {
        const bool isInGap = row > 1 && row < kGapRows + 1 && (side + kGapSides - 1) % kSides < 2 * kGapSides - 1;
        const double angle = 2 * std::numbers::pi * static_cast<double>(side) / static_cast<double>(kSides);
        if (!isInGap)
          indices_[row * kSides + side] =
              surface_.add({place(row), kBarRadius * std::cos(angle), kBarRadius * std::sin(angle)});
      }
  }

  std::size_t at(std::size_t row, std::size_t side) const { return indices_[row * kSides + side % kSides]; }

  void addFaces() {
    for (std::size_t row = 0; row < kGapRows + 2; ++row)
      for (std::size_t side = 0; side < kSides; ++side) {
        const bool isGap = row >= 1 && row <= kGapRows && (side + kGapSides) % kSides < 2 * kGapSides;
        if (!isGap)
          surface_.addQuad(at(row, side), at(row, side + 1), at(row + 1, side + 1), at(row + 1, side), kBarGroup);
      }
    const std::size_t start = surface_.add({-kBarLength / 2, 0, 0}), end = surface_.add({kBarLength / 2, 0, 0});
    for (std::size_t side = 0; side < kSides; ++side) {
      surface_.addTriangle(start, at(0, side + 1), at(0, side), kSharp);
      surface_.addTriangle(end, at(kGapRows + 2, side), at(kGapRows + 2, side + 1), kSharp);
    }
  }

  // The rectangle's rim, counter-clockwise seen from above.
  std::vector<std::size_t> rim() const {
    constexpr std::size_t kLast = kGapRows + 1;
    std::vector<std::size_t> loop;
    for (std::size_t i = 0; i < 2 * kGapSides; ++i) loop.push_back(at(kLast, kSides + kGapSides - i));
    for (std::size_t i = 0; i < kGapRows; ++i) loop.push_back(at(kLast - i, kSides - kGapSides));
    for (std::size_t i = 0; i < 2 * kGapSides; ++i) loop.push_back(at(1, kSides - kGapSides + i));
    for (std::size_t i = 0; i < kGapRows; ++i) loop.push_back(at(1 + i, kGapSides));
    return loop;
  }

 private:
  static double place(std::size_t row) {
    if (row == 0) return -kBarLength / 2;
    if (row == kGapRows + 2) return kBarLength / 2;
    return kGapHalfLength * (2 * static_cast<double>(row - 1) / static_cast<double>(kGapRows) - 1);
  }

  Surface& surface_;
  std::vector<std::size_t> indices_;
};

// Adds a loop of vertices, one for each of `rim`, and the band of faces between `below` and it.
std::vector<std::size_t> addBand(const std::vector<std::size_t>& below, const std::vector<std::size_t>& rim,
                                 std::uint32_t group, const std::function<Vec3(const Vec3&)>& place, Surface& surface) {
  std::vector<std::size_t> above;
  for (const std::size_t vertex : rim) above.push_back(surface.add(place(surface.vertices[vertex])));
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const std::size_t j = (i + 1) % rim.size();
    surface.addQuad(below[i], below[j], above[j], above[i], group);
  }
  return above;
}

}  // namespace

Surface tHandle() {
  Surface surface{"THandle", 0, {}, {}};
  BarGrid bar(surface);
  bar.addFaces();

  const std::vector<std::size_t> rim = bar.rim();
  std::vector<std::size_t> loop = rim;
  for (std::size_t ring = 1; ring <= kRings; ++ring) {
    const double inward = static_cast<double>(ring) / static_cast<double>(kRings);
    const auto onRing = [&](const Vec3& p) {
      const double toStem = kStemRadius / std::hypot(p.x(), p.z()), shrink = 1 - inward + inward * toStem;
      return onBar(shrink * p.x(), shrink * p.z());
    };
    loop = addBand(loop, rim, kBarGroup, onRing, surface);
  }
  const auto onTop = [](const Vec3& p) {
    const double toStem = kStemRadius / std::hypot(p.x(), p.z());
    return Vec3(toStem * p.x(), kStemTop, toStem * p.z());
  };
  loop = addBand(loop, rim, kStemGroup, onTop, surface);
  const std::size_t tip = surface.add({0, kStemTop, 0});
  for (std::size_t i = 0; i < loop.size(); ++i) surface.addTriangle(tip, loop[i], loop[(i + 1) % loop.size()], kSharp);
  return surface;
}

}  // namespace cradle::assets
