#include "render/light_receiver.h"

#include "render/shadow_casters.h"

namespace cradle {
namespace {

// At the edge of a triangle seen edge-on, the middle of a pixel may lie far beyond it in depth: shading takes place
// there, up to so many pixels away. What is round is met exactly by rays.
constexpr double kEdgePixels = 32, kRoundPixels = 2;
constexpr double kTurnedAway = 1e-3;  // sine: so far from edge-on, rounding does not tell the sides apart wrongly

/// Sines of the angles in which triangles are seen: least and greatest; negative from inside.
struct Facing {
  double least, greatest;
  bool isAway() const { return greatest < -kTurnedAway; }
  /// How far beside their edges they are shaded.
  double edgePixels() const { return least > 1 / kEdgePixels ? 1 / least : kEdgePixels; }
};

/// Of triangles within `box` whose unit normals differ by `spread` at most.
Facing facing(const DrawnHull& box, const Vec3& normal, double spread, const RenderSetup& setup) {
  const Vec3 to = setup.camera.position - box.middle();
  const double sine = normal.dot(to.normalized()), around = spread + 2 * box.reach() / to.norm();
  return {sine - around, sine + around};
}

/// Of one triangle, where it is seen least.
Facing facing(const std::array<Vec3, 3>& triangle, const DrawnHull& hull, const RenderSetup& setup) {
  const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
  const double farthest = (setup.camera.position - hull.middle()).norm() + hull.reach();
  const double sine = normal.dot(setup.camera.position - triangle[0]) / farthest;
  return {sine, sine};
}

LightReceiver receiverOf(const DrawnHull& hull, double edgePixels, const RenderSetup& setup) {
  return {hull, edgePixels * (hull.middle() - setup.camera.position).norm() * pixelAngle(setup), {}, {}};
}

}  // namespace

void appendReceivers(const MeshItem& item, const MeshBounds& bounds, const RenderSetup& setup,
                     std::vector<LightReceiver>& receivers) {
  const std::uint32_t begin = item.firstTriangle, end = begin + item.triangleCount;
  for (const TriangleGroup& group : bounds.groups) {
    if (group.first >= end || group.last < begin) continue;
    const DrawnHull box = hullOf(group.box, item.worldFromMesh);
    const Facing seen = facing(box, item.worldFromMesh.rotation * group.normal, group.normalSpread, setup);
    if (!(bounds.isClosed && seen.isAway())) receivers.push_back(receiverOf(box, seen.edgePixels(), setup));
  }
  for (const LongTriangle& one : bounds.longTriangles) {
    if (one.index < begin || one.index >= end) continue;
    std::array<Vec3, 3> triangle;
    DrawnHull hull;
    for (std::size_t i = 0; i < 3; ++i) hull.add(triangle[i] = item.worldFromMesh * one.corners[i]);
    const Facing seen = facing(triangle, hull, setup);
    if (bounds.isClosed && seen.isAway()) continue;
    receivers.push_back(receiverOf(hull, seen.edgePixels(), setup));
    receivers.back().triangle = triangle;
  }
}

void appendReceivers(const SphereItem& item, const RenderSetup& setup, std::vector<LightReceiver>& receivers) {
  receivers.push_back(receiverOf(hullOf(item), kRoundPixels, setup));
}

void appendReceivers(const CylinderItem& item, const RenderSetup& setup, std::vector<LightReceiver>& receivers) {
  std::vector<DrawnHull> pieces;
  appendPieces(hullOf(item), pieces);
  for (const DrawnHull& piece : pieces) receivers.push_back(receiverOf(piece, kRoundPixels, setup));
}

void appendReceivers(const TubeItem& item, const RenderSetup& setup, std::vector<LightReceiver>& receivers) {
  receivers.push_back(receiverOf(hullOf(item), kEdgePixels, setup));
}

}  // namespace cradle
