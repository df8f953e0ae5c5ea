#include "collision/separation.h"

#include <limits>

#include "collision/polytope_contact.h"

namespace cradle {
namespace {

constexpr double kTurnRounding = 1e-14;  // of the distances that enter: a height taken in another frame is as good
constexpr double kFlat = std::numeric_limits<double>::infinity();  // m: radius of a plane

/// The two colliders of a pair that is not against a plane, in their poses.
struct PosedPair {
  const Collider &a, &b;
  RigidTransform worldFromA, worldFromB;
};

ContactPoint mirrored(const ContactPoint& contact) {
  return {contact.point, -contact.normal, contact.separation, contact.radiusB, contact.radiusA};
}

ContactPoint ballOnPlane(const Vec3& center, double radius, const PlaneCollider& plane) {
  const double separation = plane.normal.dot(center - plane.point) - radius;
  return {center - (radius + separation / 2) * plane.normal, -plane.normal, separation, radius, kFlat};
}

ContactPoint ballOnBall(const PosedPair& pair) {
  const Vec3 centerA = pair.worldFromA * pair.a.points[0];
  const Vec3 towardsB = pair.worldFromB * pair.b.points[0] - centerA;
  const double distance = towardsB.norm(), separation = distance - pair.a.radius - pair.b.radius;
  const Vec3 normal = distance > 0 ? Vec3(towardsB / distance) : Vec3(Vec3::UnitY());
  return {centerA + (pair.a.radius + separation / 2) * normal, normal, separation, pair.a.radius, pair.b.radius};
}

/// A is the ball, B the polytope.
ContactPoint ballOnPolytope(const PosedPair& pair) {
  const Vec3 center = pair.worldFromA * pair.a.points[0];
  const SurfacePoint surface = nearestSurfacePoint(*pair.b.polytope, pair.worldFromB.inverse() * center);
  const double separation = surface.distance - pair.a.radius;
  const Vec3 outward = pair.worldFromB.rotation * surface.normal;
  return {center - (pair.a.radius + separation / 2) * outward, -outward, separation, pair.a.radius, surface.radius};
}

/// The one contact of a pair in which a ball takes part.
ContactPoint ballContact(const PosedPair& pair) {
  if (pair.a.isBall() && pair.b.isBall()) return ballOnBall(pair);
  if (pair.a.isBall()) return ballOnPolytope(pair);
  return mirrored(ballOnPolytope({pair.b, pair.a, pair.worldFromB, pair.worldFromA}));
}

PosedPair posed(const ContactGeometry& geometry, const ColliderPair& pair, const RigidTransform& worldFromA,
                const RigidTransform& worldFromB) {
  return {geometry.colliders[pair.a], geometry.colliders[pair.b], worldFromA, worldFromB};
}

std::vector<ContactPoint> contactPoints(const ContactGeometry& geometry, const ColliderPair& pair,
                                        const RigidTransform& worldFromA, const RigidTransform& worldFromB,
                                        double margin) {
  std::vector<ContactPoint> points;
  const Collider& a = geometry.colliders[pair.a];
  if (pair.againstPlane) {
    std::vector<std::size_t> near;
    appendFeaturesWithin(geometry, pair, worldFromA, margin, near);
    for (const std::size_t point : near)
      points.push_back(ballOnPlane(worldFromA * a.points[point], a.radius, geometry.planes[pair.b]));
    return points;
  }
  const PosedPair both = posed(geometry, pair, worldFromA, worldFromB);
  if (both.a.isBall() || both.b.isBall())
    points.push_back(ballContact(both));
  else
    appendContacts(*both.a.polytope, *both.b.polytope, worldFromA, worldFromB, margin, points);
  return points;
}

}  // namespace

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
  // Heights over the plane in the body's frame: one product a point instead of a turn.
  const Collider& a = geometry.colliders[pair.a];
  const PlaneCollider& plane = geometry.planes[pair.b];
  const Vec3 normal = worldFromA.rotation.conjugate() * plane.normal;
  const double distance = (worldFromA.translation - plane.point).norm();
  const double rounding = kTurnRounding * (distance + a.boundingRadius);
  const double highest = reach + a.radius - plane.normal.dot(worldFromA.translation - plane.point) + rounding;
  for (std::size_t i = 0; i < a.points.size(); ++i)
    if (normal.dot(a.points[i]) <= highest) features.push_back(i);
}

double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature,
                  const RigidTransform& worldFromA, const RigidTransform& worldFromB) {
  const Collider& a = geometry.colliders[pair.a];
  if (pair.againstPlane)
    return ballOnPlane(worldFromA * a.points[feature], a.radius, geometry.planes[pair.b]).separation;
  const PosedPair both = posed(geometry, pair, worldFromA, worldFromB);
  if (both.a.isBall() || both.b.isBall()) return ballContact(both).separation;
  return separationOf(*both.a.polytope, *both.b.polytope, worldFromA, worldFromB);
}

double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature,
                  const VectorX& state) {
  return separation(geometry, pair, feature, poseOf(state, geometry.colliders[pair.a].body),
                    poseOf(state, bodyBOf(geometry, pair)));
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
  for (const ContactPoint& found : contactPoints(geometry, pair, worldFromA, worldFromB, margin))
    if (found.separation <= margin)
      contacts.push_back(
          {index, bodyA, bodyB, found.point, found.normal, found.separation, found.radiusA, found.radiusB});
}

void findContacts(const ContactGeometry& geometry, const VectorX& state, double margin,
                  std::vector<Contact>& contacts) {
  contacts.clear();
  for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair)
    appendContacts(geometry, pair, state, margin, contacts);
}

}  // namespace cradle
