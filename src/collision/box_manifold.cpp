// Separating axes of two boxes (S. Gottschalk, M. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996) and clipping of the facing
// sides (D. Gregorius, "Robust Contact Creation for Physics Simulations", GDC 2015).
// While boxes are apart, the axis taken is not that of the largest gap now, but the one whose gap closes last within
// the coming step, and sides are clipped at that instant: a falling box moves by half its size in a step of 1/60 s, and
// with the axis of now it would stop on boxes that it passes and sink into those that it meets.
// Crossing edges of two sides that lie on each other have nearly the normal of those sides, and may be a little farther
// apart: one point there would let boxes tip into each other about it, so such edges never carry contact. Where boxes
// slide over each other, though, an edge of one climbs an edge of the other, and the side sees nothing of it.

#include "collision/predicted_manifold.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cradle {
namespace {

// Lengths in m, times the scale of small bodies. They come from the millimetre by which two bodies may move against
// each other before soft contacts renew a manifold. With ten times kBeside boxes are found to be deeper than they are;
// a tenth or ten times as much of the others, and of kSliding and kMinClosing, changes no test of pairs of boxes.
constexpr double kApart = 1e-3;           // boxes nearer than that touch, and their axis is that of least overlap
constexpr double kSidePreference = 5e-4;  // edges carry contact only where they are clearly farther apart than sides
constexpr double kBeside = 2e-3;          // edges of sides that are beside each other are farther apart by as much
// Cosines: edges whose normal is within 18 degrees of a side's are covered by that side; within 11 degrees where boxes
// slide, since an edge that climbs a slope which the side does not see would sink in.
constexpr double kAligned = 0.95, kAlignedSliding = 0.98;
constexpr double kSliding = 2e-3;        // m in a step: relative motion that is sliding
constexpr double kParallelSine2 = 1e-4;  // squared sine (0.6 degrees): edges at a smaller angle are covered by sides
constexpr double kMinClosing = 1e-9;     // m in a step: less is no approach, and closing times are not divided by it

/// A direction along which two boxes are compared.
struct Axis {
  double separation = 0, closing = 0;  // m: now; by how much less at the end of the step
  double sign = 1;                     // of the direction, to point from A to B
  int ofA = -1, ofB = -1;              // side normals or edges; -1: the other box's side alone
};

/// Both boxes in A's frame.
class BoxPair {
 public:
  BoxPair(const PosedBox& a, const PosedBox& b, const Vec3& motion, double margin, double scale)
      : a_(a),
        b_(b),
        margin_(margin),
        scale_(scale),
        apart_(scale * kApart),
        reach_(margin + 2 * motion.norm()),
        aFromB_(a.axes.transpose() * b.axes),
        cosines_(aFromB_.cwiseAbs()),
        offset_(a.axes.transpose() * (b.center - a.center)),
        motion_(a.axes.transpose() * motion) {}

  /// Of the axis that separates the boxes all through the step, if findAxis found one.
  double clearance() const { return clearance_; }

  /// False if some axis separates the boxes all through the step.
  bool findAxis() {
    for (int i = 0; i < 3; ++i)
      if (!considerSide(i, -1, offset_[i], motion_[i], a_.halfSize[i] + cosines_.row(i).dot(b_.halfSize))) return false;
    for (int j = 0; j < 3; ++j)
      if (!considerSide(-1, j, aFromB_.col(j).dot(offset_), aFromB_.col(j).dot(motion_),
                        b_.halfSize[j] + cosines_.col(j).dot(a_.halfSize)))
        return false;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (!considerEdges(i, j)) return false;
    return true;
  }

  PredictedManifold contact() const {
    const bool areApart = std::max(side_.separation, edges_.separation) > apart_;
    const double aligned = motion_.norm() > scale_ * kSliding ? kAlignedSliding : kAligned;
    const bool byEdges = hasEdges_ && edgeNormal().dot(sideNormal()) < aligned &&
                         (areApart ? closingTime(edges_) > closingTime(side_) && edges_.separation > 0
                                   : edges_.separation > side_.separation + scale_ * kSidePreference);
    if (byEdges) return edgeContact(edges_, wayUntilClosed(edges_, areApart));
    const Vec3 ahead = wayUntilClosed(side_, areApart);
    return side_.ofA >= 0 ? sideContact(a_, b_, side_.ofA, side_.sign, ahead, true)
                          : sideContact(b_, a_, side_.ofB, -side_.sign, -ahead, false);
  }

 private:
  Vec3 sideNormal() const {  // A's frame
    return side_.sign * (side_.ofA >= 0 ? Vec3(Vec3::Unit(side_.ofA)) : Vec3(aFromB_.col(side_.ofB)));
  }
  Vec3 edgeNormal() const {  // A's frame
    return edges_.sign * Vec3(Vec3::Unit(edges_.ofA)).cross(aFromB_.col(edges_.ofB)).normalized();
  }

