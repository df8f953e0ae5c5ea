// Each test proposes a placement from few vertices, then holds all of them against it. Numbers in a mesh file are
// mostly floats, exact to 6e-8: hence 1e-6 of the size; or text of so many decimals, which tell how exact it is.

#include "mesh/recognise_shape.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "math/rotation.h"
#include "mesh/convex.h"
#include "mesh/mass_properties.h"
#include "mesh/solid.h"

namespace cradle {
namespace {

constexpr double kTolerance = 1e-6;        // of the size
constexpr double kMaxSlack = 1e-4;         // of the size: rounding to fewer digits makes other shapes
constexpr int kMaxDecimals = 9;            // m: lengths of scenes are no smaller
constexpr double kFacetTolerance = 0.01;   // of the radius: how far inside a curved surface a facet may lie
constexpr std::size_t kFewestFaces = 200;  // of a sphere

// A mesh with what several of the tests ask for.
struct Candidate {
  const TriangleMesh& mesh;
  MassProperties properties;    // at density 1
  std::vector<Vec3> midpoints;  // m, of the triangles
  double slack = 0;             // m: by which vertices may be off because of their decimals

  double tolerance(double size) const { return kTolerance * size + slack; }  // m
  bool isNear(double a, double b, double size) const { return std::abs(a - b) <= tolerance(size); }
};

Bounds boundsOf(const TriangleMesh& mesh) {
  Bounds bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  return bounds;
}

// How many coordinates are decimals in steps of `step` (m), up to the rounding of floats.
std::size_t countDecimals(double step, const TriangleMesh& mesh) {
  constexpr double kFloatRounding = 1e-7;
  std::size_t count = 0;
  for (const Vec3& vertex : mesh.vertices)
    for (const double x : vertex) count += std::abs(x - step * std::round(x / step)) <= kFloatRounding * std::abs(x);
  return count;
}

// How far (m) two vertices may be off each other because they were rounded to decimals; 0 if they were not. Rounding
// leaves nine of ten coordinates with the last of the places; lengths that are few decimals by nature do not.
double slackOf(const TriangleMesh& mesh) {
  const double size = boundsOf(mesh).diagonal().norm();
  const std::size_t all = 3 * mesh.vertices.size();
  std::size_t before = 0;  // with one place less
  double parts = 1;        // of a m
  for (int places = 0; places <= kMaxDecimals; ++places, parts *= 10) {
    const double step = 1 / parts;
    if (step < kTolerance * size / 10) return 0;  // floats are no more exact
    const std::size_t count = countDecimals(step, mesh);
    if (count == all) return 2 * before > all ? 0 : std::min(std::numbers::sqrt3 * step, kMaxSlack * size);
    before = count;
  }
  return 0;
}

// The right-handed order and signs of three axes that turn least from x, y, z; sizes go with them.
void alignWithFrame(Mat3& axes, Vec3& size) {
  std::array<int, 3> order{0, 1, 2};
  Mat3 best = Mat3::Zero();
  Vec3 bestSize = size;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 turned;
      for (int i = 0; i < 3; ++i)
        turned.col(i) = (signs >> i & 1 ? -1 : 1) * axes.col(order[static_cast<std::size_t>(i)]);
      if (turned.determinant() < 0 || (best != Mat3::Zero() && turned.trace() <= best.trace())) continue;
      best = turned;
      bestSize = Vec3(size[order[0]], size[order[1]], size[order[2]]);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  axes = best;
  size = bestSize;
}

// Whether the eight vertices are those of the box with one corner at `corner` and `edges` from it, each once.
bool hasCornersOf(const Vec3& corner, const Mat3& edges, const TriangleMesh& mesh, double tolerance) {
  unsigned seen = 0;
  for (const Vec3& vertex : mesh.vertices)
    for (unsigned c = 0; c < 8; ++c) {
      const Vec3 expected = corner + edges * Vec3(c & 1 ? 1 : 0, c & 2 ? 1 : 0, c & 4 ? 1 : 0);
      if ((vertex - expected).norm() <= tolerance) seen |= 1U << c;
    }
  return seen == 0xFF;
}

std::optional<PlacedPrimitive> findBox(const Candidate& candidate) {
  const TriangleMesh& mesh = candidate.mesh;
  if (mesh.vertices.size() != 8) return {};
  const double size = boundsOf(mesh).diagonal().norm();
  const std::vector<Vec3>& vertices = mesh.vertices;
  const Vec3& corner = vertices[0];
  const auto edge = [&](std::size_t i) { return Vec3(vertices[i] - corner); };
  const auto isRightAngle = [&](const Vec3& a, const Vec3& b) {
    return std::abs(a.dot(b)) <= kTolerance * a.norm() * b.norm() + candidate.slack * (a.norm() + b.norm());
  };
  for (std::size_t i = 1; i < 8; ++i)
    for (std::size_t j = i + 1; j < 8; ++j)
      for (std::size_t k = j + 1; k < 8; ++k) {
        Mat3 edges;
        edges << edge(i), edge(j), edge(k);
        if (!isRightAngle(edge(i), edge(j)) || !isRightAngle(edge(j), edge(k)) || !isRightAngle(edge(k), edge(i)))
          continue;
        Vec3 lengths = edges.colwise().norm();
        if (!hasCornersOf(corner, edges, mesh, 2 * candidate.tolerance(size))) continue;
        const double relative = 10 * kTolerance + 3 * candidate.slack / lengths.minCoeff();
        if (std::abs(candidate.properties.mass - lengths.prod()) > relative * lengths.prod()) return {};
        const Vec3 center = corner + edges * Vec3::Constant(0.5);
        Mat3 axes = edges.colwise().normalized();
        alignWithFrame(axes, lengths);
        return PlacedPrimitive{Box{lengths}, {Quat(axes).normalized(), center}};
      }
  return {};
}

std::optional<PlacedPrimitive> findSphere(const Candidate& candidate) {
  const TriangleMesh& mesh = candidate.mesh;
  if (mesh.triangles.size() < kFewestFaces) return {};
  Vec3 center = Vec3::Zero();
  for (const Vec3& vertex : mesh.vertices) center += vertex;
  center /= static_cast<double>(mesh.vertices.size());
  double radius = 0;
  for (const Vec3& vertex : mesh.vertices) radius += (vertex - center).norm();
  radius /= static_cast<double>(mesh.vertices.size());

  const auto isOn = [&](const Vec3& v) { return candidate.isNear((v - center).norm(), radius, radius); };
  if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), isOn)) return {};
  const auto isFlush = [&](const Vec3& m) { return (m - center).norm() >= (1 - kFacetTolerance) * radius; };
  if (!std::all_of(candidate.midpoints.begin(), candidate.midpoints.end(), isFlush)) return {};

  // Most spheres have vertices on the axes of their frame. Those give the radius without the rounding of all others,
  // so that balls meant to touch do touch.
  const Bounds bounds = boundsOf(mesh);
  const Vec3 half = bounds.sizes() / 2;
  if ((half.array() - radius).abs().maxCoeff() <= candidate.tolerance(radius))
    return PlacedPrimitive{Sphere{half.maxCoeff()}, {Quat::Identity(), bounds.center()}};
  return PlacedPrimitive{Sphere{radius}, {Quat::Identity(), center}};
}

