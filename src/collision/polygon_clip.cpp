// I. E. Sutherland, G. W. Hodgman, "Reentrant polygon clipping", Communications of the ACM 17(1), 1974.

#include "collision/polygon_clip.h"

#include <algorithm>
#include <numeric>

namespace cradle {
namespace {

// Of a squared area: corners whose triangles differ by less are equal, so that rounding does not choose among those of
// a regular polygon, and every other one of these is left. A million times the rounding of an area.
constexpr double kEqualAreas = 1e-9;

using Numbers = std::pmr::vector<std::size_t>;

/// Squared areas of the triangles that corners make with their neighbours, times 4.
void findAreas(const Points& polygon, std::pmr::vector<double>& areas) {
  areas.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &before = polygon[(i + polygon.size() - 1) % polygon.size()], &after = polygon[(i + 1) % polygon.size()];
    areas.push_back((before - polygon[i]).cross(after - polygon[i]).squaredNorm());
  }
}

/// The corners that span least, and of these the farthest from `middle`: several are images of each other.
void findLeast(const Points& polygon, const std::pmr::vector<double>& areas, const Vec3& middle, Numbers& least) {
  const double leastArea = *std::min_element(areas.begin(), areas.end());
  double farthest = 0;
  least.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const double square = (polygon[i] - middle).squaredNorm();
    if (areas[i] * (1 - kEqualAreas) > leastArea || square < farthest * (1 - kEqualAreas)) continue;
    if (square * (1 - kEqualAreas) > farthest) least.clear();
    farthest = std::max(farthest, square);
    least.push_back(i);
  }
}

bool hasNeighbors(const Numbers& corners, std::size_t count) {
  for (std::size_t i = 0; i + 1 < corners.size(); ++i)
    if (corners[i] + 1 == corners[i + 1]) return true;
  return corners.size() > 1 && corners.front() == 0 && corners.back() + 1 == count;
}

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
  if (polygon.size() <= most) return;
  const Vec3 middle = std::accumulate(polygon.begin(), polygon.end(), Vec3(Vec3::Zero())) / double(polygon.size());
  std::pmr::vector<double> areas(polygon.get_allocator());
  std::pmr::vector<std::size_t> least(polygon.get_allocator());
  while (polygon.size() > most) {
    findAreas(polygon, areas);
    findLeast(polygon, areas, middle, least);
    if (hasNeighbors(least, polygon.size())) least.resize(1);
    for (std::size_t i = least.size(); i-- > 0;) polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(least[i]));
  }
}

}  // namespace cradle