  Vec3 wayUntilClosed(const Axis& axis, bool areApart) const {  // m, A's frame, of B
    return areApart ? Vec3(std::clamp(closingTime(axis), 0.0, 1.0) * motion_) : Vec3(Vec3::Zero());
  }

  bool consider(const Axis& axis, Axis& best, bool& known) {
    clearance_ = axis.separation;
    if (std::min(axis.separation, axis.separation - axis.closing) > margin_) return false;
    if (!known || isBetter(axis, best)) best = axis;
    known = true;
    return true;
  }

  double closingTime(const Axis& axis) const {  // in parts of the step
    const double least = scale_ * kMinClosing;
    if (axis.closing < least)
      return axis.separation > 0 ? std::numeric_limits<double>::infinity() : axis.separation / least;
    return axis.separation / axis.closing;
  }

  bool isBetter(const Axis& axis, const Axis& best) const {
    if (std::max(axis.separation, best.separation) <= apart_) return axis.separation > best.separation;
    if (axis.separation <= 0 || best.separation <= 0) return axis.separation > best.separation;
    return closingTime(axis) > closingTime(best);
  }

  bool considerSide(int ofA, int ofB, double distance, double motion, double reach) {
    const double sign = distance < 0 ? -1 : 1;
    return consider({sign * distance - reach, -sign * motion, sign, ofA, ofB}, side_, hasSide_);
  }

  bool considerEdges(int i, int j) {
    const double sine2 = 1 - aFromB_(i, j) * aFromB_(i, j);
    if (sine2 < kParallelSine2) return true;
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    // Of the cross product, which is no unit vector.
    const double distance = offset_[i2] * aFromB_(i1, j) - offset_[i1] * aFromB_(i2, j);
    const double reach = a_.halfSize[i1] * cosines_(i2, j) + a_.halfSize[i2] * cosines_(i1, j) +
                         b_.halfSize[j1] * cosines_(i, j2) + b_.halfSize[j2] * cosines_(i, j1);
    const double separation = std::abs(distance) - reach;
    if (hasEdges_ && separation <= std::min(0.0, edges_.separation))
      return true;  // with a unit vector it is less still
    const double scale = 1 / std::sqrt(sine2), sign = distance < 0 ? -1 : 1;
    const double motion = motion_[i2] * aFromB_(i1, j) - motion_[i1] * aFromB_(i2, j);
    return consider({separation * scale, -sign * motion * scale, sign, i, j}, edges_, hasEdges_);
  }

  PredictedManifold edgeContact(const Axis& axis, const Vec3& ahead) const {
    const Vec3 directionA = a_.axes.col(axis.ofA), directionB = b_.axes.col(axis.ofB);
    PredictedManifold manifold;
    manifold.normal = axis.sign * directionA.cross(directionB).normalized();
    Vec3 onA = a_.center, onB = b_.center;
    for (int k = 0; k < 3; ++k) {
      if (k != axis.ofA) onA += std::copysign(a_.halfSize[k], manifold.normal.dot(a_.axes.col(k))) * a_.axes.col(k);
      if (k != axis.ofB) onB -= std::copysign(b_.halfSize[k], manifold.normal.dot(b_.axes.col(k))) * b_.axes.col(k);
    }
    const Vec3 between = onB + a_.axes * ahead - onA;
    const double cosine = directionA.dot(directionB), sine2 = 1 - cosine * cosine;
    const double alongA = (between.dot(directionA) - cosine * between.dot(directionB)) / sine2;
    const double alongB = (cosine * between.dot(directionA) - between.dot(directionB)) / sine2;
    const double halfA = a_.halfSize[axis.ofA], halfB = b_.halfSize[axis.ofB];
    manifold.count = 1;
    manifold.points[0] = {onA + std::clamp(alongA, -halfA, halfA) * directionA,
                          onB + std::clamp(alongB, -halfB, halfB) * directionB, axis.separation};
    return manifold;
  }

  /// Side `axis` of `reference` against the facing side of `incident`, which moves `ahead` (A's frame) until they meet.
  PredictedManifold sideContact(const PosedBox& reference, const PosedBox& incident, int axis, double sign,
                                const Vec3& ahead, bool referenceIsA) const;

