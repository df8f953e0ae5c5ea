// Where something holds points of a pair together, its other points may still come together: those that are not near a
// held one. A sphere that is held on a mesh may touch all triangles but those behind the tangent planes there: the
// distance from these has no jumps as the sphere goes from the space above one triangle to that above the next. Other
// bodies are over one flat face, and meet it with their other points as a plane, until they come near to its border or
// to what is in front.

#include <algorithm>
#include <cmath>

#include "collision/mesh_collider.h"
#include "collision/over_face.h"
#include "collision/time_of_impact.h"

namespace cradle {
namespace {

/// Where a contact is held together (m, world).
Vec3 heldPlace(const ContactConstraint& contact, const VectorX& state) {
  const RigidTransform worldFromB = poseOf(state, contact.surfaceB.body);
  const Vec3 center = poseOf(state, contact.centerA.body) * contact.centerA.point;
  const Vec3 apart = center - worldFromB * contact.surfaceB.point, edge = worldFromB.rotation * contact.edgeB;
  const Vec3 normal = std::isinf(contact.radiusB) ? Vec3(worldFromB.rotation * contact.normalB)
                                                  : (apart - edge.dot(apart) * edge).normalized();
  return center - contact.radiusA * normal;
}

}  // namespace

/// Contacts of a pair that are not held, to contacts_.
void ImpactSearch::findOthers(std::size_t pair, const std::vector<ActiveFeature>& held, const VectorX& state,
                              double margin) {
  contacts_.clear();
  appendContacts(geometry_, pair, state, margin, contacts_);
  const ColliderPair& colliders = geometry_.pairs[pair];
  const double near = kHeldPlace * std::min(geometry_.colliders[colliders.a].boundingRadius,
                                            geometry_.colliders[colliders.b].boundingRadius);
  std::erase_if(contacts_, [&](const Contact& contact) {
    return std::any_of(held.begin(), held.end(), [&](const ActiveFeature& feature) {
      if (feature.pair != pair) return false;
      return (heldPlace(feature.contact, state) - contact.point).norm() < near;
    });
  });
}

/// The least separation of points that are not held, at most `margin`.
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
