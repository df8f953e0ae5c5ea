// Contacts beside held ones. An active contact or a joint may hold points of a pair together; other points of the pair,
// those that are not near a held one, may still collide. There are three kinds of gaps for them.
// A sphere that is held on a mesh: its distance from all triangles but those wholly behind the tangent planes of the
// held features. This distance has no jumps where the sphere goes from the space above one triangle to that above the
// next. A body that is held over one flat face: the height of its other points over the plane of the face, or the room
// that it has to the face's border and to surfaces in front, whichever is less. Any other pair: the least separation of
// its contacts that are not held.

#include <algorithm>
#include <cmath>

#include "collision/impact_search_tolerances.h"
#include "collision/mesh_collider.h"
#include "collision/over_face.h"
#include "collision/time_of_impact.h"

namespace cradle {
namespace {

/// The place (m, world) at which a contact is held together, on the surface of A.
Vec3 heldPlace(const ContactConstraint& contact, const VectorX& state) {
  const RigidTransform worldFromB = poseOf(state, contact.surfaceB.body);
  const Vec3 center = poseOf(state, contact.centerA.body) * contact.centerA.point;
  const Vec3 apart = center - worldFromB * contact.surfaceB.point, edge = worldFromB.rotation * contact.edgeB;
  const Vec3 normal = std::isinf(contact.radiusB) ? Vec3(worldFromB.rotation * contact.normalB)
                                                  : (apart - edge.dot(apart) * edge).normalized();
  return center - contact.radiusA * normal;
}

}  // namespace

/// Puts those contacts of a pair that are not held into contacts_.
void ImpactSearch::findOthers(std::size_t pair, const std::vector<ActiveFeature>& held, const VectorX& state,
                              double margin) {
  contacts_.clear();
  appendContacts(geometry_, pair, state, margin, contacts_);
  const ColliderPair& colliders = geometry_.pairs[pair];
  const double size =
      std::min(geometry_.colliders[colliders.a].boundingRadius, geometry_.colliders[colliders.b].boundingRadius);
  const double near = ImpactSearchTolerances(size).samePlace;
  std::erase_if(contacts_, [&](const Contact& contact) {
    return std::any_of(held.begin(), held.end(), [&](const ActiveFeature& feature) {
      if (feature.pair != pair) return false;
      return (heldPlace(feature.contact, state) - contact.point).norm() < near;
    });
  });
}

/// The least separation (m) of points that are not held; `margin` (m) if that is less.
double ImpactSearch::gapOfOthers(std::size_t pair, const std::vector<ActiveFeature>& held, const VectorX& state,
                                 double margin) {
  const SphereOverMesh sphere = sphereOverMesh(geometry_, geometry_.pairs[pair], state);
  const bool isAnyHeld =
      std::any_of(held.begin(), held.end(), [&](const ActiveFeature& feature) { return feature.pair == pair; });
  if (sphere.mesh && isAnyHeld) return gapBesideFeatures(pair, held, sphere, margin);
  if (const auto gap = gapBesideFace(pair, held, state, margin)) return std::min(margin, *gap);
  findOthers(pair, held, state, margin);
  double least = margin;
  for (const Contact& contact : contacts_) least = std::min(least, contact.separation);
  return least;
}

std::optional<double> ImpactSearch::gapBesideFace(std::size_t index, const std::vector<ActiveFeature>& held,
                                                  const VectorX& state, double margin) const {
  const ColliderPair& pair = geometry_.pairs[index];
  if (!hasMesh(geometry_.colliders[pair.a], geometry_.colliders[pair.b])) return std::nullopt;
  OverFace over;
  std::vector<Vec3> points;
  for (const ActiveFeature& feature : held) {
    if (feature.pair != index) continue;
    if (!over.solid) over = overFace(geometry_, pair, feature.contact, state);
    points.push_back(feature.contact.centerA.point);
  }
  if (!over.solid) return std::nullopt;
  return std::min(roomBeside(over, margin), heightOfOthers(over, points));
}

double ImpactSearch::gapBesideFeatures(std::size_t pair, const std::vector<ActiveFeature>& held,
                                       const SphereOverMesh& sphere, double margin) {
  std::vector<std::vector<HalfSpace>> behind;
  for (const ActiveFeature& feature : held)
    if (feature.pair == pair) behind.push_back(spaceBehind(*sphere.mesh, feature.onMesh));
  return std::min(margin, distanceBeside(*sphere.mesh, behind, sphere.center, sphere.radius + margin) - sphere.radius);
}

}  // namespace cradle
