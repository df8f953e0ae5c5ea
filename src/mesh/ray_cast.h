#pragma once

#include <optional>

#include "mesh/primitives.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// A half-line. In the frame of what it is cast against.
struct Ray {
  Vec3 origin = Vec3::Zero();       // m
  Vec3 direction = -Vec3::UnitZ();  // unit
};

/// Distance (m, >= 0) along the ray to the first triangle that it meets, from either side; nothing if it misses all.
/// Rays through an edge or a corner hit. O(triangles).
std::optional<double> castRay(const Ray& ray, const TriangleMesh& mesh);

/// The same for the surfaces of primitives, in closed form.
std::optional<double> castRay(const Ray& ray, const Sphere& sphere);
std::optional<double> castRay(const Ray& ray, const Box& box);
std::optional<double> castRay(const Ray& ray, const Cylinder& cylinder);
std::optional<double> castRay(const Ray& ray, const Capsule& capsule);

}  // namespace cradle
