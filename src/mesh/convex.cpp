#include "mesh/convex.h"

#include <algorithm>

namespace cradle {
namespace {

constexpr double kPlaneTolerance = 1e-6;  // of the diagonal of the bounds

struct FacePlane {
  Vec3 normal;           // unit
  double offset, limit;  // m: so far before it a vertex may be
};

}  // namespace

bool isConvex(const TriangleMesh& mesh, double slack) {
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
    if (!(normal.norm() > kPlaneTolerance * longest)) continue;
    const double height = normal.norm() / longest;  // sizes: of the triangle, by which it turns with its corners
    planes.push_back(
        {normal.normalized(), normal.normalized().dot(a), kPlaneTolerance * size + slack * (1 + 1 / height)});
  }

  // A dent shows most often between near vertices: those of the next triangles. Then all against all.
  for (std::size_t t = 0; t + 1 < planes.size() && planes.size() == mesh.triangles.size(); ++t)
    for (const std::uint32_t vertex : mesh.triangles[t + 1])
      if (planes[t].normal.dot(mesh.vertices[vertex]) - planes[t].offset > planes[t].limit) return false;
  return std::all_of(planes.begin(), planes.end(), [&](const FacePlane& plane) {
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                       [&](const Vec3& v) { return plane.normal.dot(v) - plane.offset <= plane.limit; });
  });
}

}  // namespace cradle
