// The incident feature is clipped against the side planes of the reference face (D. Gregorius, "Robust Contact Creation
// for Physics Simulations", GDC 2015). Its points count as corners, or as points of the spheres around them, also where
// it was clipped, as they lie on it. Discs are polygons of 16 sides: those of the prism inside the cylinder. Where a
// disc is the reference, the polygon is grown to one around it, so that a corner that stands on the rim is not lost.

#include "collision/manifold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory_resource>

#include "collision/convex_tolerances.h"
#include "collision/core_separation.h"
#include "collision/gjk.h"
#include "collision/polygon_clip.h"

namespace cradle {
namespace {

// Between a cylinder's axis and the contact's normal, 45 degrees: nearer, its end carries, else its side; of a capsule,
// nearer, the sphere at its end carries alone.
constexpr double kStandingCosine = 0.7;
// 1 / cos(pi / 16): from a polygon of 16 sides to one around its disc
constexpr double kOutscribedRatio = 1.0195911582083184;
// rad: a cylinder so little tilted rolls at both rims like a sphere of its radius, to the square of this, 1e-10 of it.
constexpr double kLyingCosine = 1e-5;

using Memory = std::pmr::monotonic_buffer_resource;

/// The part of a collider's surface that may carry contact: a face, a line, or a point.
struct FeatureManifold {
  explicit FeatureManifold(Memory* memory) : points(memory) {}
  Points points;                // m: one, the ends of a line, or a polygon, counter-clockwise seen from outside
  double radius = kNotRound;    // m, at those points as in ContactPoint
  bool isFlat = false;          // a face across the contact's normal
  Vec3 outward = Vec3::Zero();  // of that face, unit: its own normal, at kParallelAngle to the contact's at most
};

/// Radius (m) of the spheres around the points of a core.
double radiusAround(const Core& core) {
  return core.collider().radius;
}

void addLoop(const Core& core, const Polytope::Face& face, FeatureManifold& patch) {
  for (const std::size_t vertex : face.loop)
    patch.points.push_back(core.placed(core.collider().polytope->vertices[vertex]));
}

bool areParallel(const Vec3& normal, const Vec3& outward) {
  constexpr double angle = ConvexTolerances::kParallelAngle;
  return (normal - outward).squaredNorm() < angle * angle;
}

void addEndOfCylinder(const Core& core, const Vec3& outward, FeatureManifold& patch) {
  const Polytope& prism = *core.collider().polytope;
  const double cosine = core.axis().dot(outward);
  addLoop(core, prism.faces[prism.faces.size() - (cosine > 0 ? 2 : 1)], patch);  // as inscribedPrism has them
  patch.outward = cosine > 0 ? core.axis() : Vec3(-core.axis());
  patch.isFlat = areParallel(patch.outward, outward);
  if (patch.isFlat) patch.radius = 0;  // corners; of a tilted end a rim carries, which rolls
}

void addFaceOrCorner(const Core& core, const Vec3& outward, FeatureManifold& patch) {
  const Polytope& polytope = *core.collider().polytope;
  const Vec3 direction = core.turnedBack(outward);
  const std::size_t vertex = supportVertex(polytope, direction);
  const Polytope::Face* best = nullptr;
  double largest = ConvexTolerances::kMinCarryingCosine;
  for (std::size_t i = polytope.firstNeighbor[vertex]; i < polytope.firstNeighbor[vertex + 1]; ++i) {
    const Polytope::Edge& edge = polytope.edges[polytope.edgesAt[i]];
    const Polytope::Face& face = polytope.faces[edge.from == vertex ? edge.left : edge.right];
    if (face.normal.dot(direction) > largest) largest = face.normal.dot(direction), best = &face;
  }
  patch.radius = 0;
  if (!best) return patch.points.push_back(core.placed(polytope.vertices[vertex]));
  addLoop(core, *best, patch);
  patch.outward = core.turned(best->normal);
  patch.isFlat = areParallel(best->normal, direction);
}

/// The feature that faces `outward`, the contact's normal out of the collider. It may be tilted.
FeatureManifold manifoldOf(const Core& core, const Vec3& outward, Memory* memory) {
  FeatureManifold patch(memory);
  const double cosine = core.axis().dot(outward);
  const Vec3 around = radiusAround(core) * outward;
  if (core.collider().kind() == ColliderKind::polytope) {
    addFaceOrCorner(core, outward, patch);
  } else if (core.rimRadius() > 0) {
    if (std::abs(cosine) > kStandingCosine) {
      addEndOfCylinder(core, outward, patch);
    } else {
      patch.points = {core.rimPoint(1, outward), core.rimPoint(-1, outward)};
      if (std::abs(cosine) < kLyingCosine) patch.radius = core.rimRadius();
    }
  } else {
    patch.radius = radiusAround(core);
    if (std::abs(cosine) < kStandingCosine)
      patch.points = {core.end(1) + around, core.end(-1) + around};
    else
      patch.points = {core.supportPoint(outward) + around};
  }
  return patch;
}

/// A face in the plane of contact. Gaps are heights over its own plane: over one across the contact's normal, which may
/// be tilted by 1e-7, points of one height would have different gaps.
struct Reference {
  Vec3 normal;    // unit, outwards: the contact's
  Vec3 outward;   // unit: the face's own
  double offset;  // m, along `outward`

