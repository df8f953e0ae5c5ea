// T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2(1), 1997.

#include "mesh/ray_cast.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace cradle {
namespace {

// A ray that meets an edge between two triangles must not slip through by rounding: each triangle is taken larger by
// this part of its size.
constexpr double kEdgeTolerance = 1e-12;

std::optional<double> castRay(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 alongB = b - a, alongC = c - a, lever = ray.direction.cross(alongC);
  const double determinant = alongB.dot(lever);
  if (determinant == 0) return std::nullopt;  // parallel: its neighbours meet the ray
  const Vec3 fromA = ray.origin - a, normal = fromA.cross(alongB);
  const double u = fromA.dot(lever) / determinant, v = ray.direction.dot(normal) / determinant;
  if (!(u >= -kEdgeTolerance && v >= -kEdgeTolerance && u + v <= 1 + kEdgeTolerance)) return std::nullopt;
  const double distance = alongC.dot(normal) / determinant;
  return distance >= 0 ? std::optional(distance) : std::nullopt;
}

/// Keeps the nearest distance >= 0.
void keepNearest(double distance, std::optional<double>& nearest) {
  if (distance >= 0 && (!nearest || distance < *nearest)) nearest = distance;
}

/// Both distances at which a quadratic a t^2 + 2 b t + c is 0; none if a is 0 or the roots are complex.
std::array<std::optional<double>, 2> roots(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (a == 0 || discriminant < 0) return {};
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

std::array<std::optional<double>, 2> crossSphere(const Ray& ray, const Vec3& center, double radius) {
  const Vec3 from = ray.origin - center;
  return roots(1, from.dot(ray.direction), from.squaredNorm() - radius * radius);
}

/// Where the ray crosses the infinite cylinder about y.
std::array<std::optional<double>, 2> crossSide(const Ray& ray, double radius) {
  const Vec3 across(1, 0, 1), origin = ray.origin.cwiseProduct(across), direction = ray.direction.cwiseProduct(across);
  return roots(direction.squaredNorm(), origin.dot(direction), origin.squaredNorm() - radius * radius);
}

void keepSide(const Ray& ray, double radius, double length, std::optional<double>& nearest) {
  for (const auto& distance : crossSide(ray, radius))
    if (distance && std::abs(ray.origin.y() + *distance * ray.direction.y()) <= length / 2)
      keepNearest(*distance, nearest);
}

}  // namespace

std::optional<double> castRay(const Ray& ray, const Sphere& sphere) {
  std::optional<double> nearest;
  for (const auto& distance : crossSphere(ray, Vec3::Zero(), sphere.radius))
    if (distance) keepNearest(*distance, nearest);
  return nearest;
}

std::optional<double> castRay(const Ray& ray, const Box& box) {
  double enter = -INFINITY, leave = INFINITY;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double half = box.size[axis] / 2, origin = ray.origin[axis], direction = ray.direction[axis];
    if (direction == 0 && std::abs(origin) > half) return std::nullopt;
    if (direction == 0) continue;
    enter = std::max(enter, (-std::copysign(half, direction) - origin) / direction);
    leave = std::min(leave, (std::copysign(half, direction) - origin) / direction);
  }
  std::optional<double> nearest;
  if (enter > leave) return nearest;
  keepNearest(enter, nearest);
  keepNearest(leave, nearest);
  return nearest;
}

std::optional<double> castRay(const Ray& ray, const Cylinder& cylinder) {
  std::optional<double> nearest;
  keepSide(ray, cylinder.radius, cylinder.length, nearest);
  if (ray.direction.y() == 0) return nearest;
  for (const double end : {-cylinder.length / 2, cylinder.length / 2}) {
    const double distance = (end - ray.origin.y()) / ray.direction.y();
    const Vec3 hit = ray.origin + distance * ray.direction;
    if (Eigen::Vector2d(hit.x(), hit.z()).norm() <= cylinder.radius) keepNearest(distance, nearest);
  }
  return nearest;
}

std::optional<double> castRay(const Ray& ray, const Capsule& capsule) {
  std::optional<double> nearest;
  keepSide(ray, capsule.radius, capsule.length, nearest);
  for (const double end : {-capsule.length / 2, capsule.length / 2})
    for (const auto& distance : crossSphere(ray, end * Vec3::UnitY(), capsule.radius)) {
      const bool isOnCap = distance && (ray.origin.y() + *distance * ray.direction.y() - end) * end >= 0;
      if (isOnCap) keepNearest(*distance, nearest);
    }
  return nearest;
}

std::optional<double> castRay(const Ray& ray, const TriangleMesh& mesh) {
  std::optional<double> nearest;
  for (const Triangle& triangle : mesh.triangles) {
    const auto hit = castRay(ray, mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]);
    if (hit && (!nearest || *hit < *nearest)) nearest = hit;
  }
  return nearest;
}

}  // namespace cradle
