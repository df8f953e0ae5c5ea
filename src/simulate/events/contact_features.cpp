#include "simulate/events/contact_features.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "collision/closest_points.h"
#include "collision/convex_tolerances.h"
#include "collision/core.h"
#include "collision/mesh_collider.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {
namespace {

// Sine of the angle between two lines that cross: nearer to parallel, rounding (1e-16 of the size) moves the place
// where they do by more than leaving the end of a line means.
constexpr double kMinCrossingSine = 1e-6;

// Sines of angles to the plane of contact, whose normal may miss that of two edges by less. A steeper edge does not
// touch there but leaves from a corner, a steeper cylinder does not lie, a steeper face touches by its border alone.
constexpr double kMaxRise = 1e-3, kMaxTilt = 1e-4, kMaxFaceTilt = 1e-6;

/// A straight line of a surface, in the collider's frame, and the radius (m) around it.
struct Line {
  Segment segment;
  double radius;
};

/// A place in a surface, m in the world: the centre of a sphere, or the point of a line.
struct Center {
  Vec3 place;
  double radius;  // m, around it
  Vec3 line;      // unit; zero: a sphere
};

/// A collider as a contact sees it: all in its own frame.
struct Side {
  const Collider& collider;
  RigidTransform worldFromCollider;
  Vec3 point, outward;  // m; unit
  double near;          // m: a place so near to a corner, or to the end of a line, is there

  Side(const Collider& of, const Contact& contact, const Vec3& outwards, double leaving, const VectorX& state)
      : collider(of),
        worldFromCollider(poseOf(state, of.body)),
        point(worldFromCollider.inverse() * contact.point),
        outward(worldFromCollider.rotation.conjugate() * outwards),
        near(EventTolerances::kAtCorner * leaving + EventTolerances::kCoordinateRounding * contact.point.norm()) {}

  /// m: of the contact from a place near it, along the surface; infinite from others.
  double distanceTo(const Vec3& place) const {
    if ((place - point).norm() > EventTolerances::kSameCorner * collider.boundingRadius) return INFINITY;
    return (place - point).cross(outward).norm();
  }

  bool isRound() const { return collider.kind() == ColliderKind::capsule || collider.kind() == ColliderKind::cylinder; }

  /// Of a capsule or cylinder: its axis, and whether that is across the normal.
  Segment axis() const { return {collider.points[0], collider.points[1] - collider.points[0]}; }
  bool isAcross() const { return std::abs(axis().along.normalized().dot(outward)) < kMaxTilt; }

  /// The corner of a polytope there; null: there is none. What is beyond the ends of all edges is at a corner too.
  const Vec3* corner() const {
    if (collider.kind() != ColliderKind::polytope) return nullptr;
    const Vec3* nearest = nullptr;
    double least = INFINITY, leastOfEdges = INFINITY;
    for (const Vec3& place : collider.polytope->vertices)
      if (const double distance = distanceTo(place); distance < least) least = distance, nearest = &place;
    visitEdges([&](const Segment&, double distance) { leastOfEdges = std::min(leastOfEdges, distance); });
    return least < near || least <= leastOfEdges + near ? nearest : nullptr;
  }
  bool hasCorner() const {
    if (collider.kind() == ColliderKind::cylinder) {  // any point of a rim
      const Core core(collider, {});
      const double side = core.axis().dot(point - core.center()) < 0 ? -1 : 1;
      return (core.rimPoint(side, point - core.center()) - point).norm() <
             EventTolerances::kSameCorner * collider.boundingRadius;
    }
    return corner() != nullptr;
  }

  /// Whether the foot of the contact on a segment is between its ends.
  bool isAlong(const Segment& segment) const {
    const double length = segment.along.norm(), foot = (point - segment.from).dot(segment.along) / length;
    return foot > near && foot < length - near;
  }

