// Spheres and capsules are all points within a radius of a core, a point or a segment. Their contacts are the local
// minima of the core's distance from the surface. For each triangle within reach the candidates are: an end of the core
// over the face, over an edge or at a vertex, and the inside of the core across an edge or at a vertex. A candidate is
// a minimum if the direction to it is in the normal cone of its feature.

#include "collision/round_on_mesh.h"

#include <algorithm>
#include <cmath>

#include "collision/contact_reduction.h"
#include "collision/mesh_feature.h"
#include "collision/mesh_overlap.h"
#include "collision/normal_cone.h"

namespace cradle {
namespace {

using Feature = MeshPoint::Feature;

/// The nearest points of a core and a mesh, or a face that the core goes through.
struct CoreGap {
  double distance2;                                   // m^2; before anything is found, the square of the reach
  Vec3 onCore = Vec3::Zero(), onMesh = Vec3::Zero();  // m, if isFound
  bool isFound = false, intersects = false;
  double part = 0;         // of the core, 0..1, at which it goes through a face, if it does
  std::uint32_t face = 0;  // the face
};

struct CoreVisit {
  const MeshSurface& mesh;
  const Segment& core;
  CoreGap gap;

  double reach() const { return gap.intersects ? -1 : gap.distance2; }

  void operator()(std::uint32_t index) {
    const MeshSurface::Face& face = mesh.faces[index];
    const FlatTriangle triangle = triangleOf(mesh, index);
    const double start = triangle.heightOf(core.from), end = triangle.heightOf(core.at(1));
    if ((start < 0) != (end < 0) && triangle.isAbove(core.at(start / (start - end))))
      gap.intersects = true, gap.part = start / (start - end), gap.face = index;
    for (const double part : {0.0, 1.0}) {
      const double height = part > 0 ? end : start;
      const Vec3 point = core.at(part);
      if (height * height < gap.distance2 && triangle.isAbove(point)) keep(point, point - height * triangle.normal);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (!face.ownsEdge[i]) continue;
      const Segment edge = segmentOf(mesh, face.edges[i]);
      const SegmentParts parts = nearestParts(core, edge);
      keep(core.at(parts.a), edge.at(parts.b));
    }
  }

  void keep(const Vec3& onCore, const Vec3& onMesh) {
    const double distance2 = (onCore - onMesh).squaredNorm();
    if (distance2 >= gap.distance2) return;
    gap.distance2 = distance2, gap.onCore = onCore, gap.onMesh = onMesh, gap.isFound = true;
  }
};

Bounds boundsOf(const Segment& core) {
  Bounds bounds(core.from);
  bounds.extend(core.at(1));
  return bounds;
}

CoreGap gapOf(const Segment& core, const MeshSurface& mesh, double reach) {
  CoreVisit visit{mesh, core, {reach * reach}};
  visitNear(mesh.tree, boundsOf(core), visit);
  return visit.gap;
}

/// The depth of a core that goes through a sheet: that of its end on the side on which less of the core is.
SignedHeight farSide(const Segment& core, const MeshSurface& mesh, const CoreGap& gap) {
  const FlatTriangle triangle = triangleOf(mesh, gap.face);
  const Vec3 end = core.at(gap.part > 0.5 ? 1 : 0);
  const double height = triangle.heightOf(end), side = height > 0 ? -1 : 1;
  return {-std::abs(height), side * triangle.normal, end - height * triangle.normal, MeshPoint::Feature::face};
}

/// The deepest place of a core that goes through the surface, or is inside: an end, or a place beneath an edge.
SignedHeight deepestPlace(const Segment& core, const MeshSurface& mesh, const CoreGap& gap) {
  if (mesh.isSheet && gap.intersects) return farSide(core, mesh, gap);
  const SignedHeight start = heightOver(mesh, core.from), end = heightOver(mesh, core.at(1));
  const SignedHeight& deeper = end.height < start.height ? end : start;
  if (!gap.intersects) return deeper;
  const EdgeDepth beneath = depthOfEdge(mesh, core, gap.part, gap.face);
  if (-beneath.depth >= deeper.height) return deeper;
  return {-beneath.depth, beneath.normal, beneath.deepest + beneath.depth * beneath.normal, MeshPoint::Feature::edge};
}

bool isInside(const Segment& core, const MeshSurface& mesh) {
  return squaredDistance(mesh.tree.nodes[0], core.from) <= 0 && heightOver(mesh, core.from).height < 0;
}

/// Gathers the local minima of a core's distance from the surface.
struct RoundVisit {
  const RoundSolid& round;
  const MeshSurface& mesh;
  double margin;
  std::vector<ContactPoint>& contacts;
  double least = std::numeric_limits<double>::infinity();

