// Contacts beside held ones. An active contact or a joint may hold points of a pair together; other points of the pair,
// those that are not near a held one, may still collide. There are four kinds of gaps for them.
// A sphere that is held on a mesh: its distance from all triangles but those wholly behind the tangent planes of the
// held features. This distance has no jumps where the sphere goes from the space above one triangle to that above the
// next. A body that is held over one flat face: the height of its other points over the plane of the face, or the room
// that it has to the face's border and to surfaces in front, whichever is less. Any other pair: the least separation of
// its contacts that are not held. Where two lines that cross are all that touches, other points come down together as a
// face beside the edge of one becomes flush with the line of the other: the sine of their angle is a gap too.

#include "collision/contacts_beside_held.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "collision/closest_points.h"
#include "collision/impact_search_tolerances.h"
#include "collision/mesh_collider.h"
#include "collision/over_face.h"

namespace cradle {
namespace {

constexpr double kSameLine = 1e-6;  // sine: an edge at a smaller angle to a line is that line

/// The place (m, world) at which a contact is held together, on the surface of A.
Vec3 heldPlace(const ContactConstraint& contact, const VectorX& state) {
  const RigidTransform worldFromA = poseOf(state, contact.centerA.body),
                       worldFromB = poseOf(state, contact.surfaceB.body);
  const Vec3 center = worldFromA * contact.centerA.point, apart = center - worldFromB * contact.surfaceB.point;
  const Vec3 lineA = worldFromA.rotation * contact.lineA, lineB = worldFromB.rotation * contact.lineB;
  if (const Vec3 across = lineA.cross(lineB); !across.isZero(0)) {  // constraints/contact_rows.cpp has the formula
    const double along = -apart.cross(lineB).dot(across) / across.squaredNorm();
    return center + along * lineA - contact.radiusA * across.normalized();
  }
  const Vec3 normal = std::isinf(contact.radiusB) ? Vec3(worldFromB.rotation * contact.normalB)
                                                  : (apart - lineB.dot(apart) * lineB).normalized();
  const Vec3 axis = worldFromA.rotation * contact.rimAxisA;  // of a disc, else zero
  return center - contact.radiusA * (normal - normal.dot(axis) * axis).normalized();
}

/// Whether a place is on the rim of a disc that a contact holds by its lowest point, whichever that is.
bool isOnHeldRim(const ContactConstraint& contact, const Vec3& place, const VectorX& state, double near) {
  if (contact.rimAxisA.isZero(0)) return false;
  const Vec3 arm = poseOf(state, contact.centerA.body).inverse() * place - contact.centerA.point;
  const double height = contact.rimAxisA.dot(arm);
  return std::abs(height) < near && std::abs((arm - height * contact.rimAxisA).norm() - contact.radiusA) < near;
}

/// The edge of a polytope along a line through a point of it, both in its frame; null: there is none.
const Polytope::Edge* edgeAlong(const Collider& collider, const Vec3& point, const Vec3& line) {
  if (collider.kind() != ColliderKind::polytope) return nullptr;
  const std::vector<Vec3>& corners = collider.polytope->vertices;
  const Polytope::Edge* found = nullptr;
  double least = INFINITY;
  for (const Polytope::Edge& edge : collider.polytope->edges) {
    const Segment segment{corners[edge.from], corners[edge.to] - corners[edge.from]};
    if (segment.along.cross(line).norm() > kSameLine * segment.along.norm()) continue;
    const double distance = (segment.at(segment.nearestPart(point)) - point).norm();
    if (distance < least) least = distance, found = &edge;
  }
  return found;
}

/// How far the faces beside an edge of `collider` are from flush with another line, which crosses it: the least of the
/// sines by which they go back from the plane of both lines. `ahead` is the cross product of the lines, out of the
/// collider, in its frame; infinite without an edge.
double sineBesideEdge(const Collider& collider, const Vec3& point, const Vec3& line, const Vec3& ahead) {
  const Polytope::Edge* edge = edgeAlong(collider, point, line);
  if (!edge) return INFINITY;
  const Polytope& polytope = *collider.polytope;
  const Vec3 along = (polytope.vertices[edge->to] - polytope.vertices[edge->from]).normalized();
  const Vec3 inLeft = polytope.faces[edge->left].normal.cross(along),
             inRight = along.cross(polytope.faces[edge->right].normal);
  return -std::max(ahead.dot(inLeft), ahead.dot(inRight));
}

/// The least separation (m) of the ends of a capsule, and of corners that a capsule meets, that are not held. They may
/// come down on a line along their own that touches already: contacts show that only where both are parallel.
double gapOfEnds(const Collider& collider, const Collider& other, const RigidTransform& otherFromCollider,
                 const std::vector<Vec3>& held) {
  const bool isCapsule = collider.kind() == ColliderKind::capsule;
  if (!isCapsule && other.kind() != ColliderKind::capsule) return INFINITY;
  if (collider.kind() != ColliderKind::polytope && !isCapsule) return INFINITY;
  if (other.kind() == ColliderKind::mesh) return INFINITY;
  const double near = ImpactSearchTolerances(collider.boundingRadius).samePlace;
  double least = INFINITY;
  for (const Vec3& end : collider.points)
    if (std::none_of(held.begin(), held.end(), [&](const Vec3& place) { return (place - end).norm() < near; }))
      least = std::min(least, nearestSurfacePoint(other, otherFromCollider * end).distance - collider.radius);
  return least;
}

/// m: the same of both colliders of a pair that touches at a line.
double gapOfEnds(const ContactGeometry& geometry, std::size_t index, const std::vector<ActiveFeature>& held,
                 const VectorX& state) {
  const ColliderPair& pair = geometry.pairs[index];
  const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
  const RigidTransform aFromB = poseOf(state, a.body).inverse() * poseOf(state, b.body);
  std::vector<Vec3> heldOfA, heldOfB;
  bool isLineHeld = false;
  for (const ActiveFeature& feature : held) {
    const ContactConstraint& contact = feature.contact;
    if (feature.pair != index) continue;
    isLineHeld = isLineHeld || !contact.lineB.isZero(0);
    if (contact.lineA.isZero(0)) (contact.centerA.body == a.body ? heldOfA : heldOfB).push_back(contact.centerA.point);
  }
  if (!isLineHeld) return INFINITY;
  return std::min(gapOfEnds(a, b, aFromB.inverse(), heldOfA), gapOfEnds(b, a, aFromB, heldOfB));
}

/// m: that of a pair which one crossing of lines holds. No larger than the path of any point.
double gapBesideCrossing(const ContactGeometry& geometry, std::size_t index, const ContactConstraint& crossing,
                         const VectorX& state) {
  const ColliderPair& pair = geometry.pairs[index];
  const bool isOfB = geometry.colliders[pair.a].body == crossing.centerA.body;
  const Collider &a = geometry.colliders[isOfB ? pair.a : pair.b], &b = geometry.colliders[isOfB ? pair.b : pair.a];
  const RigidTransform worldFromA = poseOf(state, a.body), worldFromB = poseOf(state, b.body);
  const Vec3 outOfB = (worldFromA.rotation * crossing.lineA).cross(worldFromB.rotation * crossing.lineB);
  const double sine = std::min(
      sineBesideEdge(a, crossing.centerA.point, crossing.lineA, worldFromA.rotation.conjugate() * Vec3(-outOfB)),
      sineBesideEdge(b, crossing.surfaceB.point, crossing.lineB, worldFromB.rotation.conjugate() * outOfB));
  return sine * std::min(a.boundingRadius - a.radius, b.boundingRadius - b.radius);
}

/// Of a pair with a mesh that is held over one flat face; none of others.
std::optional<double> gapBesideFace(const ContactGeometry& geometry, std::size_t index,
                                    const std::vector<ActiveFeature>& held, const VectorX& state, double margin) {
  const ColliderPair& pair = geometry.pairs[index];
  if (!hasMesh(geometry.colliders[pair.a], geometry.colliders[pair.b])) return std::nullopt;
  OverFace over;
  std::vector<Vec3> points;
  for (const ActiveFeature& feature : held) {
    if (feature.pair != index) continue;
    if (!over.solid) over = overFace(geometry, pair, feature.contact, state);
    points.push_back(feature.contact.centerA.point);
  }
  if (!over.solid) return std::nullopt;
  return std::min(roomBeside(over, margin), heightOfOthers(over, points));
}

/// Of a sphere that is held on a mesh.
double gapBesideFeatures(std::size_t pair, const std::vector<ActiveFeature>& held, const SphereOverMesh& sphere,
                         double margin) {
  std::vector<std::vector<HalfSpace>> behind;
  for (const ActiveFeature& feature : held)
    if (feature.pair == pair) behind.push_back(spaceBehind(*sphere.mesh, feature.onMesh));
  return std::min(margin, distanceBeside(*sphere.mesh, behind, sphere.center, sphere.radius + margin) - sphere.radius);
}

}  // namespace

void findContactsBesideHeld(const ContactGeometry& geometry, std::size_t pair, const std::vector<ActiveFeature>& held,
                            const VectorX& state, double margin, std::vector<Contact>& contacts) {
  contacts.clear();
  appendContacts(geometry, pair, state, margin, contacts);
  const ColliderPair& colliders = geometry.pairs[pair];
  const double size =
      std::min(geometry.colliders[colliders.a].boundingRadius, geometry.colliders[colliders.b].boundingRadius);
  const double near = ImpactSearchTolerances(size).samePlace;
  std::erase_if(contacts, [&](const Contact& contact) {
    return std::any_of(held.begin(), held.end(), [&](const ActiveFeature& feature) {
      if (feature.pair != pair) return false;
      return (heldPlace(feature.contact, state) - contact.point).norm() < near ||
             isOnHeldRim(feature.contact, contact.point, state, near);
    });
  });
}

double gapBesideHeld(const ContactGeometry& geometry, std::size_t pair, const std::vector<ActiveFeature>& held,
                     const VectorX& state, double margin, std::vector<Contact>& scratch) {
  const SphereOverMesh sphere = sphereOverMesh(geometry, geometry.pairs[pair], state);
  const bool isAnyHeld =
      std::any_of(held.begin(), held.end(), [&](const ActiveFeature& feature) { return feature.pair == pair; });
  if (sphere.mesh && isAnyHeld) return gapBesideFeatures(pair, held, sphere, margin);
  if (const auto gap = gapBesideFace(geometry, pair, held, state, margin)) return std::min(margin, *gap);
  findContactsBesideHeld(geometry, pair, held, state, margin, scratch);
  double least = margin;
  for (const Contact& contact : scratch) least = std::min(least, contact.separation);
  least = std::min(least, gapOfEnds(geometry, pair, held, state));
  const auto isOfPair = [&](const ActiveFeature& feature) { return feature.pair == pair; };
  const auto first = std::find_if(held.begin(), held.end(), isOfPair);
  const bool isCrossing = first != held.end() && !first->contact.lineA.isZero(0);
  if (isCrossing && std::none_of(first + 1, held.end(), isOfPair))
    least = std::min(least, gapBesideCrossing(geometry, pair, first->contact, state));
  return least;
}

}  // namespace cradle
