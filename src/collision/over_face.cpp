#include "collision/over_face.h"

#include <algorithm>
#include <cmath>

#include "collision/impact_search_tolerances.h"
#include "collision/mesh_collider.h"
#include "collision/mesh_surface.h"

namespace cradle {
namespace {

using Feature = MeshPoint::Feature;

// Between unit normals: a contact's normal is that of a face if it differs by less. A tenth or ten times as much
// changes no test.
constexpr double kFaceNormalError = 1e-6;

/// The face with the given normal at a point of a surface, or none.
TouchedFeature faceAt(const MeshSurface& surface, const Vec3& point, const Vec3& normal) {
  const MeshPoint nearest = nearestPoint(surface, point);
  std::vector<std::uint32_t> faces;
  if (nearest.feature == Feature::face) faces = {nearest.index};
  if (nearest.feature == Feature::edge)
    faces.assign(surface.edges[nearest.index].faces.begin(), surface.edges[nearest.index].faces.end());
  for (const std::uint32_t face : faces) {
    const std::uint32_t back = face + static_cast<std::uint32_t>(surface.faces.size() / 2);
    const std::uint32_t other = surface.isSheet ? back % static_cast<std::uint32_t>(surface.faces.size()) : face;
    for (const std::uint32_t side : {face, other})
      if ((surface.faces[side].normal - normal).norm() < kFaceNormalError) return {Feature::face, side};
  }
  return {};
}

}  // namespace

OverFace overFace(const ContactGeometry& geometry, const ColliderPair& pair, const ContactConstraint& contact,
                  const VectorX& state) {
  const bool isFaceOfA = geometry.colliders[pair.a].body == contact.surfaceB.body;
  const Collider &solid = geometry.colliders[isFaceOfA ? pair.b : pair.a],
                 &lower = geometry.colliders[isFaceOfA ? pair.a : pair.b];
  if (!std::isinf(contact.radiusB) || solid.kind() == ColliderKind::cylinder || solid.isSphere() || !lower.mesh)
    return {};
  const RigidTransform surfaceFromBody = lower.bodyFromMesh.inverse(), worldFromLower = poseOf(state, lower.body);
  const RigidTransform surfaceFromSolid = surfaceFromBody * worldFromLower.inverse() * poseOf(state, solid.body);
  const Vec3 normal = surfaceFromBody.rotation * contact.normalB;
  const Vec3 place = surfaceFromSolid * contact.centerA.point - contact.radiusA * normal;
  const TouchedFeature face = faceAt(*lower.mesh, place, normal);
  if (face.feature == Feature::none) return {};
  return {&solid, lower.mesh.get(), face, surfaceFromSolid};
}

double roomBeside(const OverFace& over, double reach) {
  const Vec3& center = over.surfaceFromSolid.translation;
  const double radius = over.solid->boundingRadius;
  const double inside = insideRegion(*over.surface, over.face, center) - radius;
  if (inside <= 0) return inside;
  const std::vector<std::vector<HalfSpace>> behind{spaceBehind(*over.surface, over.face)};
  return std::min(inside, distanceBeside(*over.surface, behind, center, radius + reach) - radius);
}

double heightOfOthers(const OverFace& over, const std::vector<Vec3>& held) {
  const HalfSpace plane = spaceBehind(*over.surface, over.face)[0];
  const double near = ImpactSearchTolerances(over.solid->boundingRadius).samePlace;
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& point : over.solid->points) {
    if (std::any_of(held.begin(), held.end(), [&](const Vec3& other) { return (point - other).norm() < near; }))
      continue;
    least = std::min(least, plane.normal.dot(over.surfaceFromSolid * point) - plane.offset - over.solid->radius);
  }
  return least;
}

}  // namespace cradle
