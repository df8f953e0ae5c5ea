#include "collision/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/contact_reduction.h"
#include "collision/core_separation.h"
#include "collision/feature_neighbour_list.h"
#include "collision/impact_search_tolerances.h"
#include "collision/manifold.h"
#include "collision/mesh_collider.h"
#include "collision/mesh_nearest.h"
#include "constraints/contact_groups.h"

namespace cradle {
namespace {

// Of the lengths that enter: about 90 unit roundoffs, more than a height over a plane, a sum of some ten products,
// differs between the body's frame and the world's.
constexpr double kFrameRounding = 1e-14;

/// The two colliders of a pair that is not against a plane, in their poses.
struct PosedPair {
  const Collider &a, &b;
  const RigidTransform &worldFromA, &worldFromB;
  FeatureNeighbourList* near = nullptr;  // kept with the pair
};

ContactPoint mirrored(const ContactPoint& contact) {
  return {contact.point, -contact.normal, contact.separation, contact.radiusB, contact.radiusA};
}

ContactPoint sphereOnPlane(const Vec3& center, double radius, const PlaneCollider& plane) {
  const double separation = plane.normal.dot(center - plane.point) - radius;
  return {center - (radius + separation / 2) * plane.normal, -plane.normal, separation, radius, kFlat};
}

/// A is the sphere.
ContactPoint sphereOnOther(const PosedPair& pair) {
  const Vec3 center = pair.worldFromA * pair.a.points[0];
  const SurfacePoint surface = nearestSurfacePoint(pair.b, pair.worldFromB.inverse() * center);
  const double separation = surface.distance - pair.a.radius;
  const Vec3 outward = pair.worldFromB.rotation * surface.normal;
  return {center - (pair.a.radius + separation / 2) * outward, -outward, separation, pair.a.radius, surface.radius};
}

/// Two spheres, in world coordinates: exact, where a rotation into the frame of one would round.
ContactPoint sphereOnSphere(const PosedPair& pair) {
  const Vec3 centerA = pair.worldFromA * pair.a.points[0];
  const Vec3 towardsB = pair.worldFromB * pair.b.points[0] - centerA;
  const double distance = towardsB.norm(), separation = distance - pair.a.radius - pair.b.radius;
  const Vec3 normal = distance > 0 ? Vec3(towardsB / distance) : Vec3(Vec3::UnitY());
  return {centerA + (pair.a.radius + separation / 2) * normal, normal, separation, pair.a.radius, pair.b.radius};
}

/// The one contact of a pair in which a sphere takes part.
ContactPoint sphereContact(const PosedPair& pair) {
  if (pair.a.isSphere() && pair.b.isSphere()) return sphereOnSphere(pair);
  if (pair.a.isSphere()) return sphereOnOther(pair);
  return mirrored(sphereOnOther({pair.b, pair.a, pair.worldFromB, pair.worldFromA, pair.near}));
}

bool hasSphere(const PosedPair& pair) {
  return pair.a.isSphere() || pair.b.isSphere();
}

/// The cores of a pair without a sphere, in the frame of A.
struct PosedCores {
  Core a, b;
  explicit PosedCores(const PosedPair& pair) : a(pair.a, {}), b(pair.b, pair.worldFromA.inverse() * pair.worldFromB) {}
};

double coreSeparation(const PosedPair& pair) {
  const PosedCores cores(pair);
  return separationOf(cores.a, cores.b).separation - pair.a.radius - pair.b.radius;
}

void placeInWorld(const PosedPair& pair, std::vector<ContactPoint>& points) {
  for (ContactPoint& contact : points) {
    contact.point = pair.worldFromA * contact.point;
    contact.normal = pair.worldFromA.rotation * contact.normal;
    contact.edge = pair.worldFromA.rotation * contact.edge;
  }
}

void appendOfCores(const PosedPair& pair, double margin, std::vector<ContactPoint>& points) {
  const PosedCores cores(pair);
  appendManifold(cores.a, cores.b, contactAxis(cores.a, cores.b), margin, points);
  placeInWorld(pair, points);
}

void appendOfMeshes(const PosedPair& pair, double margin, std::vector<ContactPoint>& points) {
  FeatureNeighbourList none;
  points =
      meshContacts(pair.a, pair.b, pair.worldFromA.inverse() * pair.worldFromB, margin, pair.near ? *pair.near : none);
  placeInWorld(pair, points);
}

/// Height (m) of a rim's lowest point over a plane.
double rimSeparation(const Collider& cylinder, std::size_t rim, const RigidTransform& worldFromBody,
                     const PlaneCollider& plane) {
  const Core core(cylinder, worldFromBody);
  return plane.normal.dot(core.rimPoint(rim == 0 ? 1 : -1, -plane.normal) - plane.point);
}

void appendOnPlane(const Collider& a, const RigidTransform& worldFromA, const PlaneCollider& plane,
                   const std::vector<std::size_t>& near, double margin, std::vector<ContactPoint>& points) {
  const bool hasManyCorners = a.polytope && near.size() > kMaxManifoldPoints;
  if (a.kind() == ColliderKind::cylinder || hasManyCorners)
    return appendManifold(Core(a, worldFromA), plane.point, plane.normal, margin, points);
  for (const std::size_t point : near) points.push_back(sphereOnPlane(worldFromA * a.points[point], a.radius, plane));
  if (near.size() > kMaxManifoldPoints) reduceContacts(0, a.boundingRadius, points);
}

std::vector<ContactPoint> contactPoints(const ContactGeometry& geometry, const ColliderPair& pair,
                                        const RigidTransform& worldFromA, const RigidTransform& worldFromB,
                                        double margin) {
  std::vector<ContactPoint> points;
  const Collider& a = geometry.colliders[pair.a];
  if (pair.againstPlane) {
    std::vector<std::size_t> near;
    appendFeaturesWithin(geometry, pair, worldFromA, margin, near);
    appendOnPlane(a, worldFromA, geometry.planes[pair.b], near, margin, points);
    return points;
  }
  const PosedPair both{a, geometry.colliders[pair.b], worldFromA, worldFromB, pair.near.get()};
  if (hasMesh(both.a, both.b))
    appendOfMeshes(both, margin, points);
  else if (hasSphere(both))
    points.push_back(sphereContact(both));
  else
    appendOfCores(both, margin, points);
  return points;
}

Vec3 pointVelocity(const Contact& contact, int body, const VectorX& places, const VectorX& velocities) {
  if (body == kFixed) return Vec3::Zero();
  const Vec3 arm = contact.point - centerOfMass(places, body);
  return linearVelocity(velocities, body) + angularVelocity(velocities, body).cross(arm);
}

bool isPinnedTo(const Collider& collider, int other) {
  return std::any_of(collider.pins.begin(), collider.pins.end(),
                     [&](const PinnedPlace& pin) { return pin.other == other; });
}

/// Whether a joint keeps the surface of a collider where it is at a contact: the point itself, or the centre of its
/// sphere there. `inwards` (unit) points into the collider.
bool isPinnedAt(const Collider& collider, int other, const ContactPoint& contact, double radius,
                const RigidTransform& frame, const Vec3& inwards) {
  if (!isPinnedTo(collider, other)) return false;
  const double tolerance = ImpactSearchTolerances(collider.boundingRadius).pinned;
  const Vec3 surface = contact.point + 0.5 * contact.separation * inwards;
  if (isPinned(collider, other, frame.inverse() * surface, tolerance)) return true;
  return std::isfinite(radius) &&
         isPinned(collider, other, frame.inverse() * Vec3(surface + radius * inwards), tolerance);
}

bool isPinnedContact(const ContactGeometry& geometry, const ColliderPair& pair, const ContactPoint& contact,
                     const RigidTransform& worldFromA, const RigidTransform& worldFromB) {
  const Collider& a = geometry.colliders[pair.a];
  if (isPinnedAt(a, bodyBOf(geometry, pair), contact, contact.radiusA, worldFromA, -contact.normal)) return true;
  return !pair.againstPlane &&
         isPinnedAt(geometry.colliders[pair.b], a.body, contact, contact.radiusB, worldFromB, contact.normal);
}

}  // namespace

bool hasPinnedPlaces(const ContactGeometry& geometry, const ColliderPair& pair) {
  const Collider& a = geometry.colliders[pair.a];
  return isPinnedTo(a, bodyBOf(geometry, pair)) ||
         (!pair.againstPlane && isPinnedTo(geometry.colliders[pair.b], a.body));
}

bool areOfOneFace(const std::vector<const Contact*>& contacts) {
  const Contact& first = *contacts[0];
  return std::all_of(contacts.begin(), contacts.end(), [&](const Contact* contact) {
    return contact->pair == first.pair && areParallel(contact->normal, first.normal);
  });
}

bool isPinnedFeature(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature) {
  const Collider& a = geometry.colliders[pair.a];
  return pair.againstPlane && !a.pins.empty() && a.kind() != ColliderKind::cylinder &&
         isPinned(a, kFixed, a.points[feature], ImpactSearchTolerances(a.boundingRadius).pinned);
}

Vec3 relativeVelocity(const Contact& contact, const VectorX& state) {
  return relativeVelocity(contact, state, state);
}

Vec3 relativeVelocity(const Contact& contact, const VectorX& places, const VectorX& velocities) {
  return pointVelocity(contact, contact.bodyB, places, velocities) -
         pointVelocity(contact, contact.bodyA, places, velocities);
}

double smallestSize(const Contact& contact, const std::vector<double>& sizes) {
  double size = INFINITY;
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed) size = std::min(size, sizes[static_cast<std::size_t>(body)]);
  return size;
}

