// Each triangle is a flat polytope of its own, so that distances, ways out and manifolds are those of convex cores.
// What is new is which of them belong to the surface: a way out of one triangle that leads into the solid, or sideways
// over an edge at which the surface goes on, is none.

#include "collision/cylinder_on_mesh.h"

#include <algorithm>
#include <cmath>

#include "collision/contact_reduction.h"
#include "collision/core_separation.h"
#include "collision/gjk.h"
#include "collision/manifold.h"
#include "collision/normal_cone.h"

namespace cradle {
namespace {

constexpr double kRoundingRatio = 1e-12;  // of the size
constexpr double kFaceRatio = 2e-7;       // of the size: what a contact may give away for the normal of a face
constexpr double kLevelRatio = 1e-15;     // of the size: points as near in height are level
constexpr double kFarRatio = 10;       // of the depth: no way out over a side as far is shorter than that straight up
constexpr double kFaceCosine = 1e-12;  // below 1 by less: the normal is a face's
constexpr double kOnEdge = 1e-9;       // of a side: points as near to an edge are on it

/// The triangles of a mesh, one at a time, as a collider without volume.
class TriangleSolid {
 public:
  TriangleSolid() {
    Polytope polytope;
    polytope.vertices.assign(3, Vec3::Zero());
    polytope.faces = {{Vec3::UnitY(), 0, {0, 1, 2}}, {-Vec3::UnitY(), 0, {0, 2, 1}}};
    polytope.edges = {{0, 1, 0, 1}, {1, 2, 0, 1}, {2, 0, 0, 1}};
    polytope.firstNeighbor = {0, 2, 4, 6};
    polytope.neighbors = {1, 2, 0, 2, 1, 0};
    polytope.edgesAt = {0, 2, 0, 1, 1, 2};
    collider_.points = polytope.vertices;
    collider_.polytope = std::move(polytope);
  }

  Core coreOf(const FlatTriangle& triangle) {
    Polytope& polytope = *collider_.polytope;
    collider_.boundingRadius = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      polytope.vertices[i] = collider_.points[i] = cornerOf(triangle, i);
      collider_.boundingRadius = std::max(collider_.boundingRadius, (cornerOf(triangle, i) - triangle.a).norm());
    }
    for (std::size_t side = 0; side < 2; ++side) {
      polytope.faces[side].normal = side == 0 ? triangle.normal : Vec3(-triangle.normal);
      polytope.faces[side].offset = polytope.faces[side].normal.dot(triangle.a);
    }
    return Core(collider_, {});
  }

 private:
  Collider collider_;
};

Bounds boundsOf(const Core& cylinder) {
  Bounds bounds;
  for (const double side : {1.0, -1.0})
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) bounds.extend(cylinder.rimPoint(side, sign * Vec3::Unit(axis)));
  return bounds;
}

/// Whether all of a cylinder is farther than `distance` (m) behind a triangle's plane.
bool isUnder(const FlatTriangle& triangle, const Core& cylinder, double distance) {
  return triangle.normal.dot(triangle.a) - cylinder.supportValue(triangle.normal) > distance;
}

/// Whether the foot of a point is inside a triangle, `distance` (m) or more from its sides.
bool isFarInside(const FlatTriangle& triangle, const Vec3& point, double distance) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 along = cornerOf(triangle, (i + 1) % 3) - cornerOf(triangle, i);
    if (triangle.normal.cross(along).dot(point - cornerOf(triangle, i)) < distance * along.norm()) return false;
  }
  return true;
}

/// Whether a triangle is the side of a sheet that a cylinder is not on.
bool isTurnedAway(const MeshSurface& mesh, const FlatTriangle& triangle, const Core& cylinder) {
  return mesh.isSheet && triangle.heightOf(cylinder.center()) < 0;
}

/// Height (m) of a cylinder's lowest points over a triangle's plane.
double heightOver(const FlatTriangle& triangle, const Core& cylinder) {
  return -cylinder.supportValue(-triangle.normal) - triangle.normal.dot(triangle.a);
}

/// Gap (m) that a unit normal sees from a triangle to a cylinder.
double gapAlong(const FlatTriangle& triangle, const Core& cylinder, const Vec3& normal) {
  const double top = std::max({normal.dot(triangle.a), normal.dot(triangle.b), normal.dot(triangle.c)});
  return -cylinder.supportValue(-normal) - top;
}

