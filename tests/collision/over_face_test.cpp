#include "collision/over_face.h"

#include <gtest/gtest.h>

#include "collision/mesh_surface.h"
#include "collision/triangle_soup.h"
#include "rounding.h"

namespace cradle {
namespace {

/// A capsule of 0.1 m x 0.4 m, body 0, that leans on the top of an L of meshes, or on a table; held by its lower end.
struct LeaningCapsule {
  ContactGeometry geometry;
  ContactConstraint contact;
  VectorX state = VectorX::Zero(stateSize(1));

  /// `end` (m): where the lower end's sphere touches; the capsule leans by `tilt` from upright, about z.
  LeaningCapsule(const MeshSurface& surface, const RigidTransform& worldFromMesh, const Vec3& end, const Vec3& normal,
                 double tilt) {
    Collider capsule = colliderOf(Capsule{0.1, 0.4}, {}), mesh;
    capsule.body = 0;
    mesh.points = surface.vertices;
    mesh.mesh = std::make_shared<const MeshSurface>(surface);
    mesh.bodyFromMesh = worldFromMesh;
    geometry.colliders = {capsule, mesh};
    const Quat turn = worldFromMesh.rotation * rotationAbout(Vec3::UnitZ(), tilt);
    const Vec3 lower = worldFromMesh * (end + 0.1 * normal);
    centerOfMass(state, 0) = lower + turn * Vec3(0, 0.2, 0), setOrientation(state, 0, turn);
    contact.centerA = {0, Vec3(0, -0.2, 0)}, contact.radiusA = 0.1;
    contact.surfaceB = {kFixed, worldFromMesh * end}, contact.normalB = worldFromMesh.rotation * normal;
  }
  OverFace over(bool isMeshFirst = false) {
    if (isMeshFirst) std::swap(geometry.colliders[0], geometry.colliders[1]);
    const OverFace found = overFace(geometry, {0, 1, false, {}}, contact, state);
    return found;
  }
};

// On a table of 4 x 1 x 4 m, upright: the centre is over the place, and a sphere of 0.3 m around it stays within the
// outline. The other end is 0.4 m up, or that times the cosine of the tilt.
TEST(OverFace, OfACapsuleOnATableIsItsTopAsFarAsTheRim) {
  const MeshSurface table = surfaceOf(boxMesh(Vec3(4, 1, 4)));
  for (const RigidTransform& pose : {RigidTransform(), askew()})
    for (const bool isMeshFirst : {false, true})
      for (const double tilt : {0.0, 0.3}) {
        LeaningCapsule capsule(table, pose, Vec3(1.2, 0.5, 0.4), Vec3::UnitY(), tilt);
        const OverFace over = capsule.over(isMeshFirst);
        ASSERT_NE(over.solid, nullptr);
        EXPECT_EQ(over.solid->kind(), ColliderKind::capsule);
        EXPECT_EQ(over.surface->faces[over.face.index].normal, Vec3::UnitY());
        const double leans = -0.2 * std::sin(tilt);  // of the centre, along x
        EXPECT_NEAR(roomBeside(over, 5), 2 - (1.2 + leans) - 0.3, 1e-14);
        EXPECT_NEAR(heightOfOthers(over, {Vec3(0, -0.2, 0)}), 0.4 * std::cos(tilt), 1e-14);
        EXPECT_NEAR(heightOfOthers(over, {}), 0, 1e-14);
        EXPECT_EQ(heightOfOthers(over, {Vec3(0, -0.2, 0), Vec3(0, 0.2, 0)}), INFINITY);
      }
}

// On the tread of an L the riser, in front of the tread, may be nearer than the rim; and beside the rim there is no
// room.
TEST(OverFace, RoomEndsAtWhatIsInFrontOfTheFace) {
  const MeshSurface prism = surfaceOf(moved(lPrismMesh(), [](const Vec3& v) { return Vec3(v.x(), v.y(), 4 * v.z()); }));
  LeaningCapsule capsule(prism, {}, Vec3(1.6, 1, 2.1), Vec3::UnitY(), 0);
  EXPECT_NEAR(roomBeside(capsule.over(), 5), 0.6 - 0.3, 1e-14);  // the riser at x = 1
  LeaningCapsule atRim(prism, {}, Vec3(2.9, 1, 2.1), Vec3::UnitY(), 0);
  EXPECT_NEAR(roomBeside(atRim.over(), 5), 0.1 - 0.3, 1e-14);
}

// A capsule of 0.2 m lies in a slot of 0.25 m: its contact is on the floor, though places on its upper side are nearer
// to the ceiling.
TEST(OverFace, UnderACeilingIsTheFloor) {
  TriangleMesh slot = boxMesh(Vec3(4, 1, 4));
  const TriangleMesh ceiling = moved(slot, [](const Vec3& v) { return Vec3(v.x(), v.y() + 1.25, v.z()); });
  const auto first = static_cast<std::uint32_t>(slot.vertices.size());
  slot.vertices.insert(slot.vertices.end(), ceiling.vertices.begin(), ceiling.vertices.end());
  for (const auto& [i, j, k] : ceiling.triangles) slot.triangles.push_back({first + i, first + j, first + k});
  LeaningCapsule capsule(surfaceOf(slot), {}, Vec3(0.2, 0.5, 0.4), Vec3::UnitY(), M_PI / 2);
  const OverFace over = capsule.over();
  ASSERT_NE(over.solid, nullptr);
  EXPECT_EQ(over.surface->faces[over.face.index].normal, Vec3::UnitY());
  EXPECT_NEAR(heightOfOthers(over, {Vec3(0, -0.2, 0)}), 0, 1e-14);
}

// Either side of a sheet, by the contact's normal.
TEST(OverFace, OfASheetIsTheSideThatIsTouched) {
  const MeshSurface sheet = sheetOf({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}, {{0, 1, 2}, {0, 2, 3}}});
  for (const double side : {1.0, -1.0}) {
    LeaningCapsule capsule(sheet, {}, Vec3(0.3, 0, 0.9), side * Vec3::UnitY(), side > 0 ? 0 : M_PI);
    const OverFace over = capsule.over();
    ASSERT_NE(over.solid, nullptr);
    EXPECT_EQ(over.surface->faces[over.face.index].normal, Vec3(0, side, 0));
    EXPECT_NEAR(heightOfOthers(over, {Vec3(0, -0.2, 0)}), 0.4, 1e-14);
  }
}

// A contact on an edge, one of a sphere or cylinder, and one whose normal is not the face's have no such face.
TEST(OverFace, IsNoneOfOtherContacts) {
  const MeshSurface table = surfaceOf(boxMesh(Vec3(4, 1, 4)));
  LeaningCapsule onEdge(table, {}, Vec3(1.2, 0.5, 0.4), Vec3::UnitY(), 0);
  onEdge.contact.radiusB = 0;
  EXPECT_EQ(onEdge.over().solid, nullptr);
  LeaningCapsule tilted(table, {}, Vec3(1.2, 0.5, 0.4), Vec3::UnitY(), 0);
  tilted.contact.normalB = Vec3(1e-5, 1, 0).normalized();
  EXPECT_EQ(tilted.over().solid, nullptr);
  for (const Collider& round : {colliderOf(Sphere{0.1}, {}), colliderOf(Cylinder{0.1, 0.4}, {})}) {
    LeaningCapsule other(table, {}, Vec3(1.2, 0.5, 0.4), Vec3::UnitY(), 0);
    other.geometry.colliders[0] = round, other.geometry.colliders[0].body = 0;
    EXPECT_EQ(other.over().solid, nullptr);
  }
}

}  // namespace
}  // namespace cradle
