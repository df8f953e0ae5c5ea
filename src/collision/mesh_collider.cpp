#include "collision/mesh_collider.h"

#include "collision/cylinder_on_mesh.h"
#include "collision/mesh_contact.h"
#include "collision/mesh_gap.h"
#include "collision/round_on_mesh.h"

namespace cradle {
namespace {

bool isRound(const Collider& collider) {
  return collider.kind() == ColliderKind::sphere || collider.kind() == ColliderKind::capsule;
}

bool isCylinder(const Collider& collider) {
  return collider.kind() == ColliderKind::cylinder;
}

/// Two colliders with surfaces, in the frames of these.
MeshPair pairOf(const Collider& a, const Collider& b, const RigidTransform& aFromB) {
  return {*a.mesh, *b.mesh, a.bodyFromMesh.inverse() * aFromB * b.bodyFromMesh};
}

/// A sphere or capsule in the frame of a mesh.
RoundSolid roundOf(const Collider& round, const RigidTransform& meshFromRound) {
  const Vec3 from = meshFromRound * round.points.front(), to = meshFromRound * round.points.back();
  return {{from, to - from}, round.radius};
}

void turnAround(ContactPoint& contact) {
  contact.normal = -contact.normal;
  std::swap(contact.radiusA, contact.radiusB);
}

}  // namespace

bool hasMesh(const Collider& a, const Collider& b) {
  return a.kind() == ColliderKind::mesh || b.kind() == ColliderKind::mesh;
}

double meshSeparation(const Collider& a, const Collider& b, const RigidTransform& aFromB, double enough,
                      FeatureNeighbourList& near) {
  if (isRound(b) || isCylinder(b)) return meshSeparation(b, a, aFromB.inverse(), enough, near);
  if (isRound(a)) return separationOf(roundOf(a, (aFromB * b.bodyFromMesh).inverse()), *b.mesh, enough);
  if (isCylinder(a)) return cylinderSeparation(Core(a, (aFromB * b.bodyFromMesh).inverse()), *b.mesh, enough);
  return gapBetween(pairOf(a, b, aFromB), near, enough).separation;
}

std::vector<ContactPoint> meshContacts(const Collider& a, const Collider& b, const RigidTransform& aFromB,
                                       double margin, FeatureNeighbourList& near) {
  std::vector<ContactPoint> contacts;
  RigidTransform aFromContacts = a.bodyFromMesh;
  if (isRound(a)) {
    aFromContacts = aFromB * b.bodyFromMesh;
    appendContacts(roundOf(a, aFromContacts.inverse()), *b.mesh, margin, contacts);
  } else if (isRound(b)) {
    appendContacts(roundOf(b, a.bodyFromMesh.inverse() * aFromB), *a.mesh, margin, contacts);
  } else if (isCylinder(a)) {
    aFromContacts = aFromB * b.bodyFromMesh;
    appendCylinderContacts(Core(a, aFromContacts.inverse()), *b.mesh, margin, contacts);
  } else if (isCylinder(b)) {
    appendCylinderContacts(Core(b, a.bodyFromMesh.inverse() * aFromB), *a.mesh, margin, contacts);
  } else {
    appendContacts(pairOf(a, b, aFromB), near, margin, contacts);
  }
  for (ContactPoint& contact : contacts) {
    if (isRound(b) || isCylinder(a)) turnAround(contact);
    contact.point = aFromContacts * contact.point;
    contact.normal = aFromContacts.rotation * contact.normal;
    contact.edge = aFromContacts.rotation * contact.edge;
  }
  return contacts;
}

std::shared_ptr<const MeshSurface> surfaceOf(const Polytope& polytope) {
  TriangleMesh mesh{polytope.vertices, {}};
  for (const Polytope::Face& face : polytope.faces)
    for (std::size_t i = 1; i + 1 < face.loop.size(); ++i)
      mesh.triangles.push_back({static_cast<std::uint32_t>(face.loop[0]), static_cast<std::uint32_t>(face.loop[i]),
                                static_cast<std::uint32_t>(face.loop[i + 1])});
  return std::make_shared<const MeshSurface>(surfaceOf(mesh));
}

}  // namespace cradle