/// Unit vector from a triangle's middle to the nearest point of a cylinder's axis; zero if that is the middle.
Vec3 towardsAxis(const FlatTriangle& triangle, const Core& cylinder) {
  const Segment axis{cylinder.end(-1), cylinder.end(1) - cylinder.end(-1)};
  const Vec3 middle = (triangle.a + triangle.b + triangle.c) / 3;
  return (axis.at(axis.nearestPart(middle)) - middle).normalized();
}

/// Whether one of a cylinder's lowest points, at that height, is above a triangle, as far from its sides as no way out
/// sideways is shorter.
bool isLowestAbove(const FlatTriangle& triangle, const Core& cylinder, double height) {
  const Vec3 one = cylinder.rimPoint(1, -triangle.normal), other = cylinder.rimPoint(-1, -triangle.normal);
  const double side = cylinder.axis().dot(triangle.normal) > 0 ? -1 : 1;
  const double same = height + kLevelRatio * cylinder.collider().boundingRadius, deep = std::max(-height, 0.0);
  for (const Vec3& point : {one, other, Vec3((one + other) / 2), cylinder.end(side)})
    if (triangle.heightOf(point) <= same && isFarInside(triangle, point, kFarRatio * deep)) return true;
  return false;
}

/// Where a cylinder is nearest to the surface, or deepest in it: normals point from the mesh to the cylinder.
struct CylinderVisit {
  const Core& cylinder;
  const MeshSurface& mesh;
  TriangleSolid& solid;
  SeparatingAxis least;             // of triangles apart, and of those whose way out leads out of the mesh
  SeparatingAxis straightOut = {};  // where all others lead into it
  bool isFound = false;

  bool intersects() const { return least.separation <= 0 || std::isfinite(straightOut.separation); }

  double reach() const { return least.separation > 0 ? least.separation * least.separation : 0; }

  void operator()(std::uint32_t index) {
    const FlatTriangle triangle = triangleOf(mesh, index);
    if (isTurnedAway(mesh, triangle, cylinder)) return;
    const double height = heightOver(triangle, cylinder), size = cylinder.collider().boundingRadius;
    // The height bounds the distance from below, and the way out along the normal is one.
    if (triangle.normal == Vec3::Zero() || height >= least.separation - kLevelRatio * size) return;
    if (isUnder(triangle, cylinder, std::max(least.separation, 0.0))) return;
    if (isLowestAbove(triangle, cylinder, height)) {
      least = {height, triangle.normal}, isFound = true;
      return;
    }
    // A gap along any unit vector bounds the distance too: along the nearest triangle's normal so far, towards the
    // axis, between nearest points.
    const auto isFarther = [&](double gap) { return gap >= least.separation - kLevelRatio * size; };
    if (isFound && isFarther(gapAlong(triangle, cylinder, least.normal))) return;
    const Vec3 outward = towardsAxis(triangle, cylinder);
    if (outward != Vec3::Zero() && isFarther(gapAlong(triangle, cylinder, outward))) return;
    const Core core = solid.coreOf(triangle);
    const GjkResult apart = distanceOf(core, cylinder);
    if (apart.distance > 0 && isFarther(apart.lowerBound)) return;
    const SeparatingAxis axis = separationOf(core, cylinder);
    if (axis.separation <= 0 && axis.normal.dot(triangle.normal) < 0) {
      if (axis.separation > -kRoundingRatio * size) return;  // beside its edge
      if (height > straightOut.separation) straightOut = {height, triangle.normal};
      return;
    }
    if (axis.separation < least.separation) least = axis, isFound = true;
  }
};

/// The gap, of which `separation` is `enough` (m) if it is larger.
CylinderVisit gapOf(const Core& cylinder, const MeshSurface& mesh, TriangleSolid& solid, double enough) {
  CylinderVisit visit{cylinder, mesh, solid, {enough, Vec3::UnitY()}};
  visitNear(mesh.tree, boundsOf(cylinder), visit);
  if (visit.intersects() && !(visit.least.separation <= 0)) visit.least = visit.straightOut, visit.isFound = true;
  return visit;
}

bool isInside(const Core& cylinder, const MeshSurface& mesh) {
  return squaredDistance(mesh.tree.nodes[0], cylinder.center()) <= 0 && heightOver(mesh, cylinder.center()).height < 0;
}

