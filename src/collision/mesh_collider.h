#pragma once

#include <vector>

#include "collision/collider.h"
#include "collision/contact_point.h"

namespace cradle {

class FeatureNeighbourList;

/// Whether a pair is one of those below: a mesh takes part, and the other is a mesh too or what a mesh can touch.
bool hasMesh(const Collider& a, const Collider& b);

/// Signed separation (m) of a mesh and a mesh, polytope, sphere, capsule or cylinder, whichever is A; see
/// mesh_gap.h, round_on_mesh.h and cylinder_on_mesh.h. `enough` (m): what is farther apart need not be known, and may
/// be infinite. `near` is kept from call to call with these colliders; it changes nothing but the cost.
double meshSeparation(const Collider& a, const Collider& b, const RigidTransform& aFromB, double enough,
                      FeatureNeighbourList& near);

/// Their contacts with separation <= margin (m), in A's frame.
std::vector<ContactPoint> meshContacts(const Collider& a, const Collider& b, const RigidTransform& aFromB,
                                       double margin, FeatureNeighbourList& near);

/// The surface of a polytope as meshes touch it.
std::shared_ptr<const MeshSurface> surfaceOf(const Polytope& polytope);

}  // namespace cradle