  double heightOf(const Vec3& point) const { return outward.dot(point) - offset; }
};

/// Contacts of an incident manifold, clipped already, on a face of A: a point each that is within `margin` (m).
void appendOnFace(const Reference& face, FeatureManifold& incident, double margin, std::vector<ContactPoint>& points) {
  std::erase_if(incident.points, [&](const Vec3& point) { return face.heightOf(point) > margin; });
  thinOut(kMaxManifoldPoints, incident.points);
  for (const Vec3& point : incident.points) {
    const double separation = face.heightOf(point);
    points.push_back({point - separation / 2 * face.normal, face.normal, separation, kFlat, incident.radius});
  }
}

/// Grows the polygon in a disc to one around it.
void growDisc(const Core& core, FeatureManifold& patch) {
  const Vec3 center = core.end(core.axis().dot(patch.points[0] - core.center()) < 0 ? -1 : 1);
  for (Vec3& point : patch.points) point = center + kOutscribedRatio * (point - center);
}

enum class OverFace { nothing, shallow, deepest };

/// Contacts of an incident manifold on a flat manifold of A, whose normal (out of A) is `normal`. Changes both. Returns
/// what of the incident manifold is over the face: its deepest point, or not that, as rims are polygons.
OverFace clipOnFace(const Core& core, const Core& other, const Vec3& normal, FeatureManifold& reference,
                    FeatureManifold& incident, double margin, std::vector<ContactPoint>& points) {
  if (core.rimRadius() > 0) growDisc(core, reference);
  const ConvexTolerances tolerances(core, other);
  const Reference face{normal, reference.outward, core.supportValue(reference.outward)};
  const Vec3 deepest = other.supportPoint(-normal) - radiusAround(other) * normal;
  bool isBeside = false;  // the deepest point is not over the face
  Points scratch(reference.points.get_allocator());
  const Points& corners = reference.points;
  for (std::size_t i = 0; i < corners.size() && !incident.points.empty(); ++i) {
    const Vec3 outward = (corners[(i + 1) % corners.size()] - corners[i]).cross(normal).normalized();
    const double border = outward.dot(corners[i]);
    isBeside = isBeside || outward.dot(deepest) > border + tolerances.meeting;
    clip(incident.points, scratch, outward, border);
  }
  // A face that misses the gap by facePreference is seen to be as much nearer by what lies beside it.
  const double near = normal.dot(deepest) + (isBeside ? tolerances.facePreference : tolerances.meeting);
  OverFace over = incident.points.empty() ? OverFace::nothing : OverFace::shallow;
  for (const Vec3& point : incident.points)
    if (normal.dot(point) <= near) over = OverFace::deepest;
  appendOnFace(face, incident, margin, points);
  return over;
}

/// A straight line of a surface across the contact's normal: an edge, or the side of a cylinder or capsule.
struct Ridge {
  bool isThere = false;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  // m
};

Ridge ridgeOf(const Core& core, const Vec3& outward) {
  const Vec3 around = radiusAround(core) * outward;
  if (core.collider().kind() == ColliderKind::polytope) {
    const Polytope& polytope = *core.collider().polytope;
    const std::size_t vertex = supportVertex(polytope, core.turnedBack(outward));
    const Vec3 from = core.placed(polytope.vertices[vertex]);
    Ridge best;
    double least = ConvexTolerances::kParallelAngle;
    for (std::size_t i = polytope.firstNeighbor[vertex]; i < polytope.firstNeighbor[vertex + 1]; ++i) {
      const Vec3 to = core.placed(polytope.vertices[polytope.neighbors[i]]);
      const double slope = std::abs(outward.dot(to - from)) / (to - from).norm();
      if (slope < least) least = slope, best = {true, from, to};
    }
    return best;
  }
  if (std::abs(core.axis().dot(outward)) >= ConvexTolerances::kParallelAngle) return {};
  if (core.rimRadius() > 0) return {true, core.rimPoint(-1, outward), core.rimPoint(1, outward)};
  return {true, core.end(-1) + around, core.end(1) + around};
}

/// Contacts at both ends of the line that two parallel ridges share; none if they are not parallel or share none.
void appendOnRidges(const Ridge& a, const Ridge& b, const Vec3& normal, double margin,
                    std::vector<ContactPoint>& points) {
  const Vec3 along = (a.to - a.from).normalized();
  if (along.cross((b.to - b.from).normalized()).norm() > ConvexTolerances::kParallelAngle) return;
  const double length = along.dot(a.to - a.from);
  double from = along.dot(b.from - a.from), to = along.dot(b.to - a.from);
  if (from > to) std::swap(from, to);
  from = std::max(from, 0.0), to = std::min(to, length);
  if (from > to) return;
  for (const double at : {from, to}) {
    const Vec3 onA = a.from + at * along;
    const Vec3 lineB = (b.to - b.from).normalized();
    const Vec3 onB = b.from + lineB.dot(onA - b.from) * lineB;
    const double separation = normal.dot(onB - onA);
    if (separation <= margin && (at == from || to > from))
      points.push_back({onA + separation / 2 * normal, normal, separation, kNotRound, kNotRound});
    if (from == to) break;
  }
}

/// The part (0..1) of a ridge at which it is nearest to another one.
double partNearest(const Ridge& ridge, const Ridge& other) {
  const Vec3 along = ridge.to - ridge.from, across = other.to - other.from, between = other.from - ridge.from;
  const double aa = along.squaredNorm(), bb = across.squaredNorm(), ab = along.dot(across);
  const double whole = aa * bb - ab * ab;
  if (!(whole > 0)) return 0.5;
  return std::clamp((along.dot(between) * bb - across.dot(between) * ab) / whole, 0.0, 1.0);
}

bool isCorner(const Core& core) {
  return core.collider().kind() == ColliderKind::polytope;
}

/// The radius (m, as in ContactPoint) of a collider at its support point, where no face or ridge carries.
double radiusOfCorner(const Core& core) {
  if (isCorner(core)) return 0;
  return core.rimRadius() > 0 ? kNotRound : radiusAround(core);
}

/// The middle between the nearest points of the cores when they are moved apart along the axis, moved back.
Vec3 middleOfCoresApart(const Core& a, const Core& b, const SeparatingAxis& axis) {
  const double way = ConvexTolerances(a, b).pulledApart - axis.separation;
  const GjkResult apart = distanceOf(a, b.moved(way * axis.normal));
  return (apart.onA + apart.onB - way * axis.normal) / 2;
}

/// The one contact of two manifolds that share neither a face nor a line.
ContactPoint singlePoint(const Core& a, const Core& b, const SeparatingAxis& axis, const FeatureManifold& patchA,
                         const FeatureManifold& patchB) {
  const Vec3& normal = axis.normal;
  const double separation = axis.separation - radiusAround(a) - radiusAround(b);
  const Ridge ridgeA = ridgeOf(a, normal), ridgeB = ridgeOf(b, -normal);
  const bool isWideA = patchA.isFlat || ridgeA.isThere, isWideB = patchB.isFlat || ridgeB.isThere;
  const Vec3 onA = a.supportPoint(normal) + radiusAround(a) * normal;
  const Vec3 onB = b.supportPoint(-normal) - radiusAround(b) * normal;
  ContactPoint contact{(onA + onB) / 2, normal, separation, kNotRound, kNotRound};
  if (isWideA && isWideB && !patchA.isFlat && !patchB.isFlat)
    contact.point = ridgeA.from + partNearest(ridgeA, ridgeB) * (ridgeA.to - ridgeA.from) + separation / 2 * normal;
  else if (isWideA && !isWideB)
    contact.point = onB - separation / 2 * normal;
  else if (isWideB && !isWideA)
    contact.point = onA + separation / 2 * normal;
  else if (isWideA || (onB - onA - separation * normal).norm() > ConvexTolerances(a, b).meeting)
    contact.point = middleOfCoresApart(a, b, axis) + (radiusAround(a) - radiusAround(b)) / 2 * normal;
  if (patchA.isFlat) contact.radiusA = kFlat;
  if (patchB.isFlat) contact.radiusB = kFlat;
  if (!isWideA) contact.radiusA = radiusOfCorner(a);
  if (!isWideB) contact.radiusB = radiusOfCorner(b);
  return contact;
}

/// m^2: of the polygon of a flat manifold.
double areaOf(const FeatureManifold& patch) {
  Vec3 doubled = Vec3::Zero();
  for (std::size_t i = 2; i < patch.points.size(); ++i)
    doubled += (patch.points[i - 1] - patch.points[0]).cross(patch.points[i] - patch.points[0]);
  return doubled.norm() / 2;
}

/// Of a disc and a face the smaller one stands on the larger, in either order: polygons of the disc that are inside and
/// around it would not meet a face in the same one.
bool isSmallerWithDisc(const Core& a, const FeatureManifold& patchA, const Core& b, const FeatureManifold& patchB) {
  return (a.rimRadius() > 0) != (b.rimRadius() > 0) && areaOf(patchA) < areaOf(patchB);
}

void mirror(ContactPoint& contact) {
  contact.normal = -contact.normal;
  std::swap(contact.radiusA, contact.radiusB);
}

}  // namespace

void appendManifold(const Core& a, const Core& b, const SeparatingAxis& axis, double margin,
                    std::vector<ContactPoint>& points) {
  std::array<std::byte, 8192> memory;
  Memory pool(memory.data(), memory.size());
  const double separation = axis.separation - radiusAround(a) - radiusAround(b);
  if (separation > margin) return;
  const std::size_t first = points.size();
  FeatureManifold patchA = manifoldOf(a, axis.normal, &pool), patchB = manifoldOf(b, -axis.normal, &pool);
  OverFace over = OverFace::shallow;
  if (patchA.isFlat && !(patchB.isFlat && isSmallerWithDisc(a, patchA, b, patchB))) {
    over = clipOnFace(a, b, axis.normal, patchA, patchB, margin, points);
  } else if (patchB.isFlat) {
    over = clipOnFace(b, a, -axis.normal, patchB, patchA, margin, points);
    std::for_each(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(), mirror);
  } else {
    const Ridge ridgeA = ridgeOf(a, axis.normal), ridgeB = ridgeOf(b, -axis.normal);
    if (ridgeA.isThere && ridgeB.isThere) appendOnRidges(ridgeA, ridgeB, axis.normal, margin, points);
    const double near = separation + ConvexTolerances(a, b).meeting;
    for (std::size_t i = first; i < points.size(); ++i)
      if (points[i].separation <= near) over = OverFace::deepest;
  }
  if (over == OverFace::nothing) {
    const SeparatingAxis beside = axisBesideFaces(a, b);
    if (beside.separation > axis.separation) return appendManifold(a, b, beside, margin, points);
  }
  // The deepest point must be among them: the axis tells its separation.
  if (over != OverFace::deepest) points.push_back(singlePoint(a, b, axis, patchA, patchB));
}

void appendManifold(const Core& core, const Vec3& planePoint, const Vec3& planeNormal, double margin,
                    std::vector<ContactPoint>& points) {
  std::array<std::byte, 8192> memory;
  Memory pool(memory.data(), memory.size());
  const Vec3 lowest = core.supportPoint(-planeNormal) - radiusAround(core) * planeNormal;
  const double height = planeNormal.dot(lowest - planePoint);
  if (height > margin) return;
  const std::size_t first = points.size();
  FeatureManifold patch = manifoldOf(core, -planeNormal, &pool);
  appendOnFace({planeNormal, planeNormal, planeNormal.dot(planePoint)}, patch, margin, points);
  const double near = height + ConvexTolerances(core.collider().boundingRadius).meeting;
  if (std::none_of(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(),
                   [near](const ContactPoint& point) { return point.separation <= near; }))
    points.push_back({lowest - height / 2 * planeNormal, planeNormal, height, kFlat, radiusOfCorner(core)});
  std::for_each(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(), mirror);
}

}  // namespace cradle
