#include "rocks.h"

#include <cmath>
#include <numbers>

namespace cradle::assets {
namespace {

constexpr std::size_t kRocks = 12, kFewestCorners = 12;
const Vec3 kHalfAxes(1, 0.75, 0.85);  // m, of the ellipsoid that the corners lie near
constexpr double kRoughness = 0.12;   // of their distance from the middle

/// Numbers in [0, 1) that are the same everywhere: a linear congruence modulo 2^32 (D. E. Knuth, "The Art of Computer
/// Programming", vol. 2, 3.3.4).
class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : state_(seed) {}
  double next() {
    state_ = 1664525u * state_ + 1013904223u;
    return state_ / 4294967296.0;
  }

 private:
  std::uint32_t state_;
};

/// Points around an ellipsoid on a spiral, which spreads them evenly, each moved a little.
std::vector<Vec3> cornersOf(std::size_t count, Numbers& numbers) {
  const double goldenAngle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double turn = 2 * std::numbers::pi * numbers.next();
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const double height = 1 - 2 * (static_cast<double>(i) + numbers.next()) / static_cast<double>(count);
    const double angle = turn + goldenAngle * static_cast<double>(i), across = std::sqrt(1 - height * height);
    const Vec3 direction(across * std::cos(angle), height, across * std::sin(angle));
    corners.push_back((1 + kRoughness * (numbers.next() - 0.5)) * direction.cwiseProduct(kHalfAxes));
  }
  return corners;
}

/// The convex hull of points of which no four lie in a plane: all triangles that have the others on one side.
Surface hullOf(const std::string& name, const std::vector<Vec3>& points) {
  Surface surface{name, 0, points, {}};
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = a + 1; b < points.size(); ++b)
      for (std::size_t c = b + 1; c < points.size(); ++c) {
        const Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]);
        std::size_t above = 0;
        for (const Vec3& point : points) above += normal.dot(point - points[a]) > 1e-12 ? 1 : 0;
        if (above == 0) surface.addTriangle(a, b, c, kSharp);
        if (above == points.size() - 3) surface.addTriangle(a, c, b, kSharp);
      }
  return surface;
}

}  // namespace

std::vector<Surface> rocks() {
  std::vector<Surface> all;
  Numbers numbers(1);
  for (std::size_t i = 0; i < kRocks; ++i) {
    const std::string number = (i < 9 ? "0" : "") + std::to_string(i + 1);
    all.push_back(hullOf("Rock" + number, cornersOf(kFewestCorners + i % 4, numbers)));
  }
  return all;
}

}  // namespace cradle::assets
