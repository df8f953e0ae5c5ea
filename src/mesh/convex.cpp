#include "mesh/convex.h"

#include <algorithm>

namespace cradle {
namespace {

constexpr double kPlaneTolerance = 1e-6;  // of the diagonal of the bounds

struct FacePlane {
  Vec3 normal;  // unit
  double offset;
};

}  // namespace

bool isConvex(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return false;
  Bounds bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  const double size = bounds.diagonal().norm();

  std::vector<FacePlane> planes;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3& a = mesh.vertices[i];
    const Vec3 edgeB = (mesh.vertices[j] - a) / size, edgeC = (mesh.vertices[k] - a) / size;
    const Vec3 normal = edgeB.cross(edgeC);
    // The plane of a sliver (height below the tolerance) is rounding; its neighbours hold its corners.
    const double longest = std::max({edgeB.norm(), edgeC.norm(), (edgeC - edgeB).norm()});
    if (normal.norm() > kPlaneTolerance * longest) planes.push_back({normal.normalized(), normal.normalized().dot(a)});
  }

  // A dent shows most often between near vertices: those of the next triangles. Then all against all.
  const double limit = kPlaneTolerance * size;
  for (std::size_t t = 0; t + 1 < planes.size() && planes.size() == mesh.triangles.size(); ++t)
    for (const std::uint32_t vertex : mesh.triangles[t + 1])
      if (planes[t].normal.dot(mesh.vertices[vertex]) - planes[t].offset > limit) return false;
  return std::all_of(planes.begin(), planes.end(), [&](const FacePlane& plane) {
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                       [&](const Vec3& v) { return plane.normal.dot(v) - plane.offset <= limit; });
  });
}

}  // namespace cradle