  double reach() const { return (round.radius + margin) * (round.radius + margin); }

  void operator()(std::uint32_t index) {
    const MeshSurface::Face& face = mesh.faces[index];
    const FlatTriangle triangle = triangleOf(mesh, index);
    for (const double part : {0.0, 1.0}) {
      if (part > 0 && round.isSphere()) break;
      tryEnd(part, index, triangle);
    }
    if (round.isSphere()) return;
    for (std::size_t i = 0; i < 3; ++i) {
      if (face.ownsEdge[i]) tryAcross(face.edges[i]);
      if (face.ownsVertex[i]) tryVertex(round.core.nearestPart(cornerOf(triangle, i)), face.vertices[i]);
    }
  }

  /// The candidates at one end of the core, `part` 0 or 1.
  void tryEnd(double part, std::uint32_t index, const FlatTriangle& triangle) {
    const MeshSurface::Face& face = mesh.faces[index];
    const Vec3 point = round.core.at(part);
    const double height = triangle.heightOf(point);
    if (height > 0 && triangle.isAbove(point, kBeyondEnd))
      add(part, point - height * triangle.normal, {Feature::face, index});
    for (std::size_t i = 0; i < 3; ++i) {
      if (face.ownsEdge[i]) tryEdge(part, face.edges[i]);
      if (face.ownsVertex[i]) tryVertex(part, face.vertices[i]);
    }
  }

  void tryEdge(double part, std::uint32_t index) {
    const Segment edge = segmentOf(mesh, index);
    const Vec3 point = round.core.at(part), nearest = edge.at(edge.nearestPart(point)), away = point - nearest;
    const double distance = away.norm();
    const bool isWithin = std::abs(away.dot(edge.along)) <= kBeyondEnd * distance * edge.along.norm();
    if (distance > 0 && isWithin && isInNormalCone(mesh, mesh.edges[index], away / distance, 0))
      add(part, nearest, {Feature::edge, index});
  }

  void tryVertex(double part, std::uint32_t index) {
    const Vec3& vertex = mesh.vertices[index];
    const Vec3 away = round.core.at(part) - vertex;
    const double distance = away.norm();
    if (distance > 0 && isInNormalCone(mesh, index, away / distance, 0)) add(part, vertex, {Feature::vertex, index});
  }

  /// The candidate inside the core and inside an edge.
  void tryAcross(std::uint32_t index) {
    const Segment edge = segmentOf(mesh, index);
    const SegmentParts parts = nearestParts(round.core, edge);
    const Vec3 away = round.core.at(parts.a) - edge.at(parts.b);
    const double distance = away.norm();
    const bool isInner = parts.a > 0 && parts.a < 1 && parts.b > 0 && parts.b < 1;
    if (isInner && distance > 0 && isInNormalCone(mesh, mesh.edges[index], away / distance, margin))
      add(parts.a, edge.at(parts.b), {});
  }

  /// Adds a contact at a point of the mesh if the core's distance from it is a local minimum along the core. A sphere
  /// touches a feature only inside its Voronoi region, so that on the way from one feature to the next it touches one.
  void add(double part, const Vec3& onMesh, const TouchedFeature& touched) {
    const Vec3 away = round.core.at(part) - onMesh;
    const double distance = away.norm(), separation = distance - round.radius;
    if (separation > margin) return;
    const Vec3 outward = away / distance;
    const double length = round.core.along.norm(), rise = (part > 0 ? -1 : 1) * outward.dot(round.core.along);
    const bool isAtEnd = part <= 0 || part >= 1;
    if (isAtEnd && rise < -allowedAhead(margin, length)) return;
    if (round.isSphere() && isBeyond(touched)) return;
    const double radius = touched.feature == Feature::face ? kFlat : touched.feature == Feature::vertex ? 0 : kNotRound;
    ContactPoint contact{onMesh + separation / 2 * outward, -outward, separation, isAtEnd ? round.radius : kNotRound,
                         radius};
    if (round.isSphere()) {
      contact.feature = touched.index;
      if (touched.feature == Feature::edge) contact.edge = segmentOf(mesh, touched.index).along.normalized();
    }
    contacts.push_back(contact);
    least = std::min(least, separation);
  }

