#pragma once

#include <vector>

#include "collision/contact_point.h"
#include "collision/separating_axis.h"

namespace cradle {

/// Appends the points that carry contact between two colliders none of which is a sphere, with separation <= margin
/// (m), at most 8; always one if `axis`, the contact axis of their cores, has that separation less the spheres' radii.
/// Of a face and what lies along it the corners of what they share; of parallel lines the ends of what they share; else
/// one. In the frame of the cores.
void appendManifold(const Core& a, const Core& b, const SeparatingAxis& axis, double margin,
                    std::vector<ContactPoint>& points);

/// The same of a collider, A, on a half-space.
void appendManifold(const Core& core, const Vec3& planePoint, const Vec3& planeNormal, double margin,
                    std::vector<ContactPoint>& points);

}  // namespace cradle
