#pragma once

#include "mesh/triangle_mesh.h"

namespace cradle {

/// Inertial parameters of a rigid body, in the frame of the mesh they came from.
struct MassProperties {
  double mass = 0;                    // kg, > 0
  Vec3 centerOfMass = Vec3::Zero();   // m
  Mat3 inertiaTensor = Mat3::Zero();  // kg m^2, about centerOfMass, symmetric positive definite
};

/// Volume enclosed by `mesh` in m^3; negative if it is wound inside-out. O(triangles).
double signedVolume(const TriangleMesh& mesh);

/// Mass properties of the solid bounded by `mesh`, filled with uniform `density` (kg/m^3).
/// The mesh must be closed and wound counter-clockwise seen from outside, its volume positive; density > 0.
/// O(triangles).
MassProperties computeMassProperties(const TriangleMesh& mesh, double density);

/// Mass properties of a shell of a `thickness` (m, > 0) that is small against its radii of curvature: the triangles of
/// `mesh` as a sheet of uniform `density` (kg/m^3, > 0). They may be open, and wound in any way; their area is
/// positive. O(triangles).
MassProperties computeShellProperties(const TriangleMesh& mesh, double thickness, double density);

}  // namespace cradle
