#include "impact/soft_manifolds.h"

#include <algorithm>

namespace cradle {
namespace {

constexpr double kAxisRounding = 1e-9;    // of a unit axis or a side
constexpr double kSamePatchNormal = 0.9;  // cosine, at least, for contacts to be one manifold

}  // namespace

SoftManifolds::SoftManifolds(const ContactGeometry& geometry, double scale) : geometry_(geometry), scale_(scale) {
  for (const Collider& collider : geometry.colliders) {
    boxes_.push_back(boxOf(collider));
    const bool isBox = boxes_.back().has_value(), isCapsule = collider.kind() == ColliderKind::capsule;
    shapes_.push_back(isBox                                       ? Shape::box
                      : collider.isSphere()                       ? Shape::sphere
                      : isCapsule                                 ? Shape::capsule
                      : collider.kind() == ColliderKind::polytope ? Shape::hull
                                                                  : Shape::any);
  }
}

/// A polytope that is a box with corners numbered as polytopeOf does.
std::optional<SoftManifolds::BoxShape> SoftManifolds::boxOf(const Collider& collider) {
  if (collider.kind() != ColliderKind::polytope || !collider.polytope || collider.polytope->vertices.size() != 8 ||
      collider.polytope->faces.size() != 6)
    return {};
  const std::vector<Vec3>& corners = collider.polytope->vertices;
  BoxShape box;
  Vec3 opposite = corners[0];
  for (const int k : {0, 1, 2}) {
    const Vec3 side = corners[std::size_t{1} << k] - corners[0];
    box.halfSize[k] = side.norm() / 2;
    box.axes.col(k) = side.normalized();
    opposite += side;
  }
  box.center = (corners[0] + opposite) / 2;
  const double size = box.halfSize.norm();
  if (!((box.axes.transpose() * box.axes - Mat3::Identity()).norm() < kAxisRounding)) return {};
  if ((opposite - corners[7]).norm() > kAxisRounding * size) return {};
  if ((corners[3] - corners[1] - corners[2] + corners[0]).norm() > kAxisRounding * size) return {};
  return box;
}

SoftPair SoftManifolds::pairOf(std::size_t index) const {
  const ColliderPair& pair = geometry_.pairs[index];
  SoftPair oriented;
  oriented.pair = static_cast<std::uint32_t>(index), oriented.againstPlane = pair.againstPlane;
  oriented.shapeA = static_cast<std::uint32_t>(pair.a), oriented.shapeB = static_cast<std::uint32_t>(pair.b);
  oriented.bodyA = geometry_.colliders[pair.a].body, oriented.bodyB = bodyBOf(geometry_, pair);
  oriented.isExchanged = oriented.bodyA == kFixed;
  if (oriented.isExchanged) std::swap(oriented.shapeA, oriented.shapeB), std::swap(oriented.bodyA, oriented.bodyB);
  return oriented;
}

bool SoftManifolds::isFast(const SoftPair& pair) const {
  const Shape a = shapes_[pair.shapeA], b = pair.againstPlane ? Shape::sphere : shapes_[pair.shapeB];
  if (a >= Shape::hull || b >= Shape::hull) return false;
  return !(a == Shape::capsule && b == Shape::box) && !(a == Shape::box && b == Shape::capsule);
}

/// Boxes are hulls, too.
bool SoftManifolds::areHulls(const SoftPair& pair) const {
  const auto isHull = [this](std::uint32_t shape) {
    return shapes_[shape] == Shape::hull || shapes_[shape] == Shape::box;
  };
  return isHull(pair.shapeA) && (pair.againstPlane || isHull(pair.shapeB));
}

PredictedManifold SoftManifolds::manifoldOf(SoftPair& pair, const SoftStepStart& look,
                                            std::vector<Contact>& scratch) const {
  if (!isFast(pair) && areHulls(pair)) return manifoldOfHulls(pair, look);
  return isFast(pair) ? manifoldOfFastShapes(pair, look) : manifoldOfAnyShapes(pair, look, scratch);
}

PredictedManifold SoftManifolds::manifoldOfHulls(SoftPair& pair, const SoftStepStart& look) const {
  const MovingPose &poseA = look.poseOf(pair.bodyA), &poseB = look.poseOf(pair.bodyB);
  const Vec3 motion = look.timeStep * (poseB.linearVelocity - poseA.linearVelocity);
  const double margin = look.margin + look.timeStep * (poseA.spinSpeed + poseB.spinSpeed);
  const Core a(geometry_.colliders[pair.shapeA], poseOf(look.state, pair.bodyA));
  if (pair.againstPlane) return contactOfHullAndPlane(a, geometry_.planes[pair.shapeB], motion, margin, scale_);
  const Core b(geometry_.colliders[pair.shapeB], poseOf(look.state, pair.bodyB));
  return contactOfHulls(a, b, motion, margin, scale_, pair.axis);
}

PredictedManifold SoftManifolds::manifoldOfFastShapes(const SoftPair& pair, const SoftStepStart& look) const {
  const MovingPose &poseA = look.poseOf(pair.bodyA), &poseB = look.poseOf(pair.bodyB);
  const auto sphereAt = [&](const Collider& sphere, const MovingPose& pose) {
    return PosedSphere{pose.position + pose.rotation * sphere.points[0], sphere.radius};
  };
  const auto capsuleAt = [](const Collider& capsule, const MovingPose& pose) {  // or a sphere
    const Vec3 &from = capsule.points.front(), &to = capsule.points.back();
    return PosedCapsule{pose.position + pose.rotation * ((from + to) / 2), pose.rotation * ((to - from) / 2),
                        capsule.radius};
  };
  const auto boxAt = [](const BoxShape& box, const MovingPose& pose) {
    return PosedBox{pose.position + pose.rotation * box.center, pose.rotation * box.axes, box.halfSize};
  };
  const Vec3 motion = look.timeStep * (poseB.linearVelocity - poseA.linearVelocity);
  const double margin = look.margin + look.timeStep * (poseA.spinSpeed + poseB.spinSpeed);
  const Collider& a = geometry_.colliders[pair.shapeA];
  const auto& boxA = boxes_[pair.shapeA];
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry_.planes[pair.shapeB];
    if (shapes_[pair.shapeA] == Shape::capsule)
      return contactOfCapsuleAndPlane(capsuleAt(a, poseA), plane, motion, margin);
    return boxA ? contactOfBoxAndPlane(boxAt(*boxA, poseA), plane, motion, margin, scale_)
                : contactOfSphereAndPlane(sphereAt(a, poseA), plane, motion, margin);
  }
  const Collider& b = geometry_.colliders[pair.shapeB];
  const auto& boxB = boxes_[pair.shapeB];
  if (boxA && boxB) return contactOfBoxes(boxAt(*boxA, poseA), boxAt(*boxB, poseB), motion, margin, scale_);
  if (boxB) return contactOfSphereAndBox(sphereAt(a, poseA), boxAt(*boxB, poseB), motion, margin);
  if (boxA) return exchanged(contactOfSphereAndBox(sphereAt(b, poseB), boxAt(*boxA, poseA), -motion, margin));
  if (shapes_[pair.shapeA] == Shape::capsule || shapes_[pair.shapeB] == Shape::capsule)
    return contactOfCapsules(capsuleAt(a, poseA), capsuleAt(b, poseB), motion, margin, scale_);
  return contactOfSpheres(sphereAt(a, poseA), sphereAt(b, poseB), motion, margin);
}

