// Bytes as triangles with corners on a coarse grid, so that corners, edges and planes coincide: closed surfaces are
// found out, and solids have mass properties of a body.

#include <Eigen/Eigenvalues>

#include "fuzz_target.h"
#include "mesh/convex_hull.h"
#include "mesh/mass_properties.h"
#include "mesh/recognise_shape.h"
#include "mesh/solid.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxTriangles = 128;
constexpr std::size_t kTriangleBytes = 9;

TriangleMesh meshOf(const std::uint8_t* data, std::size_t size) {
  std::vector<Vec3> corners;
  std::vector<Triangle> triangles;
  for (std::size_t at = 0; at + kTriangleBytes <= size && triangles.size() < kMaxTriangles; at += kTriangleBytes) {
    const auto first = static_cast<std::uint32_t>(corners.size());
    triangles.push_back({first, first + 1, first + 2});
    for (std::size_t corner = 0; corner < kTriangleBytes; corner += 3) {
      const auto coordinate = [&](std::size_t axis) {
        return static_cast<std::int8_t>(data[at + corner + axis]) / 4.0;
      };
      corners.emplace_back(coordinate(0), coordinate(1), coordinate(2));
    }
  }
  return weld(corners, triangles);
}

void checkMass(const TriangleMesh& mesh) {
  const MassProperties properties = computeMassProperties(mesh, 1000);
  HOLDS(properties.mass > 0 && properties.centerOfMass.allFinite());
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(properties.inertiaTensor).eigenvalues();
  HOLDS(moments[0] > 0 && moments[0] + moments[1] >= moments[2] * (1 - 1e-9));  // ascending; rounding of the sums
}

void check(const TriangleMesh& mesh) {
  const SolidReport report = checkSolid(mesh);
  HOLDS(!report.isSolid || report.isClosed);
  HOLDS(!report.isClosed || hasMatchingEdges(mesh));
  HOLDS(report.isSolid || !report.problems.empty());
  if (report.isSolid) checkMass(mesh);
  if (report.isClosed) recogniseShape(mesh);
  const ConvexHull hull = convexHullOf(mesh.vertices);
  for (const std::vector<std::size_t>& loop : hull.faces) {
    HOLDS(loop.size() >= 3);
    for (const std::size_t vertex : loop) HOLDS(vertex < hull.vertices.size());
  }
}

}  // namespace
}  // namespace cradle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  acceptOrRefuse([&] {
    const TriangleMesh mesh = meshOf(data, size);
    if (!mesh.triangles.empty()) check(mesh);
  });
  return 0;
}
