#include <gtest/gtest.h>

#include <cmath>

#include "collision/core_separation.h"
#include "collision/mesh_nearest.h"
#include "collision/random_poses.h"
#include "collision/separation.h"
#include "math/rotation.h"
#include "mesh/sample_meshes.h"

// An L is two boxes, so that its distance from a cylinder is the smaller of theirs, which convex cores are proven for;
// what rests on a mesh must be held by contacts that span what it lies on.

namespace cradle {
namespace {

Collider meshCollider(const TriangleMesh& mesh) {
  Collider collider;
  collider.points = mesh.vertices;
  collider.mesh = std::make_shared<const MeshSurface>(surfaceOf(mesh));
  for (const Vec3& vertex : mesh.vertices) collider.boundingRadius = std::max(collider.boundingRadius, vertex.norm());
  return collider;
}

/// A mesh, and a cylinder in its pose.
struct MeshAndCylinder {
  ContactGeometry geometry;
  VectorX state = VectorX::Zero(stateSize(2));

  MeshAndCylinder(const Collider& mesh, const Collider& cylinder, const RigidTransform& pose, bool isSwapped = false) {
    geometry.colliders = {mesh, cylinder};
    for (int i = 0; i < 2; ++i) setOrientation(state, i, Quat::Identity());
    const int meshBody = isSwapped ? 1 : 0, cylinderBody = 1 - meshBody;
    if (isSwapped) std::swap(geometry.colliders[0], geometry.colliders[1]);
    for (int i = 0; i < 2; ++i) geometry.colliders[static_cast<std::size_t>(i)].body = i;
    geometry.pairs = {{0, 1, false, {}}};
    centerOfMass(state, cylinderBody) = pose.translation, setOrientation(state, cylinderBody, pose.rotation);
  }
  double separation() const { return cradle::separation(geometry, geometry.pairs[0], 0, state); }
  std::vector<Contact> contacts(double margin) const {
    std::vector<Contact> found;
    findContacts(geometry, state, margin, found);
    return found;
  }
};

const Quat kLyingDown = rotationAbout(Vec3::UnitZ(), M_PI / 2);  // turns the axis y to -x

/// The boxes that an L is made of.
struct LOfBoxes {
  Collider foot = colliderOf(Box{Vec3(3, 1, 1)}, {Quat::Identity(), Vec3(1.5, 0.5, 0.5)});
  Collider back = colliderOf(Box{Vec3(1, 2, 1)}, {Quat::Identity(), Vec3(0.5, 1, 0.5)});

