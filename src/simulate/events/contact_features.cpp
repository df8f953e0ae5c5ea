#include "simulate/events/contact_features.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "collision/closest_points.h"
#include "collision/convex_tolerances.h"
#include "collision/core.h"
#include "collision/mesh_collider.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {
namespace {

// Sine of the angle between two lines: nearer to parallel, the place where they cross runs too fast along them.
constexpr double kLeastCrossing = 1e-3;

/// A straight line of a surface, in the collider's frame, and the radius (m) around it.
struct Line {
  Segment segment;
  double radius;
};

/// A collider as a contact sees it: all in its own frame.
struct Side {
  const Collider& collider;
  RigidTransform worldFromCollider;
  Vec3 point, outward;  // m; unit
  double near;          // m: a place so near to a corner, or to the end of a line, is there

  Side(const Collider& of, const Contact& contact, const Vec3& outwards, const VectorX& state)
      : collider(of),
        worldFromCollider(poseOf(state, of.body)),
        point(worldFromCollider.inverse() * contact.point),
        outward(worldFromCollider.rotation.conjugate() * outwards),
        near(EventTolerances::kAtCorner * of.boundingRadius +
             EventTolerances::kCoordinateRounding * contact.point.norm()) {}

  /// m: of the contact from a place, along the surface.
  double distanceTo(const Vec3& place) const { return (place - point).cross(outward).norm(); }

  bool isRound() const { return collider.kind() == ColliderKind::capsule || collider.kind() == ColliderKind::cylinder; }

  /// Of a capsule or cylinder: its axis, and whether that is across the normal.
  Segment axis() const { return {collider.points[0], collider.points[1] - collider.points[0]}; }
  bool isAcross() const { return std::abs(axis().along.normalized().dot(outward)) <= ConvexTolerances::kParallelAngle; }

  bool hasCorner() const {
    if (collider.radius > 0) return false;
    if (collider.kind() == ColliderKind::cylinder) {  // any point of a rim
      const Core core(collider, {});
      const double side = core.axis().dot(point - core.center()) < 0 ? -1 : 1;
      return (core.rimPoint(side, point - core.center()) - point).norm() <
             EventTolerances::kSameCorner * collider.boundingRadius;
    }
    return std::any_of(collider.points.begin(), collider.points.end(),
                       [this](const Vec3& corner) { return distanceTo(corner) < near; });
  }

  /// Whether the foot of the contact on a segment is between its ends.
  bool isAlong(const Segment& segment) const {
    const double length = segment.along.norm(), foot = (point - segment.from).dot(segment.along) / length;
    return foot > near && foot < length - near;
  }

  /// The side of a capsule or cylinder, or the edge, that touches there between its ends.
  std::optional<Line> line() const {
    if (isRound()) {
      if (!isAcross() || !isAlong(axis())) return std::nullopt;
      return Line{axis(), collider.radius + collider.rimRadius};
    }
    if (collider.kind() != ColliderKind::polytope) return std::nullopt;
    const std::vector<Vec3>& corners = collider.polytope->vertices;
    double least = EventTolerances::kSameCorner * collider.boundingRadius;
    std::optional<Line> nearest;
    for (const Polytope::Edge& edge : collider.polytope->edges) {
      const Segment segment{corners[edge.from], corners[edge.to] - corners[edge.from]};
      const double distance = distanceTo(segment.at(segment.nearestPart(point)));
      if (!isAlong(segment) || distance >= least) continue;
      least = distance, nearest = Line{segment, 0};
    }
    return nearest;
  }

  /// m: radius of the sphere at the end of a line, where `radius` does not tell: of the cap of a capsule, of the rim of
  /// a cylinder that lies, of the corner of a polytope.
  double radiusAtEnd(double radius) const {
    if (!std::isnan(radius)) return radius;
    if (isRound() && isAcross()) return collider.radius + collider.rimRadius;
    return hasCorner() ? 0 : radius;
  }

