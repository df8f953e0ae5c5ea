#include "render/drawn_hull.h"

#include <cmath>
#include <map>

#include "render/camera.h"
#include "render/tube_curve.h"

namespace cradle {
namespace {

constexpr double kNearest =
    1e-3;  // of the distance to a sphere's centre: what is nearer to the camera's plane is not bounded

constexpr double kLong = 0.12;  // of the mesh's size: groups of triangles are as large as that

/// Slopes, sideways over forwards, of the two lines from the eye that touch a circle of radius r at (side, depth).
std::optional<std::pair<double, double>> tangentSlopes(double side, double depth, double r) {
  if (depth - r <= kNearest * depth) return std::nullopt;
  const double tangent = std::sqrt(side * side + depth * depth - r * r);
  return std::pair((side * tangent - r * depth) / (depth * tangent + r * side),
                   (side * tangent + r * depth) / (depth * tangent - r * side));
}

std::array<Vec3, 3> cornersOf(const DrawnMesh& mesh, std::uint32_t triangle) {
  const Triangle& corners = mesh.triangles[triangle];
  return {mesh.vertices[corners[0]], mesh.vertices[corners[1]], mesh.vertices[corners[2]]};
}

Bounds boxOf(const std::array<Vec3, 3>& corners) {
  Bounds box;
  for (const Vec3& corner : corners) box.extend(corner);
  return box;
}

Vec3 normalOf(const std::array<Vec3, 3>& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
}

/// What triangles of a group have in common: the cell in which their middle is, and about where they face.
using GroupKey = std::array<int, 4>;

GroupKey groupKey(const Vec3& middle, const Vec3& normal, double cell) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  int side = static_cast<int>(axis);
  for (const double number : normal) side = 2 * side + (number > 0);
  const auto at = [&](int i) { return static_cast<int>(std::floor(middle[i] / cell)); };
  return {at(0), at(1), at(2), side};
}

TriangleGroup groupOf(const DrawnMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  TriangleGroup group;
  group.first = triangles.front(), group.last = triangles.back();
  for (const std::uint32_t i : triangles) {
    const std::array<Vec3, 3> corners = cornersOf(mesh, i);
    group.box.extend(boxOf(corners));
    group.normal += normalOf(corners);
  }
  group.normal.normalize();
  for (const std::uint32_t i : triangles)
    group.normalSpread = std::max(group.normalSpread, (normalOf(cornersOf(mesh, i)) - group.normal).norm());
  return group;
}

double greatestNormalError(const DrawnMesh& mesh, const Vec3& middle) {
  double greatest = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    greatest = std::max(greatest, (mesh.normals[i].cast<double>() - (mesh.vertices[i] - middle).normalized()).norm());
  return greatest;
}

}  // namespace

Vec3 DrawnHull::middle() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) sum += centers[i];
  return sum / static_cast<double>(count);
}

Bounds DrawnHull::bounds() const {
  Bounds box;
  for (std::size_t i = 0; i < count; ++i)
    box.extend(Vec3(centers[i].array() - radius)), box.extend(Vec3(centers[i].array() + radius));
  return box;
}

double DrawnHull::reach() const {
  const Vec3 from = middle();
  double farthest = 0;
  for (std::size_t i = 0; i < count; ++i) farthest = std::max(farthest, (centers[i] - from).norm());
  return farthest + radius;
}

