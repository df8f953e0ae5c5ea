#include "collision/pair_search.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "collision/core.h"
#include "collision/impact_search_tolerances.h"
#include "collision/mesh_collider.h"
#include "collision/mesh_surface.h"

namespace cradle {
namespace {

// Of a pair, whose edges may stay close all through a step: half or twice as many change no test.
constexpr int kMaxAxisQueries = 128;
// Of a step: solids that turn about a joint are searched no more finely, for each query is one of both whole solids. A
// tenth or ten times as much changes no test of a search.
constexpr double kFinestRotation = 1.0 / 16;
// Of a step: what such solids have beside the joint may be a constant small gap from the other, and is searched no more
// finely; what the search misses, the one of whole solids finds as an overlap.
constexpr double kFinestBesidePin = 1.0 / 256;
// Of a step: a feature that leaves is searched from then on at the latest, for another of its points may come down. A
// tenth or ten times as much changes no test of a search.
constexpr double kFirstGap = 1.0 / 1024;
// Of a coordinate: so well a gap is known there.
constexpr double kCoordinateRounding = 1e-15;
// Times its rounding: a gap that leaves by no more is one again, or sinks in, when it has closed by this.
constexpr double kBounceRatio = 8;
// rad, in a step: of two bodies against each other, by which a manifold of convex ones may change its features.
constexpr double kTurned = 0.1;

/// Distance (m) from the centre of mass of a collider's farthest point, without the spheres around its points.
double pointReach(const Collider& collider) {
  return collider.boundingRadius - collider.radius;
}

}  // namespace

double heightOfCorner(const FaceBelow& face, std::size_t corner, const std::pair<const Collider&, RigidTransform>& a,
                      const std::pair<const Collider&, RigidTransform>& b) {
  const auto& [upper, worldFromUpper] = face.isOfA ? b : a;
  const RigidTransform& worldFromLower = face.isOfA ? a.second : b.second;
  return heightOver(face, worldFromLower, worldFromUpper * upper.points[corner]) - upper.radius;
}

PairSearch::PairSearch(ImpactSearch& scratch, const Step& step, std::size_t pair)
    : geometry_(scratch.geometry_),
      scratch_(scratch),
      step_(step),
      pairIndex_(pair),
      pair_(geometry_.pairs[pair]),
      a_(geometry_.colliders[pair_.a]),
      bodyB_(bodyBOf(geometry_, pair_)),
      startA_(poseAt(step, a_.body, 0)),
      startB_(poseAt(step, bodyB_, 0)) {}

void PairSearch::search(const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  feature_ = 0;
  // A body that goes through a sheet is soon on its other side, and apart again: sheets are searched finely.
  if (!hasSheet()) bounds_.finest = std::max(bounds_.finest, touching.finest);
  const bool isPinned = !pair_.againstPlane && hasPinnedPlaces(geometry_, pair_);
  if (isHeld(touching) && !pair_.againstPlane && hasOneContact()) return;  // there is no other
  findBounds();
  const double reach = bounds_.speed + touching.tolerance;
  if (separationBound(geometry_, pair_, startA_, startB_) > reach) return;
  reach_ = reach;
  findFace();
  if (face_) return searchCorners(touching, best);
  if (pair_.againstPlane && isFlush(touching, a_)) return;
  scratch_.features_.clear();
  appendFeaturesWithin(geometry_, pair_, startA_, reach, scratch_.features_);
  for (const std::size_t feature : scratch_.features_) {
    feature_ = feature;
    if (isPinned && !isHeld(touching)) searchTurningAboutPin(touching, best);
    held_ = isPinned || isHeld(touching) ? &touching.activeFeatures() : nullptr;
    if (held_ && pair_.againstPlane && a_.kind() == ColliderKind::cylinder) {
      searchHeldRim(touching, best);
      continue;
    }
    if (isHeld(touching) && hasOneContact()) continue;
    if (held_ && (apart_ || (hasMesh(a_, geometry_.colliders[pair_.b]) && !(hasSphere() && isHeld(touching)))))
      useSpeedBoundAlone();
    if (isPinned && !pair_.againstPlane) bounds_.finest = std::max(bounds_.finest, kFinestBesidePin);
    const double start = held_ ? gap(0) : separation(geometry_, pair_, feature_, startA_, startB_, reach);
    searchFeature(start, touching, best);
  }
}

/// A rim over a plane of which points are held. Another of its points may become the lowest one and collide; not so
/// where the contact holds the lowest point itself, whichever that is (rimAxisA).
void PairSearch::searchHeldRim(const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  held_ = nullptr;
  if (std::any_of(touching.active->begin(), touching.active->end(), [this](const ActiveFeature& held) {
        return held.pair == pairIndex_ && held.feature == feature_ && !held.contact.rimAxisA.isZero(0);
      }))
    return;
  const double start = gap(0);
  if (std::isfinite(touching.deadBand)) searchFrom(0, start, std::min(0.0, start) - touching.tolerance, best);
}

/// A pair of solids that touch, or nearly so, where a joint holds them. They cannot roll there, and stay on two sides
/// of a plane: their separation is that of the held place as long as nothing else of them meets, and falls below it
/// where anything does. (Contacts beside the held place do not tell that: far corners are in none of them before the
/// rotation has brought them near.)
void PairSearch::searchTurningAboutPin(const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  if (pair_.againstPlane || !std::isfinite(touching.deadBand)) return;
  if (hasSheet()) return;
  const Collider& b = geometry_.colliders[pair_.b];
  const auto pin =
      std::find_if(a_.pins.begin(), a_.pins.end(), [&](const PinnedPlace& place) { return place.other == bodyB_; });
  const auto pinB =
      std::find_if(b.pins.begin(), b.pins.end(), [&](const PinnedPlace& place) { return place.other == a_.body; });
  const Vec3 place = pin != a_.pins.end() ? startA_ * pin->point : startB_ * pinB->point;  // m, world
  const Vec3 inA = startA_.inverse() * place, inB = startB_.inverse() * place;
  // Inside the step joints are kept only as well as the interpolant keeps them: A is moved back to its anchor.
  const auto separationAt = [&](double fraction) {
    RigidTransform poseA = poseAt(step_, a_.body, fraction);
    const RigidTransform poseB = poseAt(step_, bodyB_, fraction);
    poseA.translation += poseB * inB - poseA * inA;
    return separation(geometry_, pair_, 0, poseA, poseB, reach_);
  };
  const double start = separationAt(0);
  const double size = std::max(a_.boundingRadius, b.boundingRadius), end = best ? best->fraction : 1;
  const bool touches = start <= std::max(touching.tolerance, ImpactSearchTolerances(size).pinned);
  const double band = deadBand(touching);
  double threshold = 0;
  if (touches && isBounce(leavingSpeed(touching.tolerance) * step_.timeStep))
    threshold = std::min(-band, start - kBounceRatio * gapRounding());
  else if (touches)
    threshold = std::min(0.0, start) - band;
  GapBounds bounds = bounds_;
  bounds.acceleration = GapBounds().acceleration;
  bounds.finest = kFinestRotation;
  const auto above = [&](double fraction) { return separationAt(fraction) - threshold; };
  if (const auto fraction = firstRoot(above, bounds, {0, above(0), end, above(end)}))
    best = ImpactTime{*fraction, pairIndex_, feature_, threshold, true, {}};
}

/// Searches for the impact of a feature whose gap is `start` (m) when the step begins.
void PairSearch::searchFeature(double start, const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  if (start > bounds_.speed && !mayTurnDown()) return;
  if (start > touching.tolerance)
    searchFrom(0, start, 0, best);
  else if (std::isfinite(touching.deadBand))
    searchTouching(start, touching, best);
}

/// Whether a pair that a contact holds may turn so far that others come which were none at the start, however near:
/// the far end of a body that stands or leans. Meshes have contacts only where they go back from a tangent plane, so
/// that the least turn may bring others.
bool PairSearch::mayTurnDown() {
  if (!held_) return false;
  const double turned = scratch_.turnOf(step_, a_.body).speed + scratch_.turnOf(step_, bodyB_).speed;
  return turned > (hasMesh(a_, geometry_.colliders[pair_.b]) ? 0 : kTurned);
}

/// Finds bounds on the gap. A gap is the least distance d between points of the two cores, less the radii r of the
/// spheres around them. For each pair of points
///   d'' <= |relative acceleration| + (relative speed)^2 / d,
/// where d >= r until they touch, and the least of many functions curves upwards no more than each of them does.
/// Without spheres (r = 0) nothing bounds d''; separating axes then tell whether convex bodies stay apart.
void PairSearch::findBounds() {
  const MotionBounds shift = relativeMotionBounds(step_, a_.body, bodyB_);
  const MotionBounds& turnA = scratch_.turnOf(step_, a_.body);
  bounds_.speed = shift.speed + turnA.speed * pointReach(a_);
  maxAcceleration_ = shift.acceleration + turnA.acceleration * pointReach(a_);
  if (pair_.againstPlane) {
    bounds_.acceleration = maxAcceleration_;
    return;
  }
  const Collider& b = geometry_.colliders[pair_.b];
  const MotionBounds& turnB = scratch_.turnOf(step_, bodyB_);
  bounds_.speed += turnB.speed * pointReach(b);
  maxAcceleration_ += turnB.acceleration * pointReach(b);
  const double radius = a_.radius + b.radius;
  if (radius > 0) bounds_.acceleration = maxAcceleration_ + bounds_.speed * bounds_.speed / radius;
  if (radius > 0) return;
  if (hasMesh(a_, b))
    useSpeedBoundAlone();
  else
    apart_.emplace(step_, a_, b,
                   DirectionAccelerations{turnA.acceleration * pointReach(a_) + turnB.acceleration * pointReach(b),
                                          maxAcceleration_ + accelerationInFrame(turnA, b),
                                          maxAcceleration_ + accelerationInFrame(turnB, a_)});
}

/// The acceleration that the rotation of one body's frame adds to the other body's points as seen in that frame (m,
/// with the step as the unit of time): 2 omega v + alpha r, the Coriolis and Euler terms.
double PairSearch::accelerationInFrame(const MotionBounds& turn, const Collider& other) const {
  const double distance = (startA_.translation - startB_.translation).norm() + other.boundingRadius + bounds_.speed;
  return 2 * turn.speed * bounds_.speed + turn.acceleration * distance;
}

/// Leaves the search with a bound on the gap's speed alone. Shallow touches may then be passed over.
void PairSearch::useSpeedBoundAlone() {
  bounds_.graze =
      ImpactSearchTolerances(std::min(a_.boundingRadius, geometry_.colliders[pair_.b].boundingRadius)).graze;
  if (!std::isfinite(bounds_.acceleration) && !hasSheet())
    bounds_.finest = std::max(bounds_.finest, kFinestBlindApproach);
  apart_.reset();
}

/// Finds a face of one body above which the other one stays during the whole step.
void PairSearch::findFace() {
  if (pair_.againstPlane) return;
  const Collider& b = geometry_.colliders[pair_.b];
  const bool hasFacesA = a_.kind() == ColliderKind::polytope, hasFacesB = b.kind() == ColliderKind::polytope;
  if (!hasFacesA && !hasFacesB) return;
  const double distance = (startA_.translation - startB_.translation).norm();
  const double turn = std::max(scratch_.turnOf(step_, a_.body).speed, scratch_.turnOf(step_, bodyB_).speed);
  const auto motionAlong = [&](const Vec3& normal) {
    if (a_.body == kFixed || bodyB_ == kFixed) return motionBoundAcross(step_, a_.body, bodyB_, normal);
    return 2 * bounds_.speed + turn * distance;
  };
  if (hasFacesB) face_ = faceBelow(a_, startA_, b, startB_, std::cref(motionAlong));
  if (face_ || !hasFacesA) return;
  face_ = faceBelow(b, startB_, a_, startA_, std::cref(motionAlong));
  if (face_) face_->isOfA = true;
}

/// Searches for impacts of corners over a face. The face may turn: that adds to the acceleration of their heights.
void PairSearch::searchCorners(const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  const Collider& upper = face_->isOfA ? geometry_.colliders[pair_.b] : a_;
  if (isFlush(touching, upper)) return;
  maxAcceleration_ += accelerationInFrame(scratch_.turnOf(step_, face_->isOfA ? a_.body : bodyB_), upper);
  bounds_.acceleration = maxAcceleration_;
  apart_.reset();
  for (std::size_t corner = 0; corner < upper.points.size(); ++corner) {
    feature_ = corner;
    if (isCornerHeld(touching, upper)) continue;
    const double start = gap(0);
    searchFeature(start, touching, best);
  }
}

bool PairSearch::isCornerHeld(const TouchingFeatures& touching, const Collider& upper) const {
  const ImpactSearchTolerances tolerances(upper.boundingRadius);
  const double near = tolerances.samePlace;
  const int lower = face_->isOfA ? a_.body : bodyB_;
  if (isPinned(upper, lower, upper.points[feature_], tolerances.pinned)) return true;
  return touching.active &&
         std::any_of(touching.active->begin(), touching.active->end(), [&](const ActiveFeature& held) {
           const Attachment& corner = held.contact.centerA;
           return held.pair == pairIndex_ && corner.body == upper.body &&
                  (corner.point - upper.points[feature_]).squaredNorm() < near * near;
         });
}

/// Whether the corners of a body that are held span an area, or both rims of a cylinder that lies are held: the body
/// then does not tilt, and no other point of it comes any nearer.
bool PairSearch::isFlush(const TouchingFeatures& touching, const Collider& upper) const {
  if (!touching.active || upper.radius > 0) return false;
  std::vector<Vec3> arms;  // m, from the first of them
  const Vec3* first = nullptr;
  for (const ActiveFeature& held : *touching.active) {
    const Attachment& corner = held.contact.centerA;
    if (held.pair != pairIndex_ || corner.body != upper.body || !std::isinf(held.contact.radiusB)) continue;
    if (!held.contact.rimAxisA.isZero(0)) return false;
    if (first) arms.push_back(corner.point - *first);
    first = first ? first : &corner.point;
    const bool isOfSide = held.contact.radiusA > 0;  // of a cylinder that lies: it stands on corners
    if (isOfSide && !arms.empty() && 2 * arms.back().norm() > (upper.points[0] - upper.points[1]).norm()) return true;
  }
  const double area = ImpactSearchTolerances(upper.boundingRadius).flushArea;
  return std::any_of(arms.begin(), arms.end(), [&](const Vec3& arm) { return arm.cross(arms[0]).norm() > area; });
}

bool PairSearch::isHeld(const TouchingFeatures& touching) const {
  return touching.active &&
         std::any_of(touching.active->begin(), touching.active->end(),
                     [this](const ActiveFeature& held) { return held.pair == pairIndex_ && held.feature == feature_; });
}

/// Whether the pair can have no more than one contact. (A sphere may touch a mesh at two places, as in a groove.)
bool PairSearch::hasOneContact() const {
  if (pair_.againstPlane) return true;
  return hasSphere() && !hasMesh(a_, geometry_.colliders[pair_.b]);
}

bool PairSearch::hasSheet() const {
  if (pair_.againstPlane) return false;
  const auto isSheet = [](const Collider& c) { return c.kind() == ColliderKind::mesh && c.mesh->isSheet; };
  return isSheet(a_) || isSheet(geometry_.colliders[pair_.b]);
}

bool PairSearch::hasSphere() const {
  return a_.isSphere() || geometry_.colliders[pair_.b].isSphere();
}

/// Whether the gap, as it opens, comes back no sooner than that of one point: the gap of a sphere and a convex shape,
/// or of a corner over a plane. (While one point of a rim leaves, another one may come down.)
bool PairSearch::staysOnePoint() const {
  if (pair_.againstPlane) return a_.kind() != ColliderKind::cylinder;
  return hasOneContact();
}

/// Searches for the impact of a feature that touches when the step begins. If it leaves with a speed v, the largest
/// acceleration a cannot bring it back before the time 2 v / a; the search begins at v / a, where it is farthest, or
/// later, where it is so far that rounding does not hide it. It then collides as deep as it was: with each bounce it
/// would sink in otherwise. If it does not leave, it collides when it has closed by the dead band.
void PairSearch::searchTouching(double start, const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  const double lowest = std::min(0.0, start), speed = leavingSpeed(touching.tolerance) * step_.timeStep;
  const double band = deadBand(touching), acceleration = closingAcceleration();
  bounds_.graze = std::max(bounds_.graze, touching.tolerance);  // faces that stay flush would be searched without end
  const bool isFollowed = band > touching.deadBand && isBounce(speed);
  if (!(speed > band || isFollowed)) return searchFrom(0, start, lowest - band, best);
  const bool hasOnePoint = std::isfinite(bounds_.acceleration) && staysOnePoint();
  if (hasOnePoint && speed >= 0.5 * acceleration) return;  // 2 v / a is beyond the step
  const double rounding = gapRounding();
  double from = std::min(speed / acceleration, hasOnePoint ? 1 : kFirstGap), away = gap(from);
  while (isFollowed && from < kFirstGap && std::abs(away - lowest) <= rounding) away = gap(from *= 2);
  if (away > lowest)
    searchFrom(from, away, lowest, best);
  else
    searchFrom(0, start, lowest - (isFollowed ? std::min(band, kBounceRatio * rounding) : band), best);
}

/// Whether a feature that leaves with a speed (m, with the step as the unit of time) rises so high that it bounces.
bool PairSearch::isBounce(double speed) const {
  const double leastRise = ImpactSearchTolerances(a_.boundingRadius).leastRise;
  return speed > 0 && speed * speed > 2 * closingAcceleration() * leastRise;
}

/// Bound on the acceleration with which the gap comes back (m, with the step as the unit of time). The distance of a
/// sphere's centre from a convex body is a convex function of its place in the frame of that body, and bends down no
/// more than the centre is accelerated there: also by the turning of the frame, however far from the body's own points.
double PairSearch::closingAcceleration() const {
  if (pair_.againstPlane || face_ || !hasSphere()) return maxAcceleration_;
  const Collider& b = geometry_.colliders[pair_.b];
  if (a_.isSphere() && b.isSphere()) return maxAcceleration_;
  return maxAcceleration_ + (a_.isSphere() ? accelerationInFrame(scratch_.turnOf(step_, bodyB_), a_)
                                           : accelerationInFrame(scratch_.turnOf(step_, a_.body), b));
}

/// How far (m) a feature that touches without being held may sink in before that is an impact.
double PairSearch::deadBand(const TouchingFeatures& touching) const {
  if (!hasPinnedPlaces(geometry_, pair_)) return touching.deadBand;
  double size = a_.boundingRadius;
  if (!pair_.againstPlane) size = std::min(size, geometry_.colliders[pair_.b].boundingRadius);
  return std::max(touching.deadBand, ImpactSearchTolerances(size).pinnedBand);
}

/// How far (m) a gap may be from what it seems to be.
double PairSearch::gapRounding() const {
  const double farthest =
      std::max(startA_.translation.cwiseAbs().maxCoeff(), startB_.translation.cwiseAbs().maxCoeff());
  return std::max(ImpactSearchTolerances(a_.boundingRadius).rounding, kCoordinateRounding * farthest);
}

/// Puts into `best` the instant after `from` at which the gap falls to `threshold` (m), if there is one before it.
void PairSearch::searchFrom(double from, double gapFrom, double threshold, std::optional<ImpactTime>& best) {
  const double end = best ? best->fraction : 1;
  if (from >= end) return;
  const auto above = [&](double fraction, double enough = INFINITY) { return gap(fraction, enough) - threshold; };
  const auto areApart = [&](const Bracket& ends) {
    if (apart_ && apart_->queries() > kMaxAxisQueries) useSpeedBoundAlone();
    return apart_ && apart_->during(ends, threshold, bounds_);
  };
  if (const auto fraction = firstRoot(above, bounds_, areApart, {from, gapFrom - threshold, end, above(end)}))
    best = ImpactTime{*fraction, pairIndex_, feature_, threshold, held_ != nullptr, face_};
}

/// Speed (m/s) with which the feature leaves: that of its slowest point.
double PairSearch::leavingSpeed(double tolerance) {
  if (pair_.againstPlane) {
    const Vec3& normal = geometry_.planes[pair_.b].normal;
    return normal.dot(pointVelocity(a_.body, lowestPoint(normal), step_.startState));
  }
  if (face_) {
    const Vec3 normal = (face_->isOfA ? startA_ : startB_).rotation * face_->normal;
    const double radius = (face_->isOfA ? geometry_.colliders[pair_.b] : a_).radius;
    const Vec3 place =
        face_->isOfA ? startB_ * geometry_.colliders[pair_.b].points[feature_] : startA_ * a_.points[feature_];
    const Vec3 corner = place - radius * normal;
    const int upper = face_->isOfA ? bodyB_ : a_.body, lower = face_->isOfA ? a_.body : bodyB_;
    return normal.dot(pointVelocity(upper, corner, step_.startState) - pointVelocity(lower, corner, step_.startState));
  }
  if (held_) {
    findContactsBesideHeld(geometry_, pairIndex_, *held_, step_.startState, tolerance, scratch_.contacts_);
  } else {
    scratch_.contacts_.clear();
    appendContacts(geometry_, pairIndex_, step_.startState, tolerance, scratch_.contacts_);
  }
  double least = 0;
  for (std::size_t i = 0; i < scratch_.contacts_.size(); ++i) {
    const double speed = openingSpeed(scratch_.contacts_[i], step_.startState);
    least = i == 0 ? speed : std::min(least, speed);
  }
  return least;
}

/// The lowest point (m, world) of the feature over a plane.
Vec3 PairSearch::lowestPoint(const Vec3& planeNormal) const {
  if (a_.kind() == ColliderKind::cylinder) return Core(a_, startA_).rimPoint(feature_ == 0 ? 1 : -1, -planeNormal);
  return startA_ * a_.points[feature_] - a_.radius * planeNormal;
}

double PairSearch::gap(double fraction, double enough) {
  if (face_)
    return heightOfCorner(*face_, feature_, {a_, poseAt(step_, a_.body, fraction)},
                          {geometry_.colliders[pair_.b], poseAt(step_, bodyB_, fraction)});
  if (held_) {
    for (const int body : {a_.body, bodyB_})
      if (body != kFixed) interpolatePose(step_, body, fraction, scratch_.sample_);
    return gapBesideHeld(geometry_, pairIndex_, *held_, scratch_.sample_, std::min(reach_, enough), scratch_.contacts_);
  }
  // A gap of more than the motion possible in the step stays open; its value does not matter.
  const double reach = std::min(2 * bounds_.speed, enough);
  return std::min(2 * reach, separation(geometry_, pair_, feature_, poseAt(step_, a_.body, fraction),
                                        poseAt(step_, bodyB_, fraction), reach));
}

}  // namespace cradle