/// Whether the mesh lies behind the tangent plane of a contact on a triangle.
bool isOnSurface(const MeshSurface& mesh, std::uint32_t index, const ContactPoint& contact, double margin) {
  const MeshSurface::Face& face = mesh.faces[index];
  if (face.normal.dot(contact.normal) > 1 - kFaceCosine) return true;
  const FlatTriangle triangle = triangleOf(mesh, index);
  const Vec3 onMesh = contact.point - contact.separation / 2 * contact.normal;
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment edge{cornerOf(triangle, i), cornerOf(triangle, (i + 1) % 3) - cornerOf(triangle, i)};
    const double length = edge.along.norm(), part = edge.nearestPart(onMesh);
    if ((onMesh - edge.at(part)).norm() > kOnEdge * length) continue;
    if (part > kOnEdge && part < 1 - kOnEdge)
      return isInNormalCone(mesh, mesh.edges[face.edges[i]], contact.normal, margin);
    return isInNormalCone(mesh, face.vertices[part > 0.5 ? (i + 1) % 3 : i], contact.normal, margin);
  }
  return false;
}

/// The triangles whose boxes are within reach, in order of number.
struct NearTriangles {
  double reach2;  // m^2
  std::vector<std::uint32_t> found = {};

  double reach() const { return reach2; }
  void operator()(std::uint32_t index) { found.push_back(index); }
};

}  // namespace

double cylinderSeparation(const Core& cylinder, const MeshSurface& mesh, double enough) {
  TriangleSolid solid;
  const CylinderVisit visit = gapOf(cylinder, mesh, solid, std::max(enough, 0.0));
  if (visit.intersects()) return std::min(0.0, visit.least.separation);
  if (isInside(cylinder, mesh)) {
    const CylinderVisit any = gapOf(cylinder, mesh, solid, std::numeric_limits<double>::infinity());
    return -any.least.separation;
  }
  return visit.isFound ? visit.least.separation : std::numeric_limits<double>::infinity();
}

void appendCylinderContacts(const Core& cylinder, const MeshSurface& mesh, double margin,
                            std::vector<ContactPoint>& contacts) {
  TriangleSolid solid;
  const double reach = std::max(margin, 0.0), size = std::min(mesh.size, 2 * cylinder.collider().boundingRadius);
  const CylinderVisit visit = gapOf(cylinder, mesh, solid, reach + kRoundingRatio * size);
  const bool inside = !visit.intersects() && isInside(cylinder, mesh);
  if (!inside && (!visit.isFound || visit.least.separation > margin)) return;
  const std::size_t first = contacts.size();
  NearTriangles near{reach * reach};
  visitNear(mesh.tree, boundsOf(cylinder), near);
  std::sort(near.found.begin(), near.found.end());
  double least = std::numeric_limits<double>::infinity();
  std::vector<ContactPoint> ofTriangle;
  for (const std::uint32_t index : near.found) {
    const FlatTriangle triangle = triangleOf(mesh, index);
    const double height = heightOver(triangle, cylinder);
    if (triangle.normal == Vec3::Zero() || height > reach || isUnder(triangle, cylinder, reach)) continue;
    if (isTurnedAway(mesh, triangle, cylinder)) continue;
    if (visit.isFound && gapAlong(triangle, cylinder, visit.least.normal) > reach) continue;
    const Core core = solid.coreOf(triangle);
    const SeparatingAxis axis = isLowestAbove(triangle, cylinder, height) ? SeparatingAxis{height, triangle.normal}
                                                                          : contactAxis(core, cylinder);
    if (axis.separation > margin || axis.normal.dot(triangle.normal) <= 0) continue;
    ofTriangle.clear();
    appendManifold(core, cylinder, axis, margin, ofTriangle);
    for (const ContactPoint& contact : ofTriangle) {
      if (!isOnSurface(mesh, index, contact, margin)) continue;
      contacts.push_back(contact);
      least = std::min(least, contact.separation);
    }
  }
  const SignedHeight center = inside ? heightOver(mesh, cylinder.center()) : SignedHeight{};
  const SeparatingAxis gap =
      inside ? SeparatingAxis{cylinderSeparation(cylinder, mesh, 0), center.normal} : visit.least;
  if (!(least <= gap.separation + kFaceRatio * size)) {
    const Vec3 onCylinder = cylinder.supportPoint(-gap.normal);
    contacts.push_back(
        {onCylinder - gap.separation / 2 * gap.normal, gap.normal, gap.separation, kNotRound, kNotRound});
  }
  reduceContacts(first, size, contacts);
}

}  // namespace cradle
