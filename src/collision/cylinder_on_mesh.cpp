// Each triangle is a flat convex polytope, so that distances, separating axes and manifolds are those of convex cores.
// The rest of the work is to tell which of them belong to the surface: a way out of one triangle that leads into the
// solid, or sideways over an edge at which the surface goes on, is no way out of the mesh; and a contact counts only if
// its normal is in the normal cone of the feature that it touches.

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

// Of the size: a contact on a face may see a gap larger than the least one by as much, twice the preference of convex
// cores for faces (ConvexTolerances::facePreference): either of two triangles may have given it away.
constexpr double kFaceGapRatio = 2e-7;
constexpr double kLevelRatio = 1e-15;  // of the size: points at heights that differ by ten unit roundoffs are level
// Of the depth: a way out sideways over a side of the triangle that is as far is longer than that along the normal, as
// long as the next face bends away by more than 0.1 rad.
constexpr double kSidewaysRatio = 10;
// A cosine below 1 by less (1.4e-6 rad): the contact's normal is the face's.
constexpr double kFaceCosineError = 1e-12;

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
    collider_.polytope = polytope_ = std::make_shared<Polytope>(std::move(polytope));
  }

  Core coreOf(const FlatTriangle& triangle) {
    Polytope& polytope = *polytope_;
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
  std::shared_ptr<Polytope> polytope_;  // the collider's
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

/// Whether one of a cylinder's lowest points, at that height, is above a triangle and so far from its sides that no way
/// out sideways is shorter than that along the normal.
bool isLowestAbove(const FlatTriangle& triangle, const Core& cylinder, double height) {
  const Vec3 one = cylinder.rimPoint(1, -triangle.normal), other = cylinder.rimPoint(-1, -triangle.normal);
  const double side = cylinder.axis().dot(triangle.normal) > 0 ? -1 : 1;
  const double level = height + kLevelRatio * cylinder.collider().boundingRadius, deep = std::max(-height, 0.0);
  for (const Vec3& point : {one, other, Vec3((one + other) / 2), cylinder.end(side)})
    if (triangle.heightOf(point) <= level && isFarInside(triangle, point, kSidewaysRatio * deep)) return true;
  return false;
}

/// Visits triangles for the one that a cylinder is nearest to, or deepest in. Normals point from the mesh to the
/// cylinder.
struct CylinderVisit {
  const Core& cylinder;
  const MeshSurface& mesh;
  TriangleSolid& solid;
  SeparatingAxis least;  // least separation of triangles that are apart, or from which a way leads out of the mesh
  SeparatingAxis straightOut = {};  // along a face's normal, where all other ways lead into the mesh
  bool isFound = false;

  bool intersects() const { return least.separation <= 0 || std::isfinite(straightOut.separation); }

  double reach() const { return least.separation > 0 ? least.separation * least.separation : 0; }

  void operator()(std::uint32_t index) {
    const FlatTriangle triangle = triangleOf(mesh, index);
    if (isTurnedAway(mesh, triangle, cylinder)) return;
    const double height = heightOver(triangle, cylinder), size = cylinder.collider().boundingRadius;
    // The height is a lower bound on the distance; and the way out along the normal is no longer than -height.
    if (triangle.normal == Vec3::Zero() || height >= least.separation - kLevelRatio * size) return;
    if (isUnder(triangle, cylinder, std::max(least.separation, 0.0))) return;
    if (isLowestAbove(triangle, cylinder, height)) {
      least = {height, triangle.normal}, isFound = true;
      return;
    }
    // The gap along any unit vector is a lower bound on the distance, too. Three are tried: the axis of the nearest
    // triangle so far, the direction towards the cylinder's axis, and that between the nearest points.
    const auto isFarther = [&](double gap) { return gap >= least.separation - kLevelRatio * size; };
    if (isFound && isFarther(gapAlong(triangle, cylinder, least.normal))) return;
    const Vec3 outward = towardsAxis(triangle, cylinder);
    if (outward != Vec3::Zero() && isFarther(gapAlong(triangle, cylinder, outward))) return;
    const Core core = solid.coreOf(triangle);
    const GjkResult apart = distanceOf(core, cylinder, std::max(least.separation, 0.0));
    if (apart.distance > 0 && isFarther(apart.lowerBound)) return;
    const SeparatingAxis axis = separationOf(core, cylinder);
    if (axis.separation <= 0 && axis.normal.dot(triangle.normal) < 0) {
      if (axis.separation > -MeshTolerances(size).rounding) return;  // the cylinder is beside an edge of the triangle
      if (height > straightOut.separation) straightOut = {height, triangle.normal};
      return;
    }
    if (axis.separation < least.separation) least = axis, isFound = true;
  }
};

/// The least separation, within `enough` (m): if there is none, `separation` is that.
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
  if (face.normal.dot(contact.normal) > 1 - kFaceCosineError) return true;
  const FlatTriangle triangle = triangleOf(mesh, index);
  const Vec3 onMesh = contact.point - contact.separation / 2 * contact.normal;
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment edge{cornerOf(triangle, i), cornerOf(triangle, (i + 1) % 3) - cornerOf(triangle, i)};
    const double length = edge.along.norm(), part = edge.nearestPart(onMesh);
    if ((onMesh - edge.at(part)).norm() > kBeyondEnd * length) continue;
    if (part > kBeyondEnd && part < 1 - kBeyondEnd)
      return isInNormalCone(mesh, mesh.edges[face.edges[i]], contact.normal, margin);
    return isInNormalCone(mesh, face.vertices[part > 0.5 ? (i + 1) % 3 : i], contact.normal, margin);
  }
  return false;
}

/// Visits the triangles whose boxes are within reach.
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
  const CylinderVisit visit = gapOf(cylinder, mesh, solid, reach + MeshTolerances(size).rounding);
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
    const bool isLowest = isLowestAbove(triangle, cylinder, height);
    if (!isLowest && distanceOf(core, cylinder, reach).lowerBound > reach) continue;
    const SeparatingAxis axis = isLowest ? SeparatingAxis{height, triangle.normal} : contactAxis(core, cylinder);
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
  if (!(least <= gap.separation + kFaceGapRatio * size)) {
    const Vec3 onCylinder = cylinder.supportPoint(-gap.normal);
    contacts.push_back(
        {onCylinder - gap.separation / 2 * gap.normal, gap.normal, gap.separation, kNotRound, kNotRound});
  }
  reduceContacts(first, size, contacts);
}

}  // namespace cradle