  SeparatingAxis gap(const Collider& cylinder, const RigidTransform& pose) const {
    const Core core(cylinder, pose);
    const SeparatingAxis one = separationOf(Core(foot, {}), core), other = separationOf(Core(back, {}), core);
    return one.separation < other.separation ? one : other;
  }
};

TEST(CylinderOnMesh, SeparationIsTheDistanceFromTheBoxesThatTheMeshIsMadeOf) {
  RandomPoses random(1);
  const Collider mesh = meshCollider(lPrismMesh());
  const LOfBoxes boxes;
  int apart = 0, overlapping = 0;
  for (const Cylinder& shape : {Cylinder{0.3, 0.8}, Cylinder{0.1, 1.5}, Cylinder{0.5, 0.05}}) {
    const Collider cylinder = colliderOf(shape, {});
    for (int i = 0; i < 60; ++i) {
      RigidTransform pose = random.pose(2.5);
      pose.translation += Vec3(1.2, 0.8, 0.5);
      if (i % 3 == 0) pose.rotation = rotationBetween(Vec3::UnitY(), Vec3::Unit(i / 3 % 3));
      const double expected = boxes.gap(cylinder, pose).separation;
      const MeshAndCylinder pair(mesh, cylinder, pose);
      expected > 0 ? ++apart : ++overlapping;
      if (expected > 0) {
        EXPECT_NEAR(pair.separation(), expected, 1e-11) << i;  // of what directions of rims are found by
      } else {
        EXPECT_LT(pair.separation(), 0) << i;
      }
      EXPECT_NEAR(MeshAndCylinder(mesh, cylinder, pose, true).separation(), pair.separation(), 1e-11);
    }
  }
  EXPECT_GT(apart, 60);
  EXPECT_GT(overlapping, 15);
}

// Moved along the normal to a touch and a little beyond: the deepest contact is the gap, along that normal, and its
// points are on both surfaces.
TEST(CylinderOnMesh, PassesThroughZeroWithAContactOnBothSurfaces) {
  RandomPoses random(2);
  const Collider mesh = meshCollider(lPrismMesh()), cylinder = colliderOf(Cylinder{0.3, 0.8}, {});
  const LOfBoxes boxes;
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    RigidTransform pose = random.pose(2.5);
    pose.translation += Vec3(1.2, 0.8, 0.5);
    const SeparatingAxis gap = boxes.gap(cylinder, pose);
    if (gap.separation < 0.05) continue;
    ++touching;
    const Vec3 start = pose.translation;
    for (const double left : {1e-3, 1e-9, -1e-9, -1e-6}) {
      pose.translation = start - (gap.separation - left) * gap.normal;
      const MeshAndCylinder pair(mesh, cylinder, pose);
      const double separation = pair.separation();
      EXPECT_GT(separation * left, 0) << i << ' ' << left;
      EXPECT_LE(std::abs(separation), std::abs(left) + 1e-12) << i << ' ' << left;
      if (left > 0) {
        EXPECT_NEAR(separation, left, 1e-12) << i;
      }
      const auto contacts = pair.contacts(separation + 1e-9);
      ASSERT_FALSE(contacts.empty()) << i << ' ' << left;
      for (const Contact& contact : contacts) {
        EXPECT_NEAR(contact.normal.norm(), 1, 1e-14);
        EXPECT_NEAR(contact.separation, separation, 2e-7) << i << ' ' << left;  // the preference for faces
        const Vec3 half = contact.separation / 2 * contact.normal;
        EXPECT_NEAR(heightOver(*mesh.mesh, contact.point - half).height, 0, 1e-6) << i << ' ' << left;
        EXPECT_NEAR(nearestSurfacePoint(cylinder, pose.inverse() * (contact.point + half)).distance, 0, 1e-6)
            << i << ' ' << left;
      }
    }
  }
  EXPECT_GT(touching, 30);
}

/// What the contacts reach along a direction of the ground.
double reachOf(const std::vector<Contact>& contacts, double angle) {
  double farthest = -INFINITY;
  for (const Contact& contact : contacts)
    farthest = std::max(farthest, contact.point.dot(Vec3(std::cos(angle), 0, std::sin(angle))));
  return farthest;
}

// On a square of two triangles, turned and shifted over their common edge: of 8 points of the rim in each triangle and
// those on the edge 6 or more are left, at most 90 degrees apart, and hold it from all sides.
TEST(CylinderOnMesh, StandsOnItsRimOverInnerEdges) {
  const Collider table = meshCollider(boxMesh(Vec3(4, 1, 4))), cylinder = colliderOf(Cylinder{0.5, 2}, {});
  for (const double gap : {0.0, 1e-10, -1e-10, 1e-4, -1e-4})
    for (double shift = -0.6; shift < 0.61; shift += 0.3) {
      const RigidTransform pose{rotationAbout(Vec3::UnitY(), shift), Vec3(shift, 1.5 + gap, 0.1)};
      const auto contacts = MeshAndCylinder(table, cylinder, pose).contacts(1e-3);
      EXPECT_GE(contacts.size(), 6u);
      for (const Contact& contact : contacts) {
        EXPECT_NEAR(contact.separation, gap, 1e-14);
        EXPECT_LT((contact.normal - Vec3::UnitY()).norm(), 1e-14);
      }
      for (double angle = 0; angle < 6.28; angle += 0.1)
        EXPECT_GT(reachOf(contacts, angle) - shift * std::cos(angle) - 0.1 * std::sin(angle),
                  std::sqrt(0.5) * 0.5 - 1e-9)
            << gap << ' ' << shift;
    }
}

TEST(CylinderOnMesh, LiesOnItsSideAndRollsOverInnerEdgesAsOnAPlane) {
  const Collider table = meshCollider(boxMesh(Vec3(4, 1, 4))), cylinder = colliderOf(Cylinder{0.5, 2}, {});
  for (const double gap : {0.0, 1e-10, -1e-10, 1e-4, -1e-4})
    for (double shift = -1; shift < 1.01; shift += 0.125) {
      const RigidTransform pose{rotationAbout(Vec3::UnitX(), shift) * kLyingDown, Vec3(0.1, 1 + gap, shift)};
      const auto contacts = MeshAndCylinder(table, cylinder, pose).contacts(1e-3);
      ASSERT_EQ(contacts.size(), 2u) << gap << ' ' << shift;
      EXPECT_NEAR(contacts[0].point.x() + contacts[1].point.x(), 0.2, 1e-12);
      EXPECT_NEAR(std::abs(contacts[0].point.x() - contacts[1].point.x()), 2, 1e-12);
      for (const Contact& contact : contacts) {
        EXPECT_NEAR(contact.separation, gap, 1e-14);
        EXPECT_LT((contact.normal - Vec3::UnitY()).norm(), 1e-14);
        EXPECT_NEAR(contact.point.z(), shift, 1e-12);
        EXPECT_EQ(contact.radiusB, 0.5);
      }
    }
}

TEST(CylinderOnMesh, InTheInnerCornerOfAnLTouchesBothWalls) {
  const Collider mesh = meshCollider(lPrismMesh()), cylinder = colliderOf(Cylinder{0.25, 0.6}, {});
  const Quat alongZ = rotationAbout(Vec3::UnitX(), M_PI / 2);
  const auto contacts = MeshAndCylinder(mesh, cylinder, {alongZ, Vec3(1.25, 1.25, 0.5)}).contacts(1e-9);
  int up = 0, aside = 0;
  for (const Contact& contact : contacts) {
    up += (contact.normal - Vec3::UnitY()).norm() < 1e-12;
    aside += (contact.normal - Vec3::UnitX()).norm() < 1e-12;
    EXPECT_NEAR(contact.separation, 0, 1e-14);
  }
  EXPECT_EQ(up, 2);
  EXPECT_EQ(aside, 2);
  EXPECT_EQ(contacts.size(), 4u);
}

// Over the rim of the table the table's edge is what holds it.
TEST(CylinderOnMesh, ReachingOverAnEdgeIsHeldThere) {
  const Collider table = meshCollider(boxMesh(Vec3(4, 1, 4))), cylinder = colliderOf(Cylinder{0.5, 2}, {});
  const auto contacts = MeshAndCylinder(table, cylinder, {kLyingDown, Vec3(1.5, 1, 0.3)}).contacts(1e-9);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_NEAR(std::max(contacts[0].point.x(), contacts[1].point.x()), 2, 1e-12);
  EXPECT_NEAR(std::min(contacts[0].point.x(), contacts[1].point.x()), 0.5, 1e-12);
}

}  // namespace
}  // namespace cradle
