#include "simulate/pinned_contacts.h"

#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "collision/separation.h"
#include "math/rotation.h"

namespace cradle {
namespace {

// Of a size. Nearer than this is touching (a body may turn by the square root of twice that before it presses) ...
constexpr double kTouchingAtPin = 1e-9;
constexpr double kSamePlaceAtPin = 1e-6;  // ... and so far from the anchor a round surface has less of a turn still
constexpr double kSameAxis = 1e-9;        // sine of an angle between axes

/// Directions (body's frame, unit) along which a collider is round at a point of its surface whose normal is given.
struct Roundness {
  bool isRound = false;         // along all that are across the normal, ...
  Vec3 tangent = Vec3::Zero();  // ... or along this one
  bool any() const { return isRound || !tangent.isZero(); }
};

/// `normal` (unit, body's frame) points out of the collider.
Roundness roundnessAt(const Collider& collider, const Vec3& point, const Vec3& normal) {
  const ColliderKind kind = collider.kind();
  if (kind == ColliderKind::polytope || kind == ColliderKind::mesh) return {};
  const double near = kSamePlaceAtPin * collider.boundingRadius;
  const double radius = kind == ColliderKind::cylinder ? collider.rimRadius : collider.radius;
  if (collider.isBall()) return {(collider.points[0] + radius * normal - point).norm() <= near, {}};
  const Vec3 along = collider.points[1] - collider.points[0];
  const double part = (point - collider.points[0]).dot(along) / along.squaredNorm();
  const Vec3 arm = point - (collider.points[0] + std::clamp(part, 0.0, 1.0) * along);
  if (std::abs(arm.norm() - radius) > near) return {};
  const Vec3 tangent = along.cross(arm).normalized();
  if (kind == ColliderKind::cylinder)
    return {false, std::abs(tangent.dot(normal)) <= kSamePlaceAtPin ? tangent : Vec3(Vec3::Zero())};
  if ((arm - radius * normal).norm() > near) return {};
  const double rest = near / along.norm();
  return part > rest && part < 1 - rest ? Roundness{false, tangent} : Roundness{true, {}};
}

/// Outward normals (world) of the flat fixed surfaces that a point (m, world) of a collider touches.
std::vector<Vec3> flatNormalsAt(const Assembly& assembly, std::size_t index, const Vec3& point) {
  const ContactGeometry& geometry = assembly.geometry;
  const Collider& collider = geometry.colliders[index];
  const double touching = kTouchingAtPin * collider.boundingRadius, near = kSamePlaceAtPin * collider.boundingRadius;
  std::vector<Vec3> normals;
  for (const PlaneCollider& plane : geometry.planes)
    if (std::abs(plane.normal.dot(point - plane.point)) <= touching) normals.push_back(plane.normal);
  std::vector<Contact> contacts;
  for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair) {
    const ColliderPair& colliders = geometry.pairs[pair];
    if (colliders.againstPlane || (colliders.a != index && colliders.b != index)) continue;
    contacts.clear();
    appendContacts(geometry, pair, assembly.state, touching, contacts);
    for (const Contact& contact : contacts) {
      const bool isA = contact.bodyA == collider.body;
      const double other = isA ? contact.radiusB : contact.radiusA;
      if ((isA ? contact.bodyB : contact.bodyA) != kFixed || !std::isinf(other)) continue;
      if (contact.separation < -touching || (contact.point - point).norm() > near) continue;
      normals.push_back(isA ? Vec3(-contact.normal) : contact.normal);
    }
  }
  return normals;
}

/// Keeps an axis of a body across one or two directions of the world.
void keepAcross(const Attachment& anchor, const Vec3& place, const Vec3& axis, const std::array<Vec3, 2>& across,
                const std::string& name, Assembly& assembly) {
  assembly.mechanism.constraints.hinges.push_back({anchor, {kFixed, place}, axis, across});
  assembly.names.hinges.push_back(name);
}

/// Forbids a body to roll where an anchor holds it. True if the anchor's point needs no other constraint then.
bool forbidRolling(std::size_t index, const PinnedPlace& pin, const std::string& name, Assembly& assembly) {
  const Collider collider = assembly.geometry.colliders[index];
  const RigidTransform worldFromBody = poseOf(assembly.state, collider.body);
  const Vec3 place = worldFromBody * pin.point;
  bool isForbidden = false;
  for (const Vec3& normal : flatNormalsAt(assembly, index, place)) {
    const Vec3 inBody = worldFromBody.rotation.conjugate() * normal;
    const Roundness round = roundnessAt(collider, pin.point, -inBody);
    const bool keepsNormal = pin.axis.cross(inBody).norm() <= kSameAxis && !pin.axis.isZero();
    const bool keepsTangent = keepsNormal || pin.axis.cross(round.tangent).norm() <= kSameAxis;
    if (!round.any() || keepsNormal || (!round.isRound && !pin.axis.isZero() && keepsTangent)) continue;
    const Vec3 across = normal.unitOrthogonal();
    if (round.isRound || !pin.axis.isZero())
      keepAcross({collider.body, pin.point}, place, inBody, {across, normal.cross(across)}, name, assembly);
    else
      keepAcross({collider.body, pin.point}, place, round.tangent, {normal, Vec3::Zero()}, name, assembly);
    isForbidden = true;
  }
  return isForbidden;
}

/// Tells the colliders of a joint's body of its anchor, which `other` (a moving body, or kFixed) holds. True if rolling
/// about it is forbidden from now on.
bool pin(const Attachment& anchor, int other, const Vec3& axis, const std::string& name, Assembly& assembly) {
  if (anchor.body == kFixed) return false;
  bool isForbidden = false;
  for (std::size_t i = 0; i < assembly.geometry.colliders.size(); ++i) {
    Collider& collider = assembly.geometry.colliders[i];
    if (collider.body != anchor.body) continue;
    // The contact at the anchor is not found any more once the collider knows of it.
    if (other == kFixed) isForbidden = forbidRolling(i, {other, anchor.point, axis}, name, assembly);
    collider.pins.push_back({other, anchor.point, axis});
  }
  return isForbidden;
}

}  // namespace

void constrainPinnedContacts(Assembly& assembly) {
  Constraints& constraints = assembly.mechanism.constraints;
  const std::vector<HingeConstraint> hinges = constraints.hinges;
  const std::vector<std::string> hingeNames = assembly.names.hinges;
  std::vector<BallJointConstraint> ballJoints;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < constraints.ballJoints.size(); ++i) {
    const BallJointConstraint& joint = constraints.ballJoints[i];
    const std::string& name = assembly.names.ballJoints[i];
    const bool isReplacedA = pin(joint.anchorA, joint.anchorB.body, Vec3::Zero(), name, assembly);
    const bool isReplacedB = pin(joint.anchorB, joint.anchorA.body, Vec3::Zero(), name, assembly);
    if (isReplacedA || isReplacedB) continue;
    ballJoints.push_back(joint);
    names.push_back(name);
  }
  constraints.ballJoints = std::move(ballJoints);
  assembly.names.ballJoints = std::move(names);
  for (std::size_t i = 0; i < hinges.size(); ++i) {
    const HingeConstraint& hinge = hinges[i];
    pin(hinge.anchorA, hinge.anchorB.body, hinge.axisA, hingeNames[i], assembly);
    pin(hinge.anchorB, hinge.anchorA.body, hinge.acrossB[0].cross(hinge.acrossB[1]), hingeNames[i], assembly);
  }
}

}  // namespace cradle