  /// Whether it has a face in the plane of contact under the corner that another side has there, up to its border.
  bool hasFace(const Side& other) const {
    if (const Vec3* corner = other.corner()) {
      const Vec3 place = worldFromCollider.inverse() * (other.worldFromCollider * *corner);
      if ((nearestOnSurface(collider, place) - place).cross(outward).norm() > near) return false;
    }
    if (collider.kind() == ColliderKind::cylinder)
      return axis().along.normalized().cross(outward).norm() < kMaxFaceTilt;
    if (collider.kind() != ColliderKind::polytope) return false;
    const double most = EventTolerances::kSameCorner * collider.boundingRadius;
    return std::any_of(
        collider.polytope->faces.begin(), collider.polytope->faces.end(), [&](const Polytope::Face& face) {
          return (face.normal - outward).norm() < kMaxFaceTilt && std::abs(face.normal.dot(point) - face.offset) < most;
        });
  }

  /// Whether it is a face that is nearest to a place (m, world), as it is until a contact with that face leaves it.
  bool hasFaceUnder(const Vec3& place) const {
    return collider.kind() == ColliderKind::polytope &&
           std::isinf(nearestSurfacePoint(collider, worldFromCollider.inverse() * place).radius);
  }

  /// Calls visit(edge, distance of the contact from it) with the edges of a polytope in the plane of contact.
  template <class Visit>
  void visitEdges(const Visit& visit) const {
    const std::vector<Vec3>& corners = collider.polytope->vertices;
    for (const Polytope::Edge& edge : collider.polytope->edges) {
      const Segment segment{corners[edge.from], corners[edge.to] - corners[edge.from]};
      if (std::abs(segment.along.dot(outward)) <= kMaxRise * segment.along.norm())
        visit(segment, distanceTo(segment.at(segment.nearestPart(point))));
    }
  }

  /// The side of a capsule or cylinder, or the edge, that touches there between its ends.
  std::optional<Line> line() const {
    if (isRound()) {
      if ((collider.rimRadius > 0 && !isAcross()) || !isAlong(axis())) return std::nullopt;
      return Line{axis(), collider.radius + collider.rimRadius};
    }
    if (collider.kind() != ColliderKind::polytope || corner()) return std::nullopt;
    double least = INFINITY;
    std::optional<Line> nearest;
    visitEdges([&](const Segment& segment, double distance) {
      if (distance < least) least = distance, nearest = Line{segment, 0};
    });
    return nearest;
  }

  /// Of the edges that meet in the corner there, the one that is most across a direction (world); none without one.
  std::optional<Line> edgeOfCorner(const Vec3& direction) const {
    const Vec3 local = worldFromCollider.rotation.conjugate() * direction;
    const Vec3* place = corner();
    if (!place) return std::nullopt;
    const double reach = distanceTo(*place) + near;
    double most = kMinCrossingSine;
    std::optional<Line> found;
    visitEdges([&](const Segment& segment, double distance) {
      const double sine = segment.along.normalized().cross(local).norm();
      if (distance < reach && sine > most) most = sine, found = Line{segment, 0};
    });
    return found;
  }

  /// The sphere at the end of a line that touches there: the cap of a capsule, the rim of a cylinder that lies, the
  /// corner of a polytope, or a sphere; none where the contact is none of these.
  std::optional<Center> end() const {
    if (collider.isSphere()) return Center{worldFromCollider * collider.points[0], collider.radius, Vec3::Zero()};
    if (collider.kind() == ColliderKind::cylinder && !isAcross()) return std::nullopt;
    if (isRound()) {
      const bool isFirst = axis().nearestPart(point) < 0.5;
      return Center{worldFromCollider * collider.points[isFirst ? 0 : 1], collider.radius + collider.rimRadius,
                    Vec3::Zero()};
    }
    const Vec3* corner = this->corner();
    return corner ? std::optional(Center{worldFromCollider * *corner, 0, Vec3::Zero()}) : std::nullopt;
  }

