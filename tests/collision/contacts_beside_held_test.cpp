#include "collision/contacts_beside_held.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "collision/mesh_surface.h"
#include "collision/random_poses.h"
#include "math/rotation.h"
#include "mesh/primitives.h"
#include "mesh/sample_meshes.h"

namespace cradle {
namespace {

VectorX placedAt(const RigidTransform& pose) {
  VectorX state = VectorX::Zero(stateSize(1));
  centerOfMass(state, 0) = pose.translation;
  setOrientation(state, 0, pose.rotation);
  return state;
}

/// A step that a block has on a floor: an L of 3 x 2 x 1 m, fixed, with its inner corner at (1, 1, z).
Collider stair() {
  Collider stair;
  const TriangleMesh mesh = lPrismMesh();
  stair.points = mesh.vertices;
  stair.mesh = std::make_shared<const MeshSurface>(surfaceOf(mesh));
  stair.boundingRadius = 4;
  return stair;
}

/// How far others than what is held are, of the only pair.
double gapOfOthers(const ContactGeometry& geometry, const std::vector<ActiveFeature>& held, const VectorX& state) {
  std::vector<Contact> scratch;
  double size = 0;
  for (const Collider& collider : geometry.colliders) size = std::max(size, collider.boundingRadius);
  return gapBesideHeld(geometry, 0, held, state, size, scratch);
}

// A ball that lies on the tread touches the riser next: by its distance from x = 1. Against the riser, the tread is
// what comes, and held by both nothing is near: the edge ahead is more than a size away.
TEST(ContactsBesideHeld, OfASphereOnAMeshAreAllOtherFaces) {
  Collider sphere = colliderOf(Sphere{0.1}, {});
  sphere.body = 0;
  ContactGeometry geometry;
  geometry.colliders = {sphere, stair()};
  geometry.pairs = {{0, 1, false, {}}};
  const VectorX corner = placedAt({Quat::Identity(), Vec3(1.1, 1.1, 0.5)});
  std::vector<Contact> contacts;
  appendContacts(geometry, 0, corner, 1e-9, contacts);
  ASSERT_EQ(contacts.size(), 2u);
  std::vector<ActiveFeature> onTread, onRiser, onBoth;
  for (const Contact& contact : contacts) {
    ContactConstraint constraint;
    constraint.centerA = {0, Vec3::Zero()}, constraint.radiusA = 0.1;
    constraint.surfaceB = {kFixed, contact.point}, constraint.normalB = -contact.normal;
    const ActiveFeature feature{0, 0, constraint, touchedFeature(contact)};
    (std::abs(contact.normal.y()) > 0.5 ? onTread : onRiser).push_back(feature);
    onBoth.push_back(feature);
  }
  ASSERT_EQ(onTread.size(), 1u);
  for (const double way : {0.0, 1e-9, 0.003, 0.05}) {
    const VectorX along = placedAt({Quat::Identity(), Vec3(1.1 + way, 1.1, 0.5)}),
                  up = placedAt({Quat::Identity(), Vec3(1.1, 1.1 + way, 0.5)});
    EXPECT_NEAR(gapOfOthers(geometry, onTread, along), way, 1e-15);
    EXPECT_NEAR(gapOfOthers(geometry, onRiser, up), way, 1e-15);
    // Sinking into what holds it is no matter of the others.
    EXPECT_NEAR(gapOfOthers(geometry, onTread, placedAt({Quat::Identity(), Vec3(1.1 + way, 1.1 - 1e-4, 0.5)})), way,
                1e-15);
  }
  EXPECT_GE(gapOfOthers(geometry, onBoth, corner), 0.1);
}

// The ends of a capsule come down on a face one by one, and the one that is held does not count, however deep.
TEST(ContactsBesideHeld, OfACapsuleOnABoxAreThoseOfItsOtherEnd) {
  Collider capsule = colliderOf(Capsule{0.1, 0.4}, {});
  capsule.body = 0;
  ContactGeometry geometry;
  geometry.colliders = {capsule, colliderOf(Box{Vec3(4, 1, 4)}, {Quat::Identity(), Vec3(0, -0.5, 0)})};
  geometry.pairs = {{0, 1, false, {}}};
  for (const double tilt : {-1e-3, 1e-4, 2e-3}) {
    // Lying along x with its lower end's surface 1e-5 m deep.
    const Quat turn = rotationAbout(Vec3::UnitZ(), -1.5707963267948966 + tilt);
    const Vec3 end = turn * Vec3(0, -0.2, 0), other = turn * Vec3(0, 0.2, 0);
    const Vec3 center(0.1, 0.1 - 1e-5 - end.y(), 0.2);
    ContactConstraint constraint;
    constraint.centerA = {0, Vec3(0, -0.2, 0)}, constraint.radiusA = 0.1;
    constraint.surfaceB = {kFixed, Vec3(0, 0, 0)}, constraint.normalB = Vec3::UnitY();
    const std::vector<ActiveFeature> held = {{0, 0, constraint, {}}};
    const VectorX state = placedAt({turn, center});
    EXPECT_NEAR(gapOfOthers(geometry, held, state), (center + other).y() - 0.1, 1e-15) << tilt;
    EXPECT_NEAR(gapOfOthers(geometry, {}, state), std::min(-1e-5, (center + other).y() - 0.1), 1e-15);
  }
}

/// A fixed beam on its side, with its upper edge along z at the origin between faces that fall by 45 degrees, and a box
/// of 0.4 x 0.2 x 0.4 m above it.
ContactGeometry beamAndBox() {
  Collider box = colliderOf(Box{Vec3(0.4, 0.2, 0.4)}, RigidTransform{});
  box.body = 0;
  const Quat onEdge = rotationAbout(Vec3::UnitZ(), M_PI / 4);
  ContactGeometry geometry;
  geometry.colliders = {box, colliderOf(Box{Vec3(1, 1, 4)}, RigidTransform{onEdge, Vec3(0, -std::sqrt(0.5), 0)})};
  geometry.pairs = {{0, 1, false, {}}};
  return geometry;
}

// The box stands with its lower edge along x on the beam's, its face that was down tilted by an angle a about it. That
// face comes flush with the beam's edge at a = 0, and the sine of a is the gap, in sizes of the smaller body.
TEST(ContactsBesideHeld, OfEdgesThatCrossAreTheFacesBesideThem) {
  const ContactGeometry geometry = beamAndBox();
  const double size = geometry.colliders[0].boundingRadius;
  for (const double tilt : {0.3, 0.01, 1e-4, 1e-7}) {
    const Quat turn = rotationAbout(Vec3::UnitX(), tilt);
    const Vec3 edge = turn * Vec3(0, -0.1, 0.2);  // of the box, from its centre; it is the lower one
    const VectorX state = placedAt({turn, -edge + 0.03 * Vec3::UnitX()});
    SurfaceContact crossing{0, kFixed, Vec3::Zero(), -Vec3::UnitY(), 0, 0, 0, Vec3::UnitX(), Vec3::UnitZ()};
    const std::vector<ActiveFeature> held = {{0, 0, constraintOf(crossing, state)}};
    EXPECT_NEAR(gapOfOthers(geometry, held, state), std::sin(tilt) * size, 1e-3 * tilt * size + 1e-15) << tilt;
  }
}

// A capsule held with one end on the beam's edge, its axis along z but for an angle a: the other end, 0.6 m away, is
// 0.6 sin a over the edge, however small that is.
TEST(ContactsBesideHeld, OfACapsuleHeldByOneEndAreItsOtherEnd) {
  ContactGeometry geometry = beamAndBox();
  Collider capsule =
      colliderOf(Capsule{0.1, 0.6}, RigidTransform{rotationAbout(Vec3::UnitX(), M_PI / 2), Vec3::Zero()});
  capsule.body = 0;
  geometry.colliders[0] = capsule;
  for (const double tilt : {0.01, 1e-4, 1e-6, 1e-8}) {
    const Quat turn = rotationAbout(Vec3::UnitX(), -tilt);
    const VectorX state = placedAt({turn, Vec3(0, 0.1, 0) - turn * Vec3(0, 0, -0.3)});
    SurfaceContact end{0, kFixed, Vec3::Zero(), -Vec3::UnitY(), 0, 0.1, 0, Vec3::Zero(), Vec3::UnitZ()};
    const std::vector<ActiveFeature> held = {{0, 0, constraintOf(end, state)}};
    EXPECT_NEAR(gapOfOthers(geometry, held, state), 0.6 * std::sin(tilt), 1e-15) << tilt;
  }
}

}  // namespace
}  // namespace cradle
