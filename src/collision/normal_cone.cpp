#include "collision/normal_cone.h"

#include <algorithm>

namespace cradle {
namespace {

// rad: a solid may be ahead of the tangent plane by the margin, but by no less than the smaller angle, so that a face
// touches with all of its outline, and by no more than the larger one, 6 degrees. A tenth or ten times as much of
// either changes no test.
constexpr double kMinTilt = 1e-5, kMaxTilt = 0.1;

}  // namespace

double allowedAhead(double margin, double length) {
  return std::clamp(margin, kMinTilt * length, kMaxTilt * length);
}

bool isInNormalCone(const MeshSurface& surface, std::uint32_t vertex, const Vec3& ahead, double margin) {
  if (surface.vertexNormals[vertex].dot(ahead) < -kMinTilt) return false;
  for (std::uint32_t i = surface.firstNeighbour[vertex]; i < surface.firstNeighbour[vertex + 1]; ++i) {
    const Vec3 side = surface.vertices[surface.neighbours[i]] - surface.vertices[vertex];
    if (ahead.dot(side) > allowedAhead(margin, side.norm())) return false;
  }
  return true;
}

bool mayBeInNormalCone(const MeshSurface& surface, std::uint32_t vertex, const Vec3& ahead, double tilt) {
  for (std::uint32_t i = surface.firstNeighbour[vertex]; i < surface.firstNeighbour[vertex + 1]; ++i) {
    const Vec3 side = surface.vertices[surface.neighbours[i]] - surface.vertices[vertex];
    if (ahead.dot(side) > (kMaxTilt + tilt) * side.norm()) return false;
  }
  return true;
}

bool isInNormalCone(const MeshSurface& surface, const MeshSurface::Edge& edge, const Vec3& ahead, double margin) {
  // At a sheet's border a direction straight over one of its sides is in the cone, too.
  if (!edge.isConvex || edge.normal.dot(ahead) <= (edge.isBorder ? -kMinTilt : 0)) return false;
  const Vec3& from = surface.vertices[edge.vertices[0]];
  const Vec3 along = (surface.vertices[edge.vertices[1]] - from).normalized();
  for (const std::uint32_t across : edge.across) {
    const Vec3 side = surface.vertices[across] - from;
    if (ahead.dot(side) > allowedAhead(margin, side.cross(along).norm())) return false;
  }
  return true;
}

}  // namespace cradle
