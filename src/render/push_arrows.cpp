// A force has no size that could be compared with metres: lengths of arrows go with forces from a shortest to the
// longest of the film, which belongs to its greatest force.

#include "render/push_arrows.h"

#include <cmath>
#include <numbers>

#include "math/rotation.h"

namespace cradle {
namespace {

// Shares of the longest arrow.
constexpr double kHeadLength = 0.26, kHeadRadius = 0.085, kShaftRadius = 0.03;
constexpr int kFacets = 48;  // around a head
const Surface kSignalRed{Vec3f(0.82f, 0.09f, 0.015f), 0.0f, 0.45f};

}  // namespace

DrawnMesh makeArrowHead(double longestArrow) {
  const double length = kHeadLength * longestArrow, radius = kHeadRadius * longestArrow;
  DrawnMesh head;
  const auto add = [&head](const Vec3& vertex, const Vec3& normal) {
    head.vertices.push_back(vertex);
    head.normals.push_back(normal.normalized().cast<float>());
    return static_cast<std::uint32_t>(head.vertices.size() - 1);
  };
  for (int facet = 0; facet < kFacets; ++facet) {
    const auto directionAt = [&](double corner) {  // from z towards x, so that facets wind outwards
      const double angle = 2 * std::numbers::pi * corner / kFacets;
      return Vec3(std::sin(angle), 0, std::cos(angle));
    };
    const auto sideNormal = [&](const Vec3& out) { return Vec3(length * out + radius * Vec3::UnitY()); };
    const Vec3 down = -length * Vec3::UnitY();
    const Vec3 a = directionAt(facet), b = directionAt(facet + 1);
    const Vec3 left = down + radius * a, right = down + radius * b;
    const auto tip = add(Vec3::Zero(), sideNormal(directionAt(facet + 0.5)));
    head.triangles.push_back({tip, add(left, sideNormal(a)), add(right, sideNormal(b))});
    const auto middle = add(down, -Vec3::UnitY());
    head.triangles.push_back({middle, add(right, -Vec3::UnitY()), add(left, -Vec3::UnitY())});
  }
  return head;
}

void appendPushArrows(const Appearance& appearance, const View& view, const Frame& frame,
                      const std::vector<RigidTransform>& worldFromBody, DrawList& list) {
  for (const ShownPush& push : view.pushes) {
    const double length = view.arrowLength(push);
    if (!push.isShownAt(frame.time) || length == 0) continue;
    const Vec3 direction = push.force.normalized(), tip = push.pointAt(frame.time, worldFromBody);
    const Vec3 headStart = tip - kHeadLength * view.longestArrow * direction, tail = tip - length * direction;

    const DrawnMesh& head = appearance.meshes[static_cast<std::size_t>(appearance.arrowHeadMesh)];
    MeshItem item{appearance.arrowHeadMesh, 0, static_cast<std::uint32_t>(head.triangles.size())};
    item.worldFromMesh = {rotationBetween(Vec3::UnitY(), direction), tip};
    item.surface = kSignalRed;
    for (const Vec3& vertex : head.vertices) item.bounds.extend(item.worldFromMesh * vertex);
    list.meshes.push_back(item);
    list.cylinders.push_back(
        {(tail + headStart) / 2, direction, kShaftRadius * view.longestArrow, (headStart - tail).norm(), kSignalRed});
  }
}

}  // namespace cradle
