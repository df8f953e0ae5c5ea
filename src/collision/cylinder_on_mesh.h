#pragma once

#include <vector>

#include "collision/contact_point.h"
#include "collision/core.h"
#include "collision/mesh_nearest.h"

namespace cradle {

/// Signed separation (m) of a cylinder's core, in the mesh's frame, and a mesh. Apart: the distance. Where they
/// intersect: minus the largest over the triangles of the least way out of each; exact while that is less than the
/// triangles' size, continuous through 0. Inside: minus the distance of the surfaces. Infinite if above `enough` (m).
double cylinderSeparation(const Core& cylinder, const MeshSurface& mesh, double enough);

/// Contacts with separation <= margin (m), in the mesh's frame; A is the mesh. On a face what of the cylinder's end or
/// side is above it, on edges and corners a point each where the mesh lies behind the tangent plane, so that inner
/// edges of flat or hollow places give none. Appends to `contacts`.
void appendCylinderContacts(const Core& cylinder, const MeshSurface& mesh, double margin,
                            std::vector<ContactPoint>& contacts);

}  // namespace cradle