double openingSpeed(const Contact& contact, const VectorX& state) {
  return contact.normal.dot(relativeVelocity(contact, state));
}

double openingAcceleration(const Contact& contact, const VectorX& state, const VectorX& rate) {
  return contact.normal.dot(pointAcceleration(contact.bodyB, contact.point, state, rate) -
                            pointAcceleration(contact.bodyA, contact.point, state, rate));
}

RigidTransform poseOf(const VectorX& state, int body) {
  if (body == kFixed) return {};
  return {orientation(state, body).normalized(), centerOfMass(state, body)};
}

int bodyBOf(const ContactGeometry& geometry, const ColliderPair& pair) {
  return pair.againstPlane ? kFixed : geometry.colliders[pair.b].body;
}

void appendFeaturesWithin(const ContactGeometry& geometry, const ColliderPair& pair, const RigidTransform& worldFromA,
                          double reach, std::vector<std::size_t>& features) {
  if (!pair.againstPlane) return features.push_back(0);
  // Heights over the plane are taken in the body's frame: one scalar product a point instead of a rotation.
  const Collider& a = geometry.colliders[pair.a];
  const PlaneCollider& plane = geometry.planes[pair.b];
  const Vec3 normal = worldFromA.rotation.conjugate() * plane.normal;
  if (a.kind() == ColliderKind::cylinder) {
    for (const std::size_t rim : {std::size_t{0}, std::size_t{1}})
      if (rimSeparation(a, rim, worldFromA, plane) <= reach) features.push_back(rim);
    return;
  }
  const double distance = (worldFromA.translation - plane.point).norm();
  const double rounding = kFrameRounding * (distance + a.boundingRadius);
  const double highest = reach + a.radius - plane.normal.dot(worldFromA.translation - plane.point) + rounding;
  for (std::size_t i = 0; i < a.points.size(); ++i)
    if (normal.dot(a.points[i]) <= highest && !isPinnedFeature(geometry, pair, i)) features.push_back(i);
}

