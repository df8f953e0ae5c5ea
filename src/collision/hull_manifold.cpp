// Hulls that are apart are moved towards each other until they touch, by conservative advancement along the directions
// between their nearest points (B. Mirtich, "Impulse-Based Dynamic Simulation of Rigid Body Systems", 1996), and meet
// there; hulls that overlap part along the axis of least overlap. Faces are clipped as those of boxes are
// (box_manifold.cpp): a face carries the contact if it is nearly across the normal, and points that are farther apart
// than the deepest are kept, as bodies turn in the step.

#include "collision/hull_manifold.h"

#include <array>
#include <memory_resource>

#include "collision/convex_tolerances.h"
#include "collision/gjk.h"
#include "collision/polygon_clip.h"
#include "collision/separating_axis.h"

namespace cradle {
namespace {

// Lengths in m, times the scale of small bodies, as of boxes (box_manifold.cpp).
constexpr double kApart = 1e-3;           // hulls nearer than that touch, and their axis is that of least overlap
constexpr double kSidePreference = 5e-4;  // edges carry contact only where they are clearly farther apart than faces
constexpr double kBeside = 2e-3;          // a face that sees so much more overlap is beside what touches
constexpr double kMinClosing = 1e-9;      // m in a step: less is no approach
constexpr double kMet = 1e-4;             // hulls that have come as near to each other have met
constexpr double kAligned = 0.95;         // cosine: a normal within 18 degrees of a face's is that of the face
constexpr int kMaxAdvances = 16;          // most pairs take two or three

using Memory = std::pmr::monotonic_buffer_resource;
using ManifoldPoints = std::pmr::vector<PredictedManifold::Point>;

/// The face of a core that looks most along a direction (unit).
struct FacingFace {
  const Polytope::Face* face;
  double cosine;
};

FacingFace facingFace(const Core& core, const Vec3& direction) {
  const Vec3 local = core.turnedBack(direction);
  FacingFace best{nullptr, -2};
  for (const Polytope::Face& face : core.collider().polytope->faces)
    if (const double cosine = face.normal.dot(local); cosine > best.cosine) best = {&face, cosine};
  return best;
}

void appendCorners(const Core& core, const Polytope::Face& face, Points& points) {
  for (const std::size_t vertex : face.loop) points.push_back(core.placed(core.collider().polytope->vertices[vertex]));
}

/// Two hulls, one of which moves.
class HullPair {
 public:
  HullPair(const Core& a, const Core& b, const Vec3& motion, double margin, double scale, HullAxis& axis)
      : a_(a),
        b_(b),
        motion_(motion),
        margin_(margin),
        scale_(scale),
        reach_(margin + 2 * motion.norm()),
        axis_(axis) {}

  PredictedManifold contact() {
    if (axis_ == Vec3::Zero()) return contactOfApart();
    const Vec3 normal = a_.turned(axis_);
    const double gap = gapAlong(a_, b_, normal);
    if (isApartAlong(normal, gap)) return none(gap);
    // What overlapped mostly still does.
    return gap < scale_ * kApart ? contactOfNear({gap, normal}) : contactOfApart();
  }

 private:
  /// Whether a gap (m) along a normal is one all through the step.
  bool isApartAlong(const Vec3& normal, double gap) const { return std::min(gap, gap + normal.dot(motion_)) > margin_; }

  PredictedManifold none(double clearance) const {
    PredictedManifold manifold;
    manifold.clearance = clearance;
    return manifold;
  }

  void keepAxis(const Vec3& normal) { axis_ = a_.turnedBack(normal); }

  /// Of which an axis is known that does not separate them.
  PredictedManifold contactOfNear(const SeparatingAxis& known) {
    const SeparatingAxes axes = separatingAxes(a_, b_, known, scale_ * kSidePreference);
    const double separation = std::max({axes.faceOfA.separation, axes.faceOfB.separation, axes.edges.separation});
    // Where no axis sees what was known, corners meet.
    const bool isSeen = std::isfinite(separation) && separation <= scale_ * kApart;
    return isSeen ? contactAlong(axes) : contactOfApart();
  }

