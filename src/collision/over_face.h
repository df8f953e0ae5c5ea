#pragma once

#include <vector>

#include "collision/separation.h"
#include "constraints/contact_rows.h"

namespace cradle {

/// A body that a contact keeps on a flat face of a mesh, or of a polytope that touches meshes, by a corner or by the
/// sphere at the end of a capsule. As long as all of it is over that face alone, the face is as good as a plane.
struct OverFace {
  const Collider* solid = nullptr;       // null: no such contact
  const MeshSurface* surface = nullptr;  // with the face
  TouchedFeature face;
  RigidTransform surfaceFromSolid;
};

/// `contact` is what keeps the pair together in `state`. Not of spheres and cylinders.
OverFace overFace(const ContactGeometry& geometry, const ColliderPair& pair, const ContactConstraint& contact,
                  const VectorX& state);

/// How far (m) a sphere around the body is from the border of the face, and from all that is in front of it; not known
/// beyond `reach` (m).
double roomBeside(const OverFace& over, double reach);

/// The least height (m) over the face of the body's points, but for those that are held (in the body's frame).
double heightOfOthers(const OverFace& over, const std::vector<Vec3>& held);

}  // namespace cradle
