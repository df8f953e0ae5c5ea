#include "simulate/pinned_contacts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "collision/mesh_surface.h"
#include "collision/separation.h"
#include "math/rotation.h"

namespace cradle {
namespace {

// Of a size. Nearer than this is touching (a body may turn by the square root of twice that before it presses) ...
constexpr double kTouchingAtPin = 1e-9;
constexpr double kSamePlaceAtPin = 1e-6;  // ... and so far from the anchor a round surface has less of a turn still
constexpr double kSameAxis = 1e-9;        // sine of an angle between axes
constexpr double kSharedLine = 1e-3;      // of a size: surfaces that share a longer line about it do so to either side
constexpr double kSameNormals = 1e-12;    // its square, between normals: less is none

/// A surface around a point of it, in directions across its normal. (Flat where both are zero.)
struct LocalSurface {
  Mat3 round = Mat3::Zero();  // sum of t t^T of the unit directions in which it is round
  Mat3 sharp = Mat3::Zero();  // the same of those in which it bends away at once: across an edge, at a corner all
};

Mat3 squareOf(const Vec3& direction) {
  return direction * direction.transpose();
}

LocalSurface turned(const Quat& rotation, const LocalSurface& surface) {
  const Mat3 turn = rotation.toRotationMatrix();
  return {turn * surface.round * turn.transpose(), turn * surface.sharp * turn.transpose()};
}

bool isInTriangle(const MeshSurface& surface, const MeshSurface::Face& face, const Vec3& point, double near) {
  if (std::abs(face.normal.dot(point - surface.vertices[face.vertices[0]])) > near) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& from = surface.vertices[face.vertices[i]];
    const Vec3 along = (surface.vertices[face.vertices[(i + 1) % 3]] - from).normalized();
    if (face.normal.cross(along).dot(point - from) < -near) return false;
  }
  return true;
}

/// Normals (body's frame) of the faces that a point of a polytope or mesh is on.
std::vector<Vec3> faceNormalsAt(const Collider& collider, const Vec3& point, double near) {
  std::vector<Vec3> normals;
  if (collider.kind() == ColliderKind::polytope) {
    for (const Polytope::Face& face : collider.polytope->faces)
      if (std::abs(face.normal.dot(point) - face.offset) <= near) normals.push_back(face.normal);
    return normals;
  }
  if (!collider.mesh) return normals;  // that meets planes only
  const Vec3 inMesh = collider.bodyFromMesh.inverse() * point;
  for (const MeshSurface::Face& face : collider.mesh->faces)
    if (isInTriangle(*collider.mesh, face, inMesh, near))
      normals.push_back(collider.bodyFromMesh.rotation * face.normal);
  return normals;
}

bool isOnSurface(const Collider& collider, const Vec3& point, double near) {
  if (collider.kind() == ColliderKind::mesh) return !faceNormalsAt(collider, point, near).empty();
  return std::abs(nearestSurfacePoint(collider, point).distance) <= near;
}

/// Between flat faces: one of them if that has the normal of contact; else their edge or corner.
LocalSurface betweenFaces(const std::vector<Vec3>& faces, const Vec3& normal) {
  Mat3 sum = Mat3::Zero();
  for (const Vec3& face : faces) {
    if (face.cross(normal).norm() <= kSamePlaceAtPin) return {};
    sum += squareOf(face);
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(sum);
  const Vec3 along = solver.eigenvectors().col(0);
  const bool isEdge = solver.eigenvalues()[0] <= kSameNormals && solver.eigenvalues()[1] > kSameNormals;
  if (!isEdge || std::abs(along.dot(normal)) > kSamePlaceAtPin) return {Mat3::Zero(), Mat3::Identity()};
  return {Mat3::Zero(), squareOf(along.cross(normal))};
}

/// What a collider's surface is at a point (body's frame) in which it is touched; `normal` is that of contact.
LocalSurface surfaceAt(const Collider& collider, const Vec3& point, const Vec3& normal) {
  const ColliderKind kind = collider.kind();
  const double near = kSamePlaceAtPin * collider.boundingRadius;
  if (kind == ColliderKind::polytope || kind == ColliderKind::mesh)
    return betweenFaces(faceNormalsAt(collider, point, near), normal);
  const Mat3 across = Mat3::Identity() - squareOf(normal);
  if (collider.isSphere()) return {across, Mat3::Zero()};
  const Vec3 along = collider.points[1] - collider.points[0];
  const double part = (point - collider.points[0]).dot(along) / along.squaredNorm(), rest = near / along.norm();
  const bool isSide = part > rest && part < 1 - rest;
  const Vec3 radial = point - (collider.points[0] + std::clamp(part, 0.0, 1.0) * along);
  const Vec3 tangent = along.cross(radial).normalized();
  if (kind == ColliderKind::capsule) return {isSide ? squareOf(tangent) : across, Mat3::Zero()};
  if (radial.norm() < collider.rimRadius - near) return {};  // in an end
  return {squareOf(tangent), isSide ? Mat3(Mat3::Zero()) : squareOf(tangent.cross(normal))};
}

/// A fixed surface that a body touches at the anchor of a joint.
struct TouchedSurface {
  Vec3 normal;               // unit, world, towards the body
  LocalSurface shape;        // world
  const Collider* collider;  // none: a plane
};

/// What a point (m, world) on a collider's surface touches of all that is fixed.
std::vector<TouchedSurface> surfacesTouchedAt(const Assembly& assembly, std::size_t index, const Vec3& point) {
  const ContactGeometry& geometry = assembly.geometry;
  const Collider& collider = geometry.colliders[index];
  const double touching = kTouchingAtPin * collider.boundingRadius, near = kSamePlaceAtPin * collider.boundingRadius;
  std::vector<TouchedSurface> surfaces;
  const auto add = [&](const Vec3& normal, const LocalSurface& shape, const Collider* other) {
    const auto isSame = [&](const TouchedSurface& known) { return (known.normal - normal).norm() <= kSamePlaceAtPin; };
    if (std::none_of(surfaces.begin(), surfaces.end(), isSame)) surfaces.push_back({normal, shape, other});
  };
  for (const PlaneCollider& plane : geometry.planes)
    if (const double height = plane.normal.dot(point - plane.point); height >= -near && height <= touching)
      add(plane.normal, {}, nullptr);
  std::vector<Contact> contacts;
  for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair) {
    const ColliderPair& colliders = geometry.pairs[pair];
    if (colliders.againstPlane || (colliders.a != index && colliders.b != index)) continue;
    const Collider& other = geometry.colliders[colliders.a == index ? colliders.b : colliders.a];
    if (other.body != kFixed || !isOnSurface(other, point, near)) continue;
    contacts.clear();
    appendContacts(geometry, pair, assembly.state, touching, contacts);
    for (const Contact& contact : contacts) {
      const double height =
          contact.normal.dot(contact.point - point);  // of a line or face of contact, the point is in it
      if (contact.separation < -near || std::abs(height) > near) continue;
      const Vec3 normal = contact.bodyA == collider.body ? Vec3(-contact.normal) : contact.normal;
      add(normal, surfaceAt(other, point, normal), &other);
    }
  }
  return surfaces;
}

/// Rotations that two surfaces forbid which touch at the anchor of a joint. One that tilts the normal n by a small t
/// across it (t = turn x n) makes them overlap by t (K_a + K_b)^-1 t / 2, K their curvatures: nothing where one of them
/// is sharp in the direction of t. Where both are flat along a line, its ends overlap at once.
struct ForbiddenTilts {
  bool all = false;               // the body keeps the normal
  Vec3 direction = Vec3::Zero();  // unit, world: tilts along it; zero: none
  bool isOfBody = false;          // the direction rotates with the body
  bool any() const { return all || !direction.isZero(); }
};

/// `isLine` tells of a direction whether both surfaces go on in it, either way.
template <class IsLine>
ForbiddenTilts forbiddenTilts(const LocalSurface& body, const LocalSurface& fixed, const Vec3& normal,
                              const IsLine& isLine) {
  const Vec3 first = normal.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> plane;
  plane << first, normal.cross(first);
  const auto inPlane = [&](const Mat3& sum) -> Eigen::Matrix2d { return plane.transpose() * sum * plane; };
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> sharp(inPlane(body.sharp + fixed.sharp)),
      round(inPlane(body.round + fixed.round));
  if (sharp.eigenvalues()[0] > kSameNormals) return {};
  if (sharp.eigenvalues()[1] > kSameNormals) {  // of edges: along them
    const Vec3 along = plane * sharp.eigenvectors().col(0);
    const bool isRound = along.dot((body.round + fixed.round) * along) > kSameNormals;
    return isRound || isLine(along) ? ForbiddenTilts{false, along, !body.sharp.isZero()} : ForbiddenTilts{};
  }
  if (!(round.eigenvalues()[1] > kSameNormals)) return {};  // corners of faces tell
  const Vec3 straight = plane * round.eigenvectors().col(0);
  if (round.eigenvalues()[0] > kSameNormals || isLine(straight)) return {true};
  return {false, plane * round.eigenvectors().col(1), !body.round.isZero()};
}

/// Keeps an axis of a body across one or two directions of the world.
void keepAcross(const Attachment& anchor, const Vec3& place, const Vec3& axis, const std::array<Vec3, 2>& across,
                const std::string& name, Assembly& assembly) {
  assembly.mechanism.constraints.push_back({anchor, {kFixed, place}, HingeConstraint{axis, across}});
  assembly.names.constraints.push_back(name);
}

/// Forbids a body to roll about an anchor. True if the anchor's point needs no other constraint then.
bool forbidRolling(std::size_t index, const PinnedPlace& pin, const std::string& name, Assembly& assembly) {
  const Collider collider = assembly.geometry.colliders[index];
  const RigidTransform worldFromBody = poseOf(assembly.state, collider.body);
  const Quat bodyFromWorld = worldFromBody.rotation.conjugate();
  const Vec3 place = worldFromBody * pin.point;
  if (!isOnSurface(collider, pin.point, kSamePlaceAtPin * collider.boundingRadius)) return false;
  bool isForbidden = false;
  for (const TouchedSurface& touched : surfacesTouchedAt(assembly, index, place)) {
    const Vec3& normal = touched.normal;
    const Vec3 normalInBody = bodyFromWorld * normal;
    const LocalSurface own = turned(worldFromBody.rotation, surfaceAt(collider, pin.point, normalInBody));
    const auto isLine = [&](const Vec3& direction) {
      const double length = kSharedLine * collider.boundingRadius, near = kSamePlaceAtPin * collider.boundingRadius;
      const auto isOnBoth = [&](const Vec3& point) {
        return isOnSurface(collider, worldFromBody.inverse() * point, near) &&
               (!touched.collider || isOnSurface(*touched.collider, point, near));
      };
      return isOnBoth(place + length * direction) && isOnBoth(place - length * direction);
    };
    const ForbiddenTilts forbidden = forbiddenTilts(own, touched.shape, normal, isLine);
    const Vec3 axis = worldFromBody.rotation * pin.axis;
    const bool isHinge = !axis.isZero(), keepsNormal = isHinge && axis.cross(normal).norm() <= kSameAxis;
    const bool keepsDirection = isHinge && !forbidden.all && axis.cross(forbidden.direction).norm() <= kSameAxis;
    if (!forbidden.any() || keepsNormal || keepsDirection) continue;
    const Attachment anchor{collider.body, pin.point};
    const Vec3 across = normal.unitOrthogonal();
    if (forbidden.all || isHinge)
      keepAcross(anchor, place, normalInBody, {across, normal.cross(across)}, name, assembly);
    else if (forbidden.isOfBody)
      keepAcross(anchor, place, bodyFromWorld * forbidden.direction, {normal, Vec3::Zero()}, name, assembly);
    else
      keepAcross(anchor, place, normalInBody, {forbidden.direction, Vec3::Zero()}, name, assembly);
    isForbidden = true;
  }
  return isForbidden;
}

/// Tells the collider of a joint's body, if it has one, of its anchor on `other` (a moving body, or kFixed). True if
/// rolling about it is forbidden from now on.
bool pin(const Attachment& anchor, int other, const Vec3& axis, const std::string& name, Assembly& assembly) {
  if (anchor.body == kFixed) return false;
  const int sceneBody = assembly.sceneBodies[static_cast<std::size_t>(anchor.body)];
  const int collider = indexAmong(assembly.colliderBodies, sceneBody);
  if (collider < 0) return false;
  const auto index = static_cast<std::size_t>(collider);
  // The contact at the anchor is not found any more once the collider knows of it.
  const bool isForbidden = other == kFixed && forbidRolling(index, {other, anchor.point, axis}, name, assembly);
  assembly.geometry.colliders[index].pins.push_back({other, anchor.point, axis});
  return isForbidden;
}

/// Tells the colliders of a joint's bodies of its anchors. True if constraints that forbid rolling hold the point of a
/// ball joint as well. A rod pins nothing.
bool isReplacedAtPin(const Constraint& constraint, const std::string& name, Assembly& assembly) {
  const auto& [a, b, kind] = constraint;
  if (const auto* hinge = std::get_if<HingeConstraint>(&kind)) {
    pin(a, b.body, hinge->axisA, name, assembly);
    pin(b, a.body, hinge->acrossB[0].cross(hinge->acrossB[1]), name, assembly);
    return false;
  }
  if (!std::holds_alternative<BallJointConstraint>(kind)) return false;
  const bool isReplacedA = pin(a, b.body, Vec3::Zero(), name, assembly);
  const bool isReplacedB = pin(b, a.body, Vec3::Zero(), name, assembly);
  return isReplacedA || isReplacedB;
}

}  // namespace

void constrainPinnedContacts(Assembly& assembly) {
  Constraints& constraints = assembly.mechanism.constraints;
  std::vector<std::string>& names = assembly.names.constraints;
  const std::size_t ofScene = constraints.size();  // those that forbid rolling come behind them
  std::vector<std::ptrdiff_t> replaced;
  for (std::size_t i = 0; i < ofScene; ++i) {
    const Constraint constraint = constraints[i];
    const std::string name = names[i];
    if (isReplacedAtPin(constraint, name, assembly)) replaced.push_back(static_cast<std::ptrdiff_t>(i));
  }
  for (auto i = replaced.rbegin(); i != replaced.rend(); ++i)
    constraints.erase(constraints.begin() + *i), names.erase(names.begin() + *i);
}

}  // namespace cradle
