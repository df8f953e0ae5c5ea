#include "mesh/turn_parts.h"

#include "core/error.h"
#include "mesh/mesh_parts.h"
#include "mesh/smooth_normals.h"
#include "mesh/solid.h"

namespace cradle {
namespace {

void turn(Triangle& triangle) {
  std::swap(triangle[1], triangle[2]);
}

/// Normals that the file computed from its winding were inside-out too; those that an artist set may not have been.
/// Corners that other parts use as well stay as they are.
void turnNormals(const MeshPart& part, const std::vector<char>& isShared, DrawnMesh& drawn) {
  double agreement = 0;
  for (const std::uint32_t t : part.triangles) {
    const Vec3f outward = triangleNormal(drawn, drawn.triangles[t]).cast<float>();
    for (const std::uint32_t corner : drawn.triangles[t]) agreement += outward.dot(drawn.normals[corner]);
  }
  if (agreement >= 0) return;
  std::vector<char> isTurned(drawn.vertices.size(), 0);
  for (const std::uint32_t t : part.triangles)
    for (const std::uint32_t corner : drawn.triangles[t]) {
      if (isShared[corner] != 0 || isTurned[corner] != 0) continue;
      drawn.normals[corner] = -drawn.normals[corner];
      isTurned[corner] = 1;
    }
}

/// Drawn vertices that more than one part uses.
std::vector<char> sharedCorners(const PartReport& report, const DrawnMesh& drawn) {
  std::vector<char> isShared(drawn.vertices.size(), 0);
  std::vector<std::size_t> user(drawn.vertices.size(), report.parts.size());
  for (std::size_t part = 0; part < report.parts.size(); ++part)
    for (const std::uint32_t t : report.parts[part].triangles)
      for (const std::uint32_t corner : drawn.triangles[t]) {
        if (user[corner] != report.parts.size() && user[corner] != part) isShared[corner] = 1;
        user[corner] = part;
      }
  return isShared;
}

}  // namespace

void turnPartsOutwards(LoadedModel& loaded) {
  TriangleMesh& solid = loaded.model.solid;
  DrawnMesh& drawn = loaded.model.drawn;
  if (!hasMatchingEdges(solid)) return;
  const PartReport report = examineParts(solid);
  if (report.insideOut.empty()) return;
  const bool isDrawn = !drawn.triangles.empty();
  CRADLE_CHECK(!isDrawn || drawn.triangles.size() == solid.triangles.size());
  const std::vector<char> isShared = isDrawn ? sharedCorners(report, drawn) : std::vector<char>{};
  for (const std::size_t part : report.insideOut) {
    for (const std::uint32_t t : report.parts[part].triangles) {
      turn(solid.triangles[t]);
      if (isDrawn) turn(drawn.triangles[t]);
    }
    if (isDrawn) turnNormals(report.parts[part], isShared, drawn);
    if (report.parts.size() > 1) loaded.notes.push_back(describePart(report, part) + " was inside-out: turned");
  }
  if (report.parts.size() == 1) loaded.notes.emplace_back("was inside-out: turned");
}

}  // namespace cradle
