#include "render/arrows.h"

#include <cmath>
#include <numbers>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kShaftRadius = 0.03;  // share of the longest arrow
constexpr int kFacets = 48;            // around a head
constexpr int kSegments = 64;          // of an arc
const Surface kSignalRed{Vec3f(0.82f, 0.09f, 0.015f), 0.0f, 0.45f};

void appendHead(const Appearance& appearance, const ArrowLook& look, const RigidTransform& worldFromHead,
                DrawList& list) {
  const DrawnMesh& head = appearance.meshes[static_cast<std::size_t>(look.headMesh)];
  MeshItem item{look.headMesh, 0, static_cast<std::uint32_t>(head.triangles.size())};
  item.worldFromMesh = worldFromHead;
  item.surface = kSignalRed;
  for (const Vec3& vertex : head.vertices) item.bounds.extend(item.worldFromMesh * vertex);
  list.meshes.push_back(item);
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

void appendArrow(const Appearance& appearance, const ArrowLook& look, const Vec3& tail, const Vec3& tip,
                 DrawList& list) {
  const Vec3 direction = (tip - tail).normalized();
  const Vec3 headStart = tip - kHeadLength * look.longest * direction;
  appendHead(appearance, look, {rotationBetween(Vec3::UnitY(), direction), tip}, list);
  list.cylinders.push_back(
      {(tail + headStart) / 2, direction, kShaftRadius * look.longest, (headStart - tail).norm(), kSignalRed});
}

Vec3 middleOfArc(const Vec3& axis) {
  const Vec3 up = std::abs(axis.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitZ();
  return (up - up.dot(axis) * axis).normalized();
}

/// From straight pieces that overlap, with a head where it ends.
void appendArc(const Appearance& appearance, const ArrowLook& look, const Vec3& center, const Vec3& axis, double radius,
               double angle, DrawList& list) {
  const Vec3 top = middleOfArc(axis);
  const double head = kHeadLength * look.longest / radius, piece = (angle - head) / kSegments;
  const auto outwards = [&](double at) -> Vec3 { return rotationAbout(axis, at - angle / 2) * top; };
  const Vec3 pointing = axis.cross(outwards(angle - head / 2));
  appendHead(appearance, look, {rotationBetween(Vec3::UnitY(), pointing), center + radius * outwards(angle)}, list);
  for (int i = 0; i < kSegments; ++i) {
    const Vec3 out = outwards((i + 0.5) * piece);
    list.cylinders.push_back(
        {center + radius * out, axis.cross(out), kShaftRadius * look.longest, 1.1 * radius * piece, kSignalRed});
  }
}

}  // namespace cradle