  Segment inWorld(const Segment& segment) const {
    return {worldFromCollider * segment.from, worldFromCollider.rotation * segment.along};
  }
};

/// Where two flat faces touch, a contact may be a corner of either of them; where their edges cross it is none.
void findCorner(const Side& a, const Side& b, Contact& contact) {
  const double least = std::min(contact.radiusA, contact.radiusB), most = std::max(contact.radiusA, contact.radiusB);
  if (least != 0 || !std::isinf(most)) return;
  contact.radiusA = contact.radiusB = INFINITY;
  if (a.hasCorner())
    contact.radiusA = 0;
  else if (b.hasCorner())
    contact.radiusB = 0;
}

/// Contacts at both ends of what two parallel lines share: of the end of one on the other one's line.
void appendEnds(const Contact& contact, const Line& ofA, const Segment& a, const Line& ofB, const Segment& b,
                std::vector<Contact>& contacts) {
  const Vec3 along = a.along.normalized();
  const auto [low, high] = std::minmax({along.dot(b.from - a.from), along.dot(b.at(1) - a.from)});
  const double length = a.along.norm(), foot = along.dot(contact.point - a.from);
  for (const auto& [end, endOfB] : {std::pair(0.0, low), std::pair(length, high)}) {
    const bool isOfA = end == 0 ? endOfB <= 0 : endOfB >= length;
    Contact& added = contacts.emplace_back(contact);
    added.point += ((isOfA ? end : endOfB) - foot) * along;
    added.radiusA = ofA.radius, added.radiusB = ofB.radius;
    if (isOfA)
      added.lineB = b.along.normalized();
    else
      added.lineA = along;
  }
}

/// A contact with the lines that touch there: itself, or two.
void appendWithLines(const Side& a, const Side& b, Contact contact, std::vector<Contact>& contacts) {
  const std::optional<Line> ofA = a.line(), ofB = b.line();
  if (ofA && ofB) {
    const Segment lineA = a.inWorld(ofA->segment), lineB = b.inWorld(ofB->segment);
    const Vec3 alongA = lineA.along.normalized(), alongB = lineB.along.normalized();
    const double sine = alongA.cross(alongB).norm();
    if (sine > kLeastCrossing) {
      contact.radiusA = ofA->radius, contact.radiusB = ofB->radius;
      contact.lineA = alongA, contact.lineB = alongB;
    } else if (sine < ConvexTolerances::kParallelAngle && ofA->radius + ofB->radius > 0) {
      return appendEnds(contact, *ofA, lineA, *ofB, lineB, contacts);
    }
  } else {
    const double radiusA = a.radiusAtEnd(contact.radiusA), radiusB = b.radiusAtEnd(contact.radiusB);
    if (ofA && std::isfinite(radiusB) && ofA->radius + radiusB > 0)
      contact.radiusA = ofA->radius, contact.radiusB = radiusB,
      contact.lineA = a.inWorld(ofA->segment).along.normalized();
    if (ofB && std::isfinite(radiusA) && ofB->radius + radiusA > 0)
      contact.radiusB = ofB->radius, contact.radiusA = radiusA,
      contact.lineB = b.inWorld(ofB->segment).along.normalized();
  }
  contacts.push_back(contact);
}

}  // namespace

void findFeatures(const ContactGeometry& geometry, const VectorX& state, std::vector<Contact>& contacts) {
  std::vector<Contact> told;
  for (Contact& contact : contacts) {
    const ColliderPair& pair = geometry.pairs[contact.pair];
    if (pair.againstPlane || hasMesh(geometry.colliders[pair.a], geometry.colliders[pair.b])) {
      told.push_back(contact);
      continue;
    }
    const Side a(geometry.colliders[pair.a], contact, contact.normal, state),
        b(geometry.colliders[pair.b], contact, -contact.normal, state);
    findCorner(a, b, contact);
    if (a.isRound() || b.isRound() || !canLast(contact))
      appendWithLines(a, b, contact, told);
    else
      told.push_back(contact);
  }
  contacts = std::move(told);
}

}  // namespace cradle
