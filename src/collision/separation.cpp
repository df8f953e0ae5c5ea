#include "collision/separation.h"

namespace cradle {
namespace {

const BallsCollider& ballsA(const ContactGeometry& geometry, const ColliderPair& pair) {
  return geometry.balls[pair.a];
}

int bodyBOf(const ContactGeometry& geometry, const ColliderPair& pair) {
  return pair.againstPlane ? kFixed : geometry.balls[pair.b].body;
}

/// No feature of the pair can be nearer than this.
double separationBound(const ContactGeometry& geometry, const ColliderPair& pair, const VectorX& state) {
  const BallsCollider& a = ballsA(geometry, pair);
  const Vec3 centre = poseOf(state, a.body).translation;
  if (a.body == kFixed) return 0;
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry.planes[pair.b];
    return plane.normal.dot(centre - plane.point) - a.boundingRadius;
  }
  const BallsCollider& b = geometry.balls[pair.b];
  if (b.body == kFixed) return 0;
  return (centre - poseOf(state, b.body).translation).norm() - a.boundingRadius - b.boundingRadius;
}

}  // namespace

RigidTransform poseOf(const VectorX& state, int body) {
  if (body == kFixed) return {};
  return {orientation(state, body).normalized(), centerOfMass(state, body)};
}

std::size_t featureCount(const ContactGeometry& geometry, const ColliderPair& pair) {
  return ballsA(geometry, pair).points.size();
}

double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature,
                  const RigidTransform& worldFromA, const RigidTransform& worldFromB) {
  const BallsCollider& a = ballsA(geometry, pair);
  const Vec3 centreA = worldFromA * a.points[feature];
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry.planes[pair.b];
    return plane.normal.dot(centreA - plane.point) - a.radius;
  }
  const BallsCollider& b = geometry.balls[pair.b];
  return (centreA - worldFromB * b.points[0]).norm() - a.radius - b.radius;
}

Contact contactOf(const ContactGeometry& geometry, std::size_t pairIndex, std::size_t feature, const VectorX& state) {
  const ColliderPair& pair = geometry.pairs[pairIndex];
  const BallsCollider& a = ballsA(geometry, pair);
  Contact contact{pairIndex, feature, a.body, bodyBOf(geometry, pair), Vec3::Zero(), Vec3::Zero(), 0};
  const RigidTransform worldFromA = poseOf(state, a.body), worldFromB = poseOf(state, contact.bodyB);
  const Vec3 centreA = worldFromA * a.points[feature];
  contact.separation = separation(geometry, pair, feature, worldFromA, worldFromB);
  if (pair.againstPlane) {
    contact.normal = -geometry.planes[pair.b].normal;
  } else {
    const Vec3 towardsB = worldFromB * geometry.balls[pair.b].points[0] - centreA;
    contact.normal = towardsB.isZero(0) ? Vec3::UnitY() : Vec3(towardsB.normalized());
  }
  contact.point = centreA + (a.radius + contact.separation / 2) * contact.normal;
  return contact;
}

void findContacts(const ContactGeometry& geometry, const VectorX& state, double margin,
                  std::vector<Contact>& contacts) {
  contacts.clear();
  for (std::size_t index = 0; index < geometry.pairs.size(); ++index) {
    const ColliderPair& pair = geometry.pairs[index];
    if (separationBound(geometry, pair, state) > margin) continue;
    for (std::size_t feature = 0; feature < featureCount(geometry, pair); ++feature) {
      const Contact contact = contactOf(geometry, index, feature, state);
      if (contact.separation <= margin) contacts.push_back(contact);
    }
  }
}

}  // namespace cradle