/// Through the general search. One manifold: of contacts with several normals those along the deepest one's.
PredictedManifold SoftManifolds::manifoldOfAnyShapes(const SoftPair& pair, const SoftStepStart& look,
                                                     std::vector<Contact>& scratch) const {
  const MovingPose &poseA = look.poseOf(pair.bodyA), &poseB = look.poseOf(pair.bodyB);
  const double speed = (poseB.linearVelocity - poseA.linearVelocity).norm() + poseA.spinSpeed + poseB.spinSpeed;
  const double reach = look.margin + look.timeStep * speed;
  scratch.clear();
  appendContacts(geometry_, pair.pair, look.state, reach, scratch);
  PredictedManifold manifold;
  manifold.clearance = reach;
  if (scratch.empty()) return manifold;
  const auto deepest = std::min_element(scratch.begin(), scratch.end(),
                                        [](const Contact& a, const Contact& b) { return a.separation < b.separation; });
  manifold.normal = deepest->normal;
  constexpr std::size_t kMaxCandidates = 16;  // of which four are chosen; a pair of convex solids has eight at most
  PredictedManifold::Point points[kMaxCandidates];
  std::size_t count = 0;
  for (const Contact& contact : scratch) {
    if (contact.normal.dot(manifold.normal) < kSamePatchNormal || count == kMaxCandidates) continue;
    const Vec3 half = contact.separation / 2 * contact.normal;
    points[count++] = {contact.point - half, contact.point + half, contact.separation};
  }
  appendSpanning(points, count, manifold, scale_);
  return pair.isExchanged ? exchanged(manifold) : manifold;
}

}  // namespace cradle