  /// Whether a sphere's centre is nearer to a neighbour of an edge or vertex.
  bool isBeyond(const TouchedFeature& touched) const {
    if (touched.feature == Feature::face) return false;
    return insideRegion(mesh, touched, round.core.from) < -kBeyondEnd * mesh.size;
  }
};

/// Leaves one contact at each place. Beside the borders between a face, an edge and a vertex a sphere may touch several
/// of them: the face goes before the edge, and that before the vertex.
void keepOneOfPlace(std::size_t first, double near, std::vector<ContactPoint>& contacts) {
  const auto rank = [](const ContactPoint& contact) {
    return contact.radiusB > 0 ? 0 : contact.edge != Vec3::Zero() ? 1 : 2;
  };
  std::size_t end = first;
  for (std::size_t i = first; i < contacts.size(); ++i) {
    const ContactPoint contact = contacts[i];
    const auto isSame = [&](const ContactPoint& other) { return (other.point - contact.point).norm() <= near; };
    const auto at = std::find_if(contacts.begin() + static_cast<std::ptrdiff_t>(first),
                                 contacts.begin() + static_cast<std::ptrdiff_t>(end), isSame);
    if (at == contacts.begin() + static_cast<std::ptrdiff_t>(end))
      contacts[end++] = contact;
    else if (rank(contact) < rank(*at))
      *at = contact;
  }
  contacts.resize(end);
}

/// One contact at the deepest place.
ContactPoint deepestContact(const RoundSolid& round, const SignedHeight& place) {
  const double separation = std::min(0.0, place.height) - round.radius;
  return {place.nearest + separation / 2 * place.normal, -place.normal, separation, round.radius, kNotRound};
}

}  // namespace

double separationOf(const RoundSolid& round, const MeshSurface& mesh, double enough) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();  // m: more than `enough`
  const double reach = std::max(enough, 0.0) + round.radius;
  if (squaredDistance(mesh.tree.nodes[0], boundsOf(round.core)) > reach * reach) return kUnknown;
  if (round.isSphere()) return heightOver(mesh, round.core.from).height - round.radius;
  const CoreGap gap = gapOf(round.core, mesh, reach);
  if (gap.intersects || isInside(round.core, mesh))
    return std::min(0.0, deepestPlace(round.core, mesh, gap).height) - round.radius;
  return gap.isFound ? std::sqrt(gap.distance2) - round.radius : kUnknown;
}

void appendContacts(const RoundSolid& round, const MeshSurface& mesh, double margin,
                    std::vector<ContactPoint>& contacts) {
  const double reach = round.radius + std::max(0.0, margin);
  if (squaredDistance(mesh.tree.nodes[0], boundsOf(round.core)) > reach * reach) return;
  const std::size_t first = contacts.size();
  const CoreGap gap = gapOf(round.core, mesh, reach);
  if (gap.intersects || isInside(round.core, mesh))
    return contacts.push_back(deepestContact(round, deepestPlace(round.core, mesh, gap)));
  const double distance = std::sqrt(gap.distance2), rounding = MeshTolerances(mesh.size).rounding;
  if (!gap.isFound || distance - round.radius > margin) return;
  RoundVisit visit{round, mesh, margin, contacts};
  visitNear(mesh.tree, boundsOf(round.core), visit);
  if (round.isSphere()) keepOneOfPlace(first, borderWidth(mesh), contacts);
  if (visit.least > distance - round.radius + rounding) {
    const Vec3 outward =
        distance > 0 ? Vec3((gap.onCore - gap.onMesh) / distance) : deepestPlace(round.core, mesh, gap).normal;
    const double separation = distance - round.radius;
    contacts.push_back({gap.onMesh + separation / 2 * outward, -outward, separation, kNotRound, kNotRound});
  }
  reduceContacts(first, mesh.size, contacts);
}

}  // namespace cradle
