#pragma once

#include "mesh/mass_properties.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// Shapes given by numbers. All are centred on the origin of the body's frame.
struct Sphere {
  double radius = 1;  // m
};
struct Box {
  Vec3 size = Vec3::Ones();  // m, full edge lengths along x, y, z
};
struct Cylinder {
  double radius = 1;  // m
  double length = 1;  // m, along y
};
struct Capsule {
  double radius = 1;  // m
  double length = 1;  // m, along y, between the centres of the two caps
};
struct Plane {
  Vec3 normal = Vec3::UnitY();  // unit; the solid half-space lies against the normal
};

/// Closed forms at uniform `density` (kg/m^3, > 0).
MassProperties massProperties(const Sphere& sphere, double density);
MassProperties massProperties(const Box& box, double density);
MassProperties massProperties(const Cylinder& cylinder, double density);
MassProperties massProperties(const Capsule& capsule, double density);

/// The same of thin shells, caps included, of `density` x thickness (kg/m^2, > 0).
MassProperties shellProperties(const Sphere& sphere, double surfaceDensity);
MassProperties shellProperties(const Box& box, double surfaceDensity);
MassProperties shellProperties(const Cylinder& cylinder, double surfaceDensity);
MassProperties shellProperties(const Capsule& capsule, double surfaceDensity);

/// Closed drawn meshes, wound outwards, with the normals of the true shape; vertices lie on it. `segments` is the
/// number of facets around, at least 8 (a sphere has half as many rows, a cap of a capsule a quarter).
DrawnMesh tessellate(const Sphere& sphere, int segments = 64);
DrawnMesh tessellate(const Box& box);
DrawnMesh tessellate(const Cylinder& cylinder, int segments = 64);
DrawnMesh tessellate(const Capsule& capsule, int segments = 64);

}  // namespace cradle