double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature,
                  const RigidTransform& worldFromA, const RigidTransform& worldFromB, double enough) {
  const Collider& a = geometry.colliders[pair.a];
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry.planes[pair.b];
    if (a.kind() == ColliderKind::cylinder) return rimSeparation(a, feature, worldFromA, plane);
    return sphereOnPlane(worldFromA * a.points[feature], a.radius, plane).separation;
  }
  const PosedPair both{a, geometry.colliders[pair.b], worldFromA, worldFromB, pair.near.get()};
  if (hasMesh(both.a, both.b)) {
    FeatureNeighbourList none;
    return meshSeparation(both.a, both.b, worldFromA.inverse() * worldFromB, enough, both.near ? *both.near : none);
  }
  return hasSphere(both) ? sphereContact(both).separation : coreSeparation(both);
}

double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature,
                  const VectorX& state) {
  return separation(geometry, pair, feature, poseOf(state, geometry.colliders[pair.a].body),
                    poseOf(state, bodyBOf(geometry, pair)));
}

TouchedFeature touchedFeature(const Contact& contact) {
  using Feature = MeshPoint::Feature;
  if (!contact.lineA.isZero(0) || !contact.lineB.isZero(0)) return {Feature::edge, contact.feature};
  if (std::isinf(contact.radiusA) || std::isinf(contact.radiusB)) return {Feature::face, contact.feature};
  return {contact.radiusA == 0 || contact.radiusB == 0 ? Feature::vertex : Feature::none, contact.feature};
}

