#pragma once

#include <vector>

#include "collision/contact_point.h"
#include "collision/mesh_nearest.h"

namespace cradle {

/// A sphere, or a capsule: all points within `radius` of a segment, in the mesh's frame.
struct RoundSolid {
  Segment core;       // m; of a sphere of no length
  double radius = 0;  // m, > 0

  bool isSphere() const { return core.along == Vec3::Zero(); }
};

/// Signed separation (m) of a sphere or capsule and a mesh: the distance of its core less the radius; of a core inside,
/// or through the surface, minus its depth, at an end or beneath an edge that it passes, less the radius. Exact for
/// separations above -radius. Infinite if above `enough` (m).
double separationOf(const RoundSolid& round, const MeshSurface& mesh, double enough);

/// Contacts with separation <= margin (m), in the mesh's frame; A is the sphere or capsule. One for each place where
/// the distance of its core from the surface is least among its neighbours': two in a groove, one on a flat face
/// however it is divided; a capsule that lies has one at each end. Appends to `contacts`.
void appendContacts(const RoundSolid& round, const MeshSurface& mesh, double margin,
                    std::vector<ContactPoint>& contacts);

}  // namespace cradle