  Segment inWorld(const Segment& segment) const {
    return {worldFromCollider * segment.from, worldFromCollider.rotation * segment.along};
  }
};

/// Where a face touches, a contact may be a corner of the other side on it. Where edges cross it is none, and neither
/// is the corner of a face on an edge.
void findCorner(const Side& a, const Side& b, Contact& contact) {
  const double least = std::min(contact.radiusA, contact.radiusB), most = std::max(contact.radiusA, contact.radiusB);
  if (least != 0 || !std::isinf(most)) return;
  contact.radiusA = contact.radiusB = INFINITY;
  if (a.hasCorner() && b.hasFace(a))
    contact.radiusA = 0;
  else if (b.hasCorner() && a.hasFace(b))
    contact.radiusB = 0;
}

/// Puts a contact where the surfaces around two places touch; `contact` tells the normal of what is sharp.
void place(const Center& a, const Center& b, Contact& contact) {
  const Vec3 apart = b.place - a.place, across = a.line.cross(b.line);
  if (a.radius + b.radius > 0)
    contact.normal = apart.normalized();
  else
    contact.normal = (across.dot(contact.normal) < 0 ? -1 : 1) * across.normalized();
  contact.separation = apart.dot(contact.normal) - a.radius - b.radius;
  contact.point = a.place + (a.radius + contact.separation / 2) * contact.normal;
  contact.radiusA = a.radius, contact.radiusB = b.radius;
  contact.lineA = a.line, contact.lineB = b.line;
}

Center footOn(const Segment& segment, double radius, const Vec3& point) {
  return {segment.at(segment.nearestPart(point)), radius, segment.along.normalized()};
}

/// Whether edges of two flat faces run along each other at a contact: it is no corner of the area in which the faces
/// touch, whose corners lie at the ends of what the edges share.
bool isBetweenCorners(const Contact& contact, double sine) {
  return sine < ConvexTolerances::kParallelAngle && std::isinf(contact.radiusA) && std::isinf(contact.radiusB);
}

/// Contacts at both ends of what two parallel lines share: of the end of one on the other one's line.
void appendEnds(const Contact& contact, const Segment& a, double radiusA, const Segment& b, double radiusB,
                std::vector<Contact>& contacts) {
  const Vec3 along = a.along.normalized();
  const auto [low, high] = std::minmax({along.dot(b.from - a.from), along.dot(b.at(1) - a.from)});
  const double length = a.along.norm();
  const bool isForward = along.dot(b.along) > 0;
  for (const auto& [endOfA, endOfB, part] : {std::tuple(0.0, low, 0.0), std::tuple(length, high, 1.0)}) {
    const bool isOfA = part == 0 ? endOfB <= endOfA : endOfB >= endOfA;
    const Vec3 end = isOfA ? a.at(part) : b.at(isForward ? part : 1 - part);
    Contact& added = contacts.emplace_back(contact);
    if (isOfA)
      place({end, radiusA, Vec3::Zero()}, footOn(b, radiusB, end), added);
    else
      place(footOn(a, radiusA, end), {end, radiusB, Vec3::Zero()}, added);
  }
}

/// Contacts of one pair of convex shapes that have been told.
struct ToldContacts {
  std::vector<Contact>& all;
  std::vector<Contact> corners = {};  // of faces, on edges: spare where the edges of the corner cross those as well
};

/// A contact where two lines touch: itself, or two; none between two corners.
void appendLines(const Side& a, const Line& ofA, const Side& b, const Line& ofB, Contact contact,
                 std::vector<Contact>& contacts) {
  const Segment lineA = a.inWorld(ofA.segment), lineB = b.inWorld(ofB.segment);
  const Vec3 alongA = lineA.along.normalized(), alongB = lineB.along.normalized();
  const double sine = alongA.cross(alongB).norm();
  if (sine < ConvexTolerances::kParallelAngle && ofA.radius + ofB.radius > 0)
    return appendEnds(contact, lineA, ofA.radius, lineB, ofB.radius, contacts);
  if (isBetweenCorners(contact, sine)) return;
  const SegmentParts nearest = nearestParts(lineA, lineB);
  if (sine > kMinCrossingSine)
    place({lineA.at(nearest.a), ofA.radius, alongA}, {lineB.at(nearest.b), ofB.radius, alongB}, contact);
  contacts.push_back(contact);
}

/// A contact with the lines that touch there.
void appendWithLines(const Side& a, const Side& b, Contact contact, ToldContacts& told) {
  const std::optional<Line> ofA = a.line(), ofB = b.line();
  if (ofA && ofB) return appendLines(a, *ofA, b, *ofB, contact, told.all);
  const std::optional<Center> endOfA = a.end(), endOfB = b.end();
  const bool areKnown = !std::isnan(contact.radiusA) && !std::isnan(contact.radiusB);
  if (!ofA && !ofB && !areKnown && endOfA && endOfB && endOfA->radius + endOfB->radius > 0) {
    place(*endOfA, *endOfB, contact);
  } else if (ofA && endOfB && ofA->radius + endOfB->radius > 0) {
    if (!a.hasFaceUnder(endOfB->place))
      place(footOn(a.inWorld(ofA->segment), ofA->radius, endOfB->place), *endOfB, contact);
  } else if (ofB && endOfA && ofB->radius + endOfA->radius > 0) {
    if (!b.hasFaceUnder(endOfA->place))
      place(*endOfA, footOn(b.inWorld(ofB->segment), ofB->radius, endOfA->place), contact);
  } else if (ofA && endOfB && endOfB->radius == 0) {
    if (const auto edge = b.edgeOfCorner(a.worldFromCollider.rotation * ofA->segment.along.normalized()))
      return appendLines(a, *ofA, b, *edge, contact, told.corners);
  } else if (ofB && endOfA && endOfA->radius == 0) {
    if (const auto edge = a.edgeOfCorner(b.worldFromCollider.rotation * ofB->segment.along.normalized()))
      return appendLines(a, *edge, b, *ofB, contact, told.corners);
  }
  told.all.push_back(contact);
}

void findFeaturesOfPair(const Collider& colliderA, const Collider& colliderB, double leaving, const VectorX& state,
                        const std::vector<Contact>& contacts, std::vector<Contact>& all) {
  ToldContacts told{all};
  const std::size_t first = all.size();
  const double size = std::min(colliderA.boundingRadius, colliderB.boundingRadius);
  for (Contact contact : contacts) {
    const Side a(colliderA, contact, contact.normal, leaving, state),
        b(colliderB, contact, -contact.normal, leaving, state);
    findCorner(a, b, contact);
    if (a.isRound() || b.isRound() || !canLast(contact))
      appendWithLines(a, b, contact, told);
    else
      all.push_back(contact);
  }
  const double near = EventTolerances::kSameCorner * size;
  for (const Contact& corner : told.corners)
    if (std::none_of(all.begin() + static_cast<std::ptrdiff_t>(first), all.end(),
                     [&](const Contact& other) { return (other.point - corner.point).norm() < near; }))
      all.push_back(corner);
}

}  // namespace

void findFeatures(const ContactGeometry& geometry, const VectorX& state, double leaving,
                  std::vector<Contact>& contacts) {
  std::vector<Contact> told;
  for (auto from = contacts.begin(); from != contacts.end();) {
    const auto to = std::find_if(from, contacts.end(), [&](const Contact& other) { return other.pair != from->pair; });
    const ColliderPair& pair = geometry.pairs[from->pair];
    if (pair.againstPlane || hasMesh(geometry.colliders[pair.a], geometry.colliders[pair.b]))
      told.insert(told.end(), from, to);
    else
      findFeaturesOfPair(geometry.colliders[pair.a], geometry.colliders[pair.b], leaving, state, {from, to}, told);
    from = to;
  }
  contacts = std::move(told);
}

}  // namespace cradle