SphereOverMesh sphereOverMesh(const ContactGeometry& geometry, const ColliderPair& pair,
                              const RigidTransform& worldFromA, const RigidTransform& worldFromB) {
  if (pair.againstPlane) return {};
  const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
  const Collider &sphere = a.isSphere() ? a : b, &mesh = a.isSphere() ? b : a;
  if (!sphere.isSphere() || mesh.kind() != ColliderKind::mesh) return {};
  const RigidTransform &worldFromSphere = a.isSphere() ? worldFromA : worldFromB,
                       &worldFromMesh = a.isSphere() ? worldFromB : worldFromA;
  return {mesh.mesh.get(), (worldFromMesh * mesh.bodyFromMesh).inverse() * (worldFromSphere * sphere.points[0]),
          sphere.radius};
}

SphereOverMesh sphereOverMesh(const ContactGeometry& geometry, const ColliderPair& pair, const VectorX& state) {
  return sphereOverMesh(geometry, pair, poseOf(state, geometry.colliders[pair.a].body),
                        poseOf(state, bodyBOf(geometry, pair)));
}

Vec3 nearestOnSurface(const Collider& collider, const Vec3& point) {
  if (collider.kind() != ColliderKind::mesh) return nearestSurfacePoint(collider, point).nearest;
  return collider.bodyFromMesh * nearestPoint(*collider.mesh, collider.bodyFromMesh.inverse() * point).point;
}

double separationBound(const ContactGeometry& geometry, const ColliderPair& pair, const RigidTransform& worldFromA,
                       const RigidTransform& worldFromB) {
  const Collider& a = geometry.colliders[pair.a];
  if (a.body == kFixed) return -std::numeric_limits<double>::infinity();
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry.planes[pair.b];
    return plane.normal.dot(worldFromA.translation - plane.point) - a.boundingRadius;
  }
  const Collider& b = geometry.colliders[pair.b];
  if (b.body == kFixed) return -std::numeric_limits<double>::infinity();
  return (worldFromA.translation - worldFromB.translation).norm() - a.boundingRadius - b.boundingRadius;
}

void appendContacts(const ContactGeometry& geometry, std::size_t index, const VectorX& state, double margin,
                    std::vector<Contact>& contacts) {
  const ColliderPair& pair = geometry.pairs[index];
  const int bodyA = geometry.colliders[pair.a].body, bodyB = bodyBOf(geometry, pair);
  const RigidTransform worldFromA = poseOf(state, bodyA), worldFromB = poseOf(state, bodyB);
  if (separationBound(geometry, pair, worldFromA, worldFromB) > margin) return;
  for (const ContactPoint& found : contactPoints(geometry, pair, worldFromA, worldFromB, margin)) {
    if (found.separation > margin || isPinnedContact(geometry, pair, found, worldFromA, worldFromB)) continue;
    Contact& contact = contacts.emplace_back(
        Contact{index, bodyA, bodyB, found.point, found.normal, found.separation, found.radiusA, found.radiusB});
    contact.feature = found.feature;
    if (!found.edge.isZero(0) && std::isnan(found.radiusA)) contact.radiusA = 0, contact.lineA = found.edge;
    if (!found.edge.isZero(0) && std::isnan(found.radiusB)) contact.radiusB = 0, contact.lineB = found.edge;
  }
}

void findContacts(const ContactGeometry& geometry, const VectorX& state, double margin,
                  std::vector<Contact>& contacts) {
  contacts.clear();
  for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair)
    appendContacts(geometry, pair, state, margin, contacts);
}

}  // namespace cradle
