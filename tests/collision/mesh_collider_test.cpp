#include "collision/mesh_collider.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/feature_neighbour_list.h"
#include "collision/mesh_surface.h"
#include "math/rotation.h"
#include "mesh/mass_properties.h"
#include "mesh/sample_meshes.h"

// Shapes above the top of a mesh, in frames of their bodies that are askew: which of both is A must not matter.

namespace cradle {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kAskewRounding = 1e-13;  // m, of coordinates of a few m that three poses turn and shift

/// A box of 2 x 1 x 2 m as a mesh, whose body's frame is askew.
Collider boxAsMesh() {
  Collider collider;
  collider.bodyFromMesh = {rotationAbout(Vec3(1, 3, -1), 0.8), Vec3(-0.4, 1.1, 0.2)};
  const TriangleMesh mesh = boxMesh(Vec3(2, 1, 2));
  for (const Vec3& vertex : mesh.vertices) collider.points.push_back(collider.bodyFromMesh * vertex);
  collider.mesh = std::make_shared<const MeshSurface>(surfaceOf(mesh));
  return collider;
}

/// A shape over the mesh's top, y = 0.5 m in the frame of the mesh: as a collider of a body that is askew, and where
/// the mesh's body is in that one's frame.
struct OverMesh {
  template <class Shape>
  OverMesh(const Shape& shape, const RigidTransform& meshFromShape) {
    const RigidTransform bodyFromShape{rotationAbout(Vec3(-2, 1, 1), 1.9), Vec3(0.3, 0.2, -0.5)};
    collider = colliderOf(shape, bodyFromShape);
    const RigidTransform meshFromBody = meshFromShape * bodyFromShape.inverse();
    fromMesh = meshFromBody.inverse() * mesh.bodyFromMesh.inverse();
  }
  double separation(bool isMeshA, double enough = kInfinite) const {
    FeatureNeighbourList none;
    return isMeshA ? meshSeparation(mesh, collider, fromMesh.inverse(), enough, none)
                   : meshSeparation(collider, mesh, fromMesh, enough, none);
  }
  /// In the frame of A.
  std::vector<ContactPoint> own(bool isMeshA, double margin) const {
    FeatureNeighbourList none;
    return isMeshA ? meshContacts(mesh, collider, fromMesh.inverse(), margin, none)
                   : meshContacts(collider, mesh, fromMesh, margin, none);
  }
  /// In the frame of the mesh, with the normal from the mesh to the shape.
  std::vector<ContactPoint> contacts(bool isMeshA, double margin) const {
    std::vector<ContactPoint> found = own(isMeshA, margin);
    const RigidTransform back = isMeshA ? mesh.bodyFromMesh.inverse() : (fromMesh * mesh.bodyFromMesh).inverse();
    for (ContactPoint& contact : found) {
      contact.point = back * contact.point, contact.normal = back.rotation * contact.normal;
      if (isMeshA) continue;
      contact.normal = -contact.normal;
      std::swap(contact.radiusA, contact.radiusB);
    }
    return found;
  }
  Collider mesh = boxAsMesh(), collider;
  RigidTransform fromMesh;  // collider's body from mesh's body
};

void expectMiddleContact(const ContactPoint& contact, const Vec3& above, double separation) {
  EXPECT_NEAR(contact.separation, separation, kAskewRounding);
  EXPECT_LT((contact.normal - Vec3::UnitY()).norm(), kAskewRounding);
  EXPECT_LT((contact.point - above).norm(), kAskewRounding);
}

TEST(MeshCollider, OfASphereHasOneContactBelowItsCenter) {
  for (const double separation : {0.02, -0.03})
    for (const bool isMeshA : {false, true}) {
      const OverMesh at(Sphere{0.3}, {Quat::Identity(), Vec3(0.4, 0.8 + separation, -0.3)});
      EXPECT_NEAR(at.separation(isMeshA), separation, kAskewRounding);
      const std::vector<ContactPoint> contacts = at.contacts(isMeshA, 0.025);
      ASSERT_EQ(contacts.size(), 1u);
      expectMiddleContact(contacts[0], Vec3(0.4, 0.5 + separation / 2, -0.3), separation);
      EXPECT_EQ(contacts[0].radiusA, kFlat);
      EXPECT_EQ(contacts[0].radiusB, 0.3);
      EXPECT_TRUE(at.contacts(isMeshA, separation - 0.001).empty());
    }
}

// Over an edge of the mesh the contact tells its direction; here it is along z.
TEST(MeshCollider, OfASphereOverAnEdgeTellsTheEdge) {
  for (const bool isMeshA : {false, true}) {
    const Vec3 out(0.6, 0.8, 0);
    const OverMesh at(Sphere{0.3}, {Quat::Identity(), Vec3(1, 0.5, 0.2) + 0.31 * out});
    EXPECT_NEAR(at.separation(isMeshA), 0.01, kAskewRounding);
    const std::vector<ContactPoint> contacts = at.contacts(isMeshA, 0.02);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_LT((contacts[0].normal - out).norm(), kAskewRounding);
    const RigidTransform back = isMeshA ? at.mesh.bodyFromMesh : at.fromMesh * at.mesh.bodyFromMesh;
    const std::vector<ContactPoint> own = at.own(isMeshA, 0.02);
    EXPECT_NEAR(std::abs(own[0].edge.dot(back.rotation * Vec3::UnitZ())), 1, kAskewRounding);
  }
}

// A capsule and a cylinder that lie on the top, along x: contacts at both ends.
TEST(MeshCollider, OfWhatLiesHasContactsAtItsEnds) {
  const RigidTransform lying{rotationAbout(Vec3::UnitZ(), M_PI / 2), Vec3(0.1, 0.5 + 0.2 - 0.01, 0.3)};
  for (const bool isMeshA : {false, true})
    for (const OverMesh& at : {OverMesh(Capsule{0.2, 0.6}, lying), OverMesh(Cylinder{0.2, 0.6}, lying)}) {
      EXPECT_NEAR(at.separation(isMeshA), -0.01, kAskewRounding);
      std::vector<ContactPoint> contacts = at.contacts(isMeshA, 0.001);
      ASSERT_GE(contacts.size(), 2u);
      std::sort(contacts.begin(), contacts.end(),
                [](const ContactPoint& left, const ContactPoint& right) { return left.point.x() < right.point.x(); });
      expectMiddleContact(contacts.front(), Vec3(0.1 - 0.3, 0.5 - 0.005, 0.3), -0.01);
      expectMiddleContact(contacts.back(), Vec3(0.1 + 0.3, 0.5 - 0.005, 0.3), -0.01);
    }
}

// A box of 0.4 m that stands on the top, as a mesh of a body of its own: its four lower corners.
TEST(MeshCollider, OfAMeshHasTheCornersOfTheSmallerFace) {
  for (const bool isMeshA : {false, true}) {
    OverMesh at(Box{Vec3::Constant(0.4)}, {rotationAbout(Vec3::UnitY(), 0.3), Vec3(0.1, 0.5 + 0.2 - 0.001, 0.3)});
    at.collider.mesh = surfaceOf(*at.collider.polytope);  // in the body's frame
    EXPECT_NEAR(at.separation(isMeshA), -0.001, kAskewRounding);
    const std::vector<ContactPoint> contacts = at.contacts(isMeshA, 1e-4);
    ASSERT_EQ(contacts.size(), 4u);
    Vec3 middle = Vec3::Zero();
    for (const ContactPoint& contact : contacts) {
      EXPECT_NEAR((contact.point - Vec3(0.1, 0.4995, 0.3)).norm(), 0.2 * std::sqrt(2.0), kAskewRounding);
      expectMiddleContact(contact, contact.point, -0.001);
      middle += contact.point / 4;
    }
    EXPECT_LT((middle - Vec3(0.1, 0.4995, 0.3)).norm(), kAskewRounding);
  }
}

TEST(MeshCollider, NeedNotKnowWhatIsFarther) {
  const OverMesh at(Sphere{0.3}, {Quat::Identity(), Vec3(0, 3, 0)});
  for (const bool isMeshA : {false, true}) {
    EXPECT_NEAR(at.separation(isMeshA, 2.3), 2.2, kAskewRounding);
    EXPECT_GE(at.separation(isMeshA, 0.5), 0.5);
  }
}

TEST(MeshCollider, TakesPartIfOneOfBothIsAMesh) {
  const Collider ball = colliderOf(Sphere{0.3}, {}), box = colliderOf(Box{}, {});
  EXPECT_TRUE(hasMesh(boxAsMesh(), ball));
  EXPECT_TRUE(hasMesh(box, boxAsMesh()));
  EXPECT_FALSE(hasMesh(box, ball));
}

// Two triangles a side, wound as the faces are: it encloses the volume of the box.
TEST(MeshCollider, HasTheSurfaceOfAPolytope) {
  const auto surface = surfaceOf(*colliderOf(Box{Vec3(0.4, 0.6, 1)}, askew()).polytope);
  EXPECT_EQ(surface->vertices.size(), 8u);
  ASSERT_EQ(surface->faces.size(), 12u);
  TriangleMesh mesh{surface->vertices, {}};
  for (const MeshSurface::Face& face : surface->faces)
    mesh.triangles.push_back({face.vertices[0], face.vertices[1], face.vertices[2]});
  EXPECT_NEAR(signedVolume(mesh), 0.4 * 0.6, 1e-14);
}

}  // namespace
}  // namespace cradle