  /// Moves B until they meet.
  PredictedManifold contactOfApart() {
    GjkResult nearest = distanceOf(a_, b_, margin_ + motion_.norm());
    if (nearest.distance <= scale_ * kApart) return contactAlong(separatingAxes(a_, b_));
    keepAxis(nearest.normal);
    const double clearance = nearest.lowerBound;
    const bool isNear = clearance <= margin_;
    double time = 0;  // in parts of the step
    for (int i = 0; i < kMaxAdvances; ++i) {
      const double closing = -nearest.normal.dot(motion_), left = (1 - time) * std::max(closing, 0.0);
      if (nearest.lowerBound - left > margin_ && !isNear) return none(clearance);
      if (nearest.distance <= scale_ * kMet || !(left > scale_ * kMinClosing)) break;
      const double next = std::min(nearest.lowerBound / closing, 1 - time);
      time += next;
      const GjkResult found = distanceOf(a_, b_.moved(time * motion_));
      if (!(found.distance > 0)) {  // they touch: the direction before tells the normal
        nearest.onB += next * motion_, nearest.distance = 0;
        break;
      }
      nearest = found;
      keepAxis(nearest.normal);
    }
    ahead_ = time * motion_;
    const Vec3 onB = nearest.onB - ahead_;
    const AlignedFace face = alignedFace(nearest.normal);
    if (face.cosine >= kAligned && seesAsMuch(face.normal, nearest.distance)) {
      const PredictedManifold found = faceContact(face.normal);
      if (isAsDeep(found, face.normal.dot(onB - nearest.onA))) return found;
    }
    return single(nearest.normal, nearest.onA, onB);
  }

  /// By the axis of least overlap.
  PredictedManifold contactAlong(const SeparatingAxes& axes) {
    const SeparatingAxis& side = axes.faceOfB.separation > axes.faceOfA.separation ? axes.faceOfB : axes.faceOfA;
    const bool isByEdges = axes.edges.separation > side.separation + scale_ * kSidePreference;
    const SeparatingAxis& best = isByEdges ? axes.edges : side;
    keepAxis(best.normal);
    const AlignedFace face = alignedFace(best.normal);
    const Vec3 normal = isByEdges ? face.normal : best.normal;
    if (face.cosine >= kAligned && seesAsMuch(normal, best.separation)) {
      const PredictedManifold found = faceContact(normal);
      if (isAsDeep(found, best.separation)) return found;
    }
    return singleAlong(best);
  }

  /// Whether a face sees as much of hulls that meet as the normal (a gap, m) of which it takes the place.
  bool seesAsMuch(const Vec3& normal, double separation) const {
    return gapAlong(a_, b_.moved(ahead_), normal) > separation - scale_ * kBeside;
  }

  /// Whether what touches first or is deepest, by its separation (m), is among a manifold's points: a face that covers
  /// an edge may have nothing over it, and then one point carries.
  bool isAsDeep(const PredictedManifold& manifold, double separation) const {
    return std::any_of(
        manifold.points.begin(), manifold.points.begin() + static_cast<std::ptrdiff_t>(manifold.count),
        [&](const PredictedManifold::Point& p) { return p.separation < separation + scale_ * kSidePreference; });
  }

  struct AlignedFace {
    double cosine;
    Vec3 normal;  // unit, from A to B
  };
  /// The face of either that is most nearly across a normal.
  AlignedFace alignedFace(const Vec3& normal) const {
    const FacingFace ofA = facingFace(a_, normal), ofB = facingFace(b_, -normal);
    if (ofA.cosine >= ofB.cosine) return {ofA.cosine, a_.turned(ofA.face->normal)};
    return {ofB.cosine, -b_.turned(ofB.face->normal)};
  }

  PredictedManifold single(const Vec3& normal, const Vec3& onA, const Vec3& onB) const {
    PredictedManifold manifold;
    manifold.normal = normal;
    manifold.count = 1;
    manifold.points[0] = {onA, onB, normal.dot(onB - onA)};
    return manifold;
  }

