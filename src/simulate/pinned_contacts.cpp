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

/// The end of a joint that moves, if the other is fixed; else none.
const Attachment* movingEnd(const Attachment& anchorA, const Attachment& anchorB) {
  if (anchorA.body != kFixed && anchorB.body == kFixed) return &anchorA;
  return anchorB.body != kFixed && anchorA.body == kFixed ? &anchorB : nullptr;
}

/// Of the body, or none.
std::vector<std::size_t> collidersOf(const Assembly& assembly, int body) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < assembly.geometry.colliders.size(); ++i)
    if (assembly.geometry.colliders[i].body == body) found.push_back(i);
  return found;
}

}  // namespace

void constrainPinnedContacts(Assembly& assembly) {
  Constraints& constraints = assembly.mechanism.constraints;
  std::vector<BallJointConstraint> ballJoints;
  std::vector<std::string> names;
  const std::size_t hinges = constraints.hinges.size();
  for (std::size_t i = 0; i < constraints.ballJoints.size(); ++i) {
    const BallJointConstraint& joint = constraints.ballJoints[i];
    bool isReplaced = false;
    if (const Attachment* end = movingEnd(joint.anchorA, joint.anchorB))
      for (const std::size_t collider : collidersOf(assembly, end->body)) {
        assembly.geometry.colliders[collider].pins.push_back({end->point, Vec3::Zero()});
        isReplaced = forbidRolling(collider, {end->point, Vec3::Zero()}, assembly.names.ballJoints[i], assembly);
      }
    if (isReplaced) continue;
    ballJoints.push_back(joint);
    names.push_back(assembly.names.ballJoints[i]);
  }
  constraints.ballJoints = std::move(ballJoints);
  assembly.names.ballJoints = std::move(names);
  for (std::size_t i = 0; i < hinges; ++i) {
    const HingeConstraint hinge = constraints.hinges[i];
    const Attachment* end = movingEnd(hinge.anchorA, hinge.anchorB);
    if (!end) continue;
    const Vec3 axis = end == &hinge.anchorA ? hinge.axisA : hinge.acrossB[0].cross(hinge.acrossB[1]);
    for (const std::size_t collider : collidersOf(assembly, end->body)) {
      assembly.geometry.colliders[collider].pins.push_back({end->point, axis});
      forbidRolling(collider, {end->point, axis}, assembly.names.hinges[i], assembly);
    }
  }
}

}  // namespace cradle