  const PosedBox &a_, &b_;
  const double margin_, scale_;
  const double apart_;  // m
  const double reach_;  // m: corners as near as that count, for boxes turn about the first that touch
  const Mat3 aFromB_, cosines_;
  const Vec3 offset_, motion_;
  Axis side_, edges_;
  bool hasSide_ = false, hasEdges_ = false;
  double clearance_ = 0;  // m
};

/// A corner of a clipped side: along the reference side's two directions, and its height above it.
struct Corner {
  double u, v, height;
};

/// Cuts what lies beyond `limit` along sign * coordinate.
template <double Corner::*coordinate>
std::size_t clipCorners(const Corner* from, std::size_t count, double sign, double limit, Corner* to) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Corner &here = from[i], &next = from[i + 1 < count ? i + 1 : 0];
    const double beyondHere = sign * here.*coordinate - limit, beyondNext = sign * next.*coordinate - limit;
    if (beyondHere <= 0) to[kept++] = here;
    if ((beyondHere < 0 && beyondNext > 0) || (beyondHere > 0 && beyondNext < 0)) {
      const double part = beyondHere / (beyondHere - beyondNext);
      to[kept++] = {here.u + part * (next.u - here.u), here.v + part * (next.v - here.v),
                    here.height + part * (next.height - here.height)};
    }
  }
  return kept;
}

PredictedManifold BoxPair::sideContact(const PosedBox& reference, const PosedBox& incident, int axis, double sign,
                                       const Vec3& aheadInA, bool referenceIsA) const {
  const Vec3 ahead = a_.axes * aheadInA;
  const int axisU = (axis + 1) % 3, axisV = (axis + 2) % 3;
  const Vec3 normal = sign * reference.axes.col(axis), alongU = reference.axes.col(axisU),
             alongV = reference.axes.col(axisV);

  // The side of the other box that faces this one most.
  const Vec3 facing = incident.axes.transpose() * normal;
  int side = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(facing[k]) > std::abs(facing[side])) side = k;
  const Vec3 halfP = incident.halfSize[(side + 1) % 3] * incident.axes.col((side + 1) % 3);
  const Vec3 halfQ = incident.halfSize[(side + 2) % 3] * incident.axes.col((side + 2) % 3);
  const Vec3 middle = incident.center + ahead - reference.center -
                      std::copysign(incident.halfSize[side], facing[side]) * incident.axes.col(side);

  const double height = reference.halfSize[axis];
  const double limitU = reference.halfSize[axisU], limitV = reference.halfSize[axisV];
  Corner corners[8], clipped[8];
  const double signsP[] = {1, -1, -1, 1}, signsQ[] = {1, 1, -1, -1};
  for (int k = 0; k < 4; ++k) {
    const Vec3 corner = middle + signsP[k] * halfP + signsQ[k] * halfQ;
    corners[k] = {corner.dot(alongU), corner.dot(alongV), corner.dot(normal) - height};
  }
  const Corner* lowest = std::min_element(
      corners, corners + 4, [](const Corner& left, const Corner& right) { return left.height < right.height; });
  const Corner lowestCorner = *lowest;
  std::size_t count = clipCorners<&Corner::u>(corners, 4, 1, limitU, clipped);
  count = clipCorners<&Corner::u>(clipped, count, -1, limitU, corners);
  count = clipCorners<&Corner::v>(corners, count, 1, limitV, clipped);
  count = clipCorners<&Corner::v>(clipped, count, -1, limitV, corners);

  if (count == 0) {
    // Beside each other on this side: where edges are clearly farther apart they are what is between the boxes, or what
    // touches would be thrown out of a depth that is none; else the lowest corner must not come below the side.
    if (hasEdges_ && edges_.separation > side_.separation + scale_ * kBeside)
      return edgeContact(edges_, wayUntilClosed(edges_, std::max(side_.separation, edges_.separation) > apart_));
    corners[0] = lowestCorner, count = 1;
  }

  const double aheadAlong = ahead.dot(normal);
  PredictedManifold::Point points[8];
  std::size_t near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Corner& corner = corners[k];
    if (corner.height > reach_) continue;
    const Vec3 onReference = reference.center + height * normal + corner.u * alongU + corner.v * alongV;
    const Vec3 onIncident = onReference + corner.height * normal - ahead;
    points[near++] = {referenceIsA ? onReference : onIncident, referenceIsA ? onIncident : onReference,
                      corner.height - aheadAlong};
  }
  PredictedManifold manifold;
  manifold.normal = referenceIsA ? normal : Vec3(-normal);
  appendSpanning(points, near, manifold, scale_);
  return manifold;
}

}  // namespace

PredictedManifold contactOfBoxes(const PosedBox& a, const PosedBox& b, const Vec3& motion, double margin,
                                 double scale) {
  BoxPair pair(a, b, motion, margin, scale);
  if (pair.findAxis()) return pair.contact();
  PredictedManifold none;
  none.clearance = pair.clearance();
  return none;
}

}  // namespace cradle