  /// Nearest points of hulls moved apart along an axis are those of the edges, or of the corner and the face, that
  /// meet.
  PredictedManifold singleAlong(const SeparatingAxis& axis) const {
    const Vec3 way = (ConvexTolerances(a_, b_).pulledApart - axis.separation) * axis.normal;
    const GjkResult apart = distanceOf(a_, b_.moved(way));
    return single(axis.normal, apart.onA, apart.onB - way);
  }

  /// The contact of a face of one, whose normal from A to B is given, with what of the other is over it.
  PredictedManifold faceContact(const Vec3& normal) const {
    const FacingFace ofA = facingFace(a_, normal), ofB = facingFace(b_, -normal);
    const bool isOfA = ofA.cosine >= ofB.cosine;
    const Core moved = b_.moved(ahead_);
    const Core &reference = isOfA ? a_ : moved, &incident = isOfA ? moved : a_;
    const Polytope::Face& face = isOfA ? *ofA.face : *ofB.face;
    const Polytope::Face& facing = isOfA ? *ofB.face : *ofA.face;
    const Vec3 outward = isOfA ? normal : Vec3(-normal);
    std::array<std::byte, 8192> memory;
    Memory pool(memory.data(), memory.size());
    Points corners(&pool), points(&pool), scratch(&pool);
    appendCorners(reference, face, corners);
    appendCorners(incident, facing, points);
    for (std::size_t i = 0; i < corners.size() && !points.empty(); ++i) {
      const Vec3 aside = (corners[(i + 1) % corners.size()] - corners[i]).cross(outward);
      clip(points, scratch, aside, aside.dot(corners[i]));
    }
    return clipped(normal, outward, isOfA, outward.dot(corners[0]), points);
  }

  /// The manifold of points of the incident hull over a face, where both are when they meet.
  PredictedManifold clipped(const Vec3& normal, const Vec3& outward, bool isOfA, double offset,
                            const Points& points) const {
    ManifoldPoints candidates(points.get_allocator());
    const double aheadAlong = normal.dot(ahead_);
    for (const Vec3& point : points) {
      const double height = outward.dot(point) - offset;
      if (height > reach_) continue;
      const Vec3 onReference = point - height * outward;
      const Vec3 onA = isOfA ? onReference : point, onB = (isOfA ? point : onReference) - ahead_;
      candidates.push_back({onA, onB, height - aheadAlong});
    }
    PredictedManifold manifold;
    manifold.normal = normal;
    appendSpanning(candidates.data(), candidates.size(), manifold, scale_);
    return manifold;
  }

  const Core &a_, &b_;
  const Vec3 motion_;
  const double margin_, scale_;
  const double reach_;  // m: corners as near as that count, for hulls turn about the first that touch
  HullAxis& axis_;
  Vec3 ahead_ = Vec3::Zero();  // m: of B, until they meet
};

}  // namespace

PredictedManifold contactOfHulls(const Core& a, const Core& b, const Vec3& motion, double margin, double scale,
                                 HullAxis& axis) {
  return HullPair(a, b, motion, margin, scale, axis).contact();
}

PredictedManifold contactOfHullAndPlane(const Core& a, const PlaneCollider& b, const Vec3& motion, double margin,
                                        double scale) {
  const double reach = margin + std::max(0.0, b.normal.dot(motion));
  const std::vector<Vec3>& vertices = a.collider().polytope->vertices;
  const Vec3 normal = a.turnedBack(b.normal);
  const double middle = b.normal.dot(a.placed(Vec3::Zero()) - b.point);
  std::array<std::byte, 8192> memory;
  Memory pool(memory.data(), memory.size());
  ManifoldPoints points(&pool);
  PredictedManifold manifold;
  manifold.normal = -b.normal;
  manifold.clearance = std::numeric_limits<double>::infinity();
  for (const Vec3& vertex : vertices) {
    const double height = middle + normal.dot(vertex);
    manifold.clearance = std::min(manifold.clearance, height);
    if (height > reach) continue;
    const Vec3 at = a.placed(vertex);
    points.push_back({at, at - height * b.normal, height});
  }
  appendSpanning(points.data(), points.size(), manifold, scale);
  return manifold;
}

}  // namespace cradle