// Extent of the mesh along a unit axis through its centre of mass, and across.
struct AxialExtent {
  Vec3 axis, through;        // unit; m
  double low, high, across;  // m
};

AxialExtent measureAlong(const Vec3& direction, const Candidate& candidate) {
  const Vec3 axis = direction.y() < 0 ? Vec3(-direction) : direction;
  AxialExtent extent{axis, candidate.properties.centerOfMass, 0, 0, 0};
  for (const Vec3& vertex : candidate.mesh.vertices) {
    const Vec3 from = vertex - extent.through;
    extent.low = std::min(extent.low, axis.dot(from));
    extent.high = std::max(extent.high, axis.dot(from));
    extent.across = std::max(extent.across, axis.cross(from).norm());
  }
  return extent;
}

RigidTransform placedAlong(const AxialExtent& extent) {
  return {rotationBetween(Vec3::UnitY(), extent.axis), extent.through + (extent.low + extent.high) / 2 * extent.axis};
}

// Of a point in the shape's frame: how far outside the surface it is.
using SurfaceDistance = std::function<double(const Vec3&)>;

bool fits(const Candidate& candidate, const RigidTransform& bodyFromShape, double radius, double size,
          const SurfaceDistance& distance) {
  const RigidTransform shapeFromBody = bodyFromShape.inverse();
  const auto isOn = [&](const Vec3& v) { return std::abs(distance(shapeFromBody * v)) <= candidate.tolerance(size); };
  const auto isFlush = [&](const Vec3& m) { return std::abs(distance(shapeFromBody * m)) <= kFacetTolerance * radius; };
  return std::all_of(candidate.mesh.vertices.begin(), candidate.mesh.vertices.end(), isOn) &&
         std::all_of(candidate.midpoints.begin(), candidate.midpoints.end(), isFlush);
}

double fromAxis(const Vec3& point) {  // m, of a shape around y
  return Eigen::Vector2d(point.x(), point.z()).norm();
}