MeshBounds boundsOf(const DrawnMesh& mesh, bool isClosed) {
  MeshBounds bounds;
  bounds.isClosed = isClosed;
  for (const Vec3& vertex : mesh.vertices) bounds.whole.extend(vertex);
  if (mesh.triangles.empty()) return bounds;
  const double longest = kLong * bounds.whole.diagonal().norm();
  std::map<GroupKey, std::vector<std::uint32_t>> groups;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::array<Vec3, 3> corners = cornersOf(mesh, i);
    const Bounds box = boxOf(corners);
    if (i % kTrianglesPerRun == 0) bounds.runs.emplace_back();
    bounds.runs.back().extend(box);
    if (box.diagonal().norm() > longest) {
      bounds.longTriangles.push_back({i, corners});
      continue;
    }
    groups[groupKey(box.center() - bounds.whole.min(), normalOf(corners), longest)].push_back(i);
  }
  for (const auto& [key, triangles] : groups) bounds.groups.push_back(groupOf(mesh, triangles));
  bounds.normalError = greatestNormalError(mesh, bounds.whole.center());
  return bounds;
}

DrawnHull hullOf(const Bounds& local, const RigidTransform& worldFromLocal) {
  DrawnHull hull;
  for (int corner = 0; corner < 8; ++corner)
    hull.add(worldFromLocal * Vec3(local.corner(static_cast<Bounds::CornerType>(corner))));
  return hull;
}

DrawnHull hullOf(const SphereItem& item) {
  DrawnHull hull;
  hull.add(item.center);
  hull.radius = item.radius;
  return hull;
}

DrawnHull hullOf(const CylinderItem& item) {
  DrawnHull hull;
  hull.add(item.center - item.length / 2 * item.axis);
  hull.add(item.center + item.length / 2 * item.axis);
  hull.radius = item.radius;
  return hull;
}

DrawnHull hullOf(const TubeItem& item) {
  DrawnHull hull;
  for (const Vec3& corner : ropeCorners(item)) hull.add(corner);
  hull.radius = item.coilRadius + item.wireRadius;
  return hull;
}

DrawnHull swept(const DrawnHull& hull, const Vec3& first, const Vec3& last) {
  DrawnHull both;
  both.radius = hull.radius;
  for (std::size_t i = 0; i < hull.count; ++i) both.add(hull.centers[i] + first), both.add(hull.centers[i] + last);
  return both;
}

std::optional<std::vector<Eigen::Vector2d>> outlineOf(const DrawnHull& hull, const RenderSetup& setup) {
  const Mat3 axes = cameraAxes(setup.camera);
  const double pixelsPerSlope = setup.height / (2 * std::tan(setup.camera.verticalFieldOfView / 2));
  const auto column = [&](double slope) { return setup.width / 2.0 + pixelsPerSlope * slope; };
  const auto row = [&](double slope) { return setup.height / 2.0 + pixelsPerSlope * slope; };
  std::vector<Eigen::Vector2d> outline;
  for (std::size_t i = 0; i < hull.count; ++i) {
    const Vec3 seen = axes.transpose() * (hull.centers[i] - setup.camera.position);
    const auto across = tangentSlopes(seen.x(), -seen.z(), hull.radius);
    const auto up = tangentSlopes(seen.y(), -seen.z(), hull.radius);
    if (!across || !up) return std::nullopt;
    for (const double x : {across->first, across->second})
      for (const double y : {up->first, up->second}) outline.emplace_back(column(x), row(y));
  }
  return outline;
}

std::optional<std::vector<Eigen::Vector2d>> outlineOf(const std::vector<Vec3>& polygon, const RenderSetup& setup) {
  const Mat3 axes = cameraAxes(setup.camera);
  const double pixelsPerSlope = setup.height / (2 * std::tan(setup.camera.verticalFieldOfView / 2));
  const double nearest = kNearest * (setup.origin - setup.camera.position).norm();
  std::vector<Eigen::Vector2d> outline;
  for (const Vec3& corner : polygon) {
    const Vec3 seen = axes.transpose() * (corner - setup.camera.position);
    if (-seen.z() <= nearest) return std::nullopt;
    outline.emplace_back(setup.width / 2.0 + pixelsPerSlope * seen.x() / -seen.z(),
                         setup.height / 2.0 + pixelsPerSlope * seen.y() / -seen.z());
  }
  return outline;
}

}  // namespace cradle
