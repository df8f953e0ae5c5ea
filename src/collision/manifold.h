#pragma once

#include <vector>

#include "collision/contact_point.h"
#include "collision/separating_axis.h"

namespace cradle {

/// Points of a manifold. All corners of a box's face are among them. Twice as many would double the rows of a contact
/// and hold a body no better: points in one plane bear any load within their outline.
constexpr std::size_t kMaxManifoldPoints = 8;

/// Appends the points that carry contact between two colliders none of which is a sphere, with separation <= margin
/// (m), at most kMaxManifoldPoints; always one if `axis`, the contact axis of their cores, has that separation less the
/// radii of the spheres around them. A face and a feature along it share a polygon or a line, whose corners are the
/// points; parallel lines have the ends of the line that they share; other features have one point. In the frame of the
/// cores.
void appendManifold(const Core& a, const Core& b, const SeparatingAxis& axis, double margin,
                    std::vector<ContactPoint>& points);

/// The same for a collider, A, on a half-space.
void appendManifold(const Core& core, const Vec3& planePoint, const Vec3& planeNormal, double margin,
                    std::vector<ContactPoint>& points);

}  // namespace cradle
