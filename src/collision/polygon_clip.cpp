// I. E. Sutherland, G. W. Hodgman, "Reentrant polygon clipping", Communications of the ACM 17(1), 1974.

#include "collision/polygon_clip.h"

#include <limits>

namespace cradle {
namespace {

// Of a squared area: corners whose triangles differ by less are equal, so that rounding does not choose among those of
// a regular polygon, and every other one of these is left. A million times the rounding of an area.
constexpr double kEqualAreas = 1e-9;

}  // namespace

void clip(Points& polygon, Points& scratch, const Vec3& outward, double offset) {
  scratch.clear();
  const std::size_t count = polygon.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 &from = polygon[i], &to = polygon[(i + 1) % count];
    const double heightFrom = outward.dot(from) - offset, heightTo = outward.dot(to) - offset;
    if (heightFrom <= 0) scratch.push_back(from);
    if (count == 2 && i == 1) break;  // a line has one side
    if ((heightFrom < 0) != (heightTo < 0) && heightFrom != heightTo && heightFrom != 0 && heightTo != 0)
      scratch.push_back(from + heightFrom / (heightFrom - heightTo) * (to - from));
  }
  std::swap(polygon, scratch);
}

void thinOut(std::size_t most, Points& polygon) {
  while (polygon.size() > most) {
    std::size_t least = 0;
    double leastArea = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &before = polygon[(i + polygon.size() - 1) % polygon.size()],
                 &after = polygon[(i + 1) % polygon.size()];
      const double area = (before - polygon[i]).cross(after - polygon[i]).squaredNorm();
      if (area < leastArea * (1 - kEqualAreas)) leastArea = area, least = i;
    }
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(least));
  }
}

}  // namespace cradle
