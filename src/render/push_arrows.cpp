// A force has no size that could be compared with metres: lengths of arrows go with forces from a shortest to the
// longest of the film, which belongs to its greatest force; angles of arcs that show torques likewise.

#include "render/push_arrows.h"

#include <cmath>
#include <numbers>

#include "math/rotation.h"

namespace cradle {
namespace {

// Shares of the longest arrow.
constexpr double kHeadLength = 0.26, kHeadRadius = 0.085, kShaftRadius = 0.03;
constexpr int kFacets = 48;                       // around a head
constexpr double kLongestArc = std::numbers::pi;  // above its middle: none goes into a floor
constexpr int kSegments = 40;                     // of an arc
const Surface kSignalRed{Vec3f(0.82f, 0.09f, 0.015f), 0.0f, 0.45f};

void appendHead(const Appearance& appearance, const RigidTransform& worldFromHead, DrawList& list) {
  const DrawnMesh& head = appearance.meshes[static_cast<std::size_t>(appearance.arrowHeadMesh)];
  MeshItem item{appearance.arrowHeadMesh, 0, static_cast<std::uint32_t>(head.triangles.size())};
  item.worldFromMesh = worldFromHead;
  item.surface = kSignalRed;
  for (const Vec3& vertex : head.vertices) item.bounds.extend(item.worldFromMesh * vertex);
  list.meshes.push_back(item);
}

void appendArrow(const Appearance& appearance, const View& view, const ShownPush& push, const Vec3& tip,
                 DrawList& list) {
  const Vec3 direction = push.force.normalized();
  const Vec3 headStart = tip - kHeadLength * view.longestArrow * direction,
             tail = tip - view.arrowLength(push) * direction;
  appendHead(appearance, {rotationBetween(Vec3::UnitY(), direction), tip}, list);
  list.cylinders.push_back(
      {(tail + headStart) / 2, direction, kShaftRadius * view.longestArrow, (headStart - tail).norm(), kSignalRed});
}

/// An arc about the axis of a torque, its middle on top, from straight pieces that overlap, with a head where it ends.
void appendArc(const Appearance& appearance, const View& view, const ShownPush& push, const Vec3& center,
               DrawList& list) {
  const Vec3 axis = push.force.normalized();
  const Vec3 up = std::abs(axis.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitZ(),
             top = (up - up.dot(axis) * axis).normalized();
  const double radius = view.arcRadius(push), head = kHeadLength * view.longestArrow / radius;
  const double end = kLongestArc * view.arrowLength(push) / view.longestArrow, piece = (end - head) / kSegments;
  const auto outwards = [&](double angle) -> Vec3 { return rotationAbout(axis, angle - end / 2) * top; };
  const Vec3 pointing = axis.cross(outwards(end - head / 2));
  appendHead(appearance, {rotationBetween(Vec3::UnitY(), pointing), center + radius * outwards(end)}, list);
  for (int i = 0; i < kSegments; ++i) {
    const Vec3 out = outwards((i + 0.5) * piece);
    list.cylinders.push_back(
        {center + radius * out, axis.cross(out), kShaftRadius * view.longestArrow, 1.1 * radius * piece, kSignalRed});
  }
}

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
    if (!push.isShownAt(frame.time) || view.arrowLength(push) == 0) continue;
    const Vec3 point = push.pointAt(frame.time, worldFromBody);
    push.isTorque ? appendArc(appearance, view, push, point, list) : appendArrow(appearance, view, push, point, list);
  }
}

}  // namespace cradle
