#pragma once

#include <limits>
#include <vector>

#include "collision/polytope.h"

namespace cradle {

/// One point where two surfaces are near.
struct ContactPoint {
  Vec3 point = Vec3::Zero();   // m: middle between the two surfaces
  Vec3 normal = Vec3::Zero();  // unit, from A to B
  double separation = 0;       // m, < 0: overlap
  // m: radius of the ball that each surface is there: 0 a corner, infinite a flat face; NaN: neither (edge, side, rim).
  double radiusA = std::numeric_limits<double>::quiet_NaN(), radiusB = radiusA;
};

/// Signed separation (m) of two polytopes by the separating-axis theorem: over all face normals and products of edges
/// the largest gap between the projections. Its sign is exact; overlapping it is the least translation that separates
/// them; apart it is at most the distance. O(faces x vertices + edges^2 x vertices).
double separationOf(const Polytope& a, const Polytope& b, const RigidTransform& worldFromA,
                    const RigidTransform& worldFromB);

/// The points that carry contact (world), with separation <= margin: the incident face clipped against the reference
/// face (S. Gottschalk's separating axes; D. Gregorius, "Robust Contact Creation for Physics Simulations", GDC 2015),
/// or the nearest points of two crossing edges. Appends to `points`.
void appendContacts(const Polytope& a, const Polytope& b, const RigidTransform& worldFromA,
                    const RigidTransform& worldFromB, double margin, std::vector<ContactPoint>& points);

}  // namespace cradle
