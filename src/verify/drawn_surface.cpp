#include "verify/drawn_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "verify/single_precision.h"

namespace cradle {
namespace {

constexpr int kMaxCells = 48;      // along an axis: 3 MB of empty cells
constexpr double kFarther = 1000;  // reaches within which the distance of a point off the surface is looked for

double distanceToSegment(const Vec3& point, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp((point - from).dot(along) / length, 0.0, 1.0) : 0;
  return (point - from - share * along).norm();
}

using Corners = std::array<Vec3, 3>;

/// From the plane where the point is over the triangle, else from its edges.
double distanceToTriangle(const Vec3& point, const Corners& corners) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  double nearest = std::numeric_limits<double>::infinity();
  bool isOver = normal.squaredNorm() > 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &from = corners[i], &to = corners[(i + 1) % 3];
    isOver = isOver && normal.dot((to - from).cross(point - from)) >= 0;
    nearest = std::min(nearest, distanceToSegment(point, from, to));
  }
  return isOver ? std::min(nearest, std::abs(normal.normalized().dot(point - corners[0]))) : nearest;
}

}  // namespace

DrawnSurface::DrawnSurface(const DrawnMesh& mesh) : mesh_(mesh) {
  for (const Vec3& vertex : mesh.vertices) bounds_.extend(vertex);
  const double triangles = static_cast<double>(mesh.triangles.size());
  cellsAlong_ = std::clamp(static_cast<int>(2 * std::cbrt(triangles)), 1, kMaxCells);
  cell_ = (bounds_.sizes() / cellsAlong_).cwiseMax(1e-300);
  inCell_.resize(static_cast<std::size_t>(cellsAlong_) * static_cast<std::size_t>(cellsAlong_) *
                 static_cast<std::size_t>(cellsAlong_));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Bounds box;
    for (const std::uint32_t vertex : mesh.triangles[i]) box.extend(mesh.vertices[vertex]);
    visitNear(box, [&](std::size_t cell) { inCell_[cell].push_back(static_cast<std::uint32_t>(i)); });
  }
}

Eigen::Array3i DrawnSurface::cellAt(const Vec3& point) const {
  const Eigen::Array3d place = (point - bounds_.min()).array() / cell_.array();
  return place.max(0).min(cellsAlong_ - 1).cast<int>();
}

/// Calls visit(index of a cell) for all cells that a box reaches.
template <class Visit>
void DrawnSurface::visitNear(const Bounds& box, const Visit& visit) const {
  const Eigen::Array3i first = cellAt(box.min()), last = cellAt(box.max());
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x)
        visit(static_cast<std::size_t>((z * cellsAlong_ + y) * cellsAlong_ + x));
}

DrawnSurface::Match DrawnSurface::match(const Vec3& point, const Vec3& normal, double reach, double rounding) const {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Match best{kFarther * reach, kInfinite, kSingleNormal};
  const auto look = [&](double around) {
    const Vec3 half = Vec3::Constant(around);
    visitNear(Bounds(point - half, point + half), [&](std::size_t cell) {
      for (const std::uint32_t index : inCell_[cell]) {
        const Triangle& triangle = mesh_.triangles[index];
        const Corners corners{mesh_.vertices[triangle[0]], mesh_.vertices[triangle[1]], mesh_.vertices[triangle[2]]};
        const double distance = distanceToTriangle(point, corners);
        best.distance = std::min(best.distance, distance);
        const Vec3 area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        if (distance > reach || area.norm() == 0) continue;
        const double longest = std::max(
            {(corners[1] - corners[0]).norm(), (corners[2] - corners[0]).norm(), (corners[2] - corners[1]).norm()});
        const Vec3 facet = area.normalized();
        const double tolerance = kSingleNormal + rounding * longest / area.norm();  // of the least height
        const double deviation = std::min((normal - facet).norm(), (normal + facet).norm());
        if (!(deviation / tolerance < best.normalDeviation / best.normalTolerance)) continue;
        best.normalDeviation = deviation;
        best.normalTolerance = tolerance;
      }
    });
  };
  look(reach);
  if (best.distance > reach) look(kFarther * reach);
  return best;
}

}  // namespace cradle