std::optional<PlacedPrimitive> fitCylinder(const AxialExtent& extent, const Candidate& candidate) {
  const double radius = extent.across, length = extent.high - extent.low;
  const SurfaceDistance distance = [&](const Vec3& p) {
    const double outsideSide = fromAxis(p) - radius, outsideEnd = std::abs(p.y()) - length / 2;
    return std::max(outsideSide, outsideEnd);
  };
  const RigidTransform place = placedAlong(extent), shapeFromBody = place.inverse();
  const double size = std::max(radius, length);
  if (!fits(candidate, place, radius, size, distance)) return {};
  // Vertices of the ends may be anywhere there; those of all other faces are on the side.
  for (const Triangle& triangle : candidate.mesh.triangles) {
    std::array<Vec3, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = shapeFromBody * candidate.mesh.vertices[triangle[c]];
    const auto isOnEnd = [&](double end) {
      return std::all_of(corners.begin(), corners.end(),
                         [&](const Vec3& p) { return candidate.isNear(p.y(), end, size); });
    };
    const auto isOnSide = [&](const Vec3& p) { return candidate.isNear(fromAxis(p), radius, size); };
    if (!isOnEnd(length / 2) && !isOnEnd(-length / 2) && !std::all_of(corners.begin(), corners.end(), isOnSide))
      return {};
  }
  return PlacedPrimitive{Cylinder{radius, length}, place};
}

std::optional<PlacedPrimitive> fitCapsule(const AxialExtent& extent, const Candidate& candidate) {
  const double radius = extent.across, length = extent.high - extent.low - 2 * radius;
  if (length <= candidate.tolerance(radius)) return {};
  const SurfaceDistance distance = [&](const Vec3& p) {
    const double beyond = std::max(0.0, std::abs(p.y()) - length / 2);
    return Vec3(p.x(), beyond, p.z()).norm() - radius;
  };
  const RigidTransform place = placedAlong(extent);
  if (!fits(candidate, place, radius, radius + length, distance)) return {};
  return PlacedPrimitive{Capsule{radius, length}, place};
}

// Directions in which an axis of revolution may point: principal axes of inertia and of the surface's normals (a
// cylinder with length^2 = 3 radius^2 has none of the former, one with length = 2 radius none of the latter).
std::vector<Vec3> likelyAxes(const Candidate& candidate) {
  const TriangleMesh& mesh = candidate.mesh;
  Mat3 normals = Mat3::Zero();
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3& a = mesh.vertices[i];
    const Vec3 area = (mesh.vertices[j] - a).cross(mesh.vertices[k] - a);
    if (area.norm() > 0) normals += area * area.transpose() / area.norm();
  }
  std::vector<Vec3> axes;
  for (const Mat3& tensor : {candidate.properties.inertiaTensor, normals}) {
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(tensor);
    axes.push_back(principal.eigenvectors().col(0));
    axes.push_back(principal.eigenvectors().col(2));
  }
  return axes;
}

// Axes of a frame are meant exactly, where numbers of the file come as close as they can.
Vec3 snapped(const Vec3& axis, const Candidate& candidate) {
  constexpr double kFloatRounding = 1e-7;
  const double rounding = kFloatRounding + candidate.slack / boundsOf(candidate.mesh).diagonal().norm();
  for (int i = 0; i < 3; ++i)
    if ((axis.cwiseAbs() - Vec3::Unit(i)).norm() < rounding) return Vec3::Unit(i);
  return axis;
}

std::optional<PlacedPrimitive> findRevolved(const Candidate& candidate) {
  for (const Vec3& axis : likelyAxes(candidate)) {
    const AxialExtent extent = measureAlong(snapped(axis, candidate), candidate);
    if (const auto cylinder = fitCylinder(extent, candidate)) return cylinder;
    if (const auto capsule = fitCapsule(extent, candidate)) return capsule;
  }
  return {};
}

}  // namespace

RecognisedShape recogniseShape(const TriangleMesh& mesh) {
  if (!checkSolid(mesh).isSolid) return {};
  Candidate candidate{mesh, computeMassProperties(mesh, 1), {}, slackOf(mesh)};
  for (const auto& [i, j, k] : mesh.triangles)
    candidate.midpoints.push_back((mesh.vertices[i] + mesh.vertices[j] + mesh.vertices[k]) / 3);
  for (const auto& find : {findBox, findSphere, findRevolved})
    if (const auto primitive = find(candidate)) return {primitive, true};
  return {std::nullopt, isConvex(mesh, candidate.slack)};
}

std::string shapeName(const RecognisedShape& shape) {
  if (!shape.primitive) return shape.isConvex ? "convex" : "mesh";
  constexpr std::array kNames{"sphere", "box", "cylinder", "capsule"};  // in the order of the variant
  return kNames[shape.primitive->shape.index()];
}

}  // namespace cradle
