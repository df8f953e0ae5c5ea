#include "collision/pair_search.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "collision/core.h"
#include "collision/mesh_collider.h"
#include "collision/mesh_surface.h"

namespace cradle {
namespace {

// Of the smaller radius: edges of meshes may graze each other so deep unseen. What does is apart at two looks, and at
// the rates of a body in free motion by far less.
constexpr double kGrazeRatio = 1e-4;
constexpr int kMaxLooks = 128;  // for directions, at a pair whose edges stay within a hair of each other
// Of a size: how far round surfaces sink in where a joint holds them before they press. From there the arm to the joint
// is long enough for an impulse to turn the body: 3e-5 of the size.
constexpr double kPinnedBand = 5e-10;
constexpr double kFlushArea = 1e-3;        // of a size, squared: corners that span more keep a body from tilting
constexpr double kFinestTurn = 1.0 / 16;   // of a step: solids that turn about a joint are looked at so often
constexpr double kFirstLook = 1.0 / 1024;  // of a step: a feature that leaves is looked at by then

Vec3 pointVelocity(int body, const Vec3& point, const VectorX& state) {
  if (body == kFixed) return Vec3::Zero();
  return linearVelocity(state, body) + angularVelocity(state, body).cross(point - centerOfMass(state, body));
}

/// How far (m) from the centre of mass the points of a collider are, without the spheres around them.
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
      lookBlindly();
    const double start = held_ ? gap(0) : separation(geometry_, pair_, feature_, startA_, startB_, reach);
    searchFeature(start, touching, best);
  }
}

/// A rim over a plane: points of it are held, and the lowest may become another, unless that itself is held.
void PairSearch::searchHeldRim(const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  held_ = nullptr;
  if (std::any_of(touching.held->begin(), touching.held->end(), [this](const ActiveFeature& held) {
        return held.pair == pairIndex_ && held.feature == feature_ && !held.contact.rimAxisA.isZero(0);
      }))
    return;
  const double start = gap(0);
  if (std::isfinite(touching.deadBand)) searchFrom(0, start, std::min(0.0, start) - touching.tolerance, best);
}

/// Solids that touch where a joint holds them, or nearly so, stay on two sides of a plane there, as they cannot roll:
/// as long as nothing else of them meets, their separation is that of the place held, and falls below it where anything
/// does. (Contacts beside the place do not tell that: far corners are in none of them until the turning brings them
/// near.)
void PairSearch::searchTurningAboutPin(const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  if (pair_.againstPlane || !std::isfinite(touching.deadBand)) return;
  const Collider& b = geometry_.colliders[pair_.b];
  const auto isSheet = [](const Collider& c) { return c.kind() == ColliderKind::mesh && c.mesh->isSheet; };
  if (isSheet(a_) || isSheet(b)) return;
  const auto pin =
      std::find_if(a_.pins.begin(), a_.pins.end(), [&](const PinnedPlace& place) { return place.other == bodyB_; });
  const auto pinB =
      std::find_if(b.pins.begin(), b.pins.end(), [&](const PinnedPlace& place) { return place.other == a_.body; });
  const Vec3 place = pin != a_.pins.end() ? startA_ * pin->point : startB_ * pinB->point;  // m, world
  const Vec3 inA = startA_.inverse() * place, inB = startB_.inverse() * place;
  // Between its ends the step keeps joints only as well as its interpolant: A is moved back to its anchor.
  const auto separationAt = [&](double fraction) {
    RigidTransform poseA = poseAt(step_, a_.body, fraction);
    const RigidTransform poseB = poseAt(step_, bodyB_, fraction);
    poseA.translation += poseB * inB - poseA * inA;
    return separation(geometry_, pair_, 0, poseA, poseB, reach_);
  };
  const double start = separationAt(0);
  const double size = std::max(a_.boundingRadius, b.boundingRadius), end = best ? best->fraction : 1;
  const bool touches = start <= std::max(touching.tolerance, kPinnedRatio * size);
  const double threshold = touches ? std::min(0.0, start) - deadBand(touching) : 0;
  GapBounds bounds = bounds_;
  bounds.acceleration = GapBounds().acceleration;
  bounds.finest = kFinestTurn;
  const auto above = [&](double fraction) { return separationAt(fraction) - threshold; };
  if (const auto fraction = firstRoot(above, bounds, {0, above(0), end, above(end)}))
    best = ImpactTime{*fraction, pairIndex_, feature_, threshold, true, {}};
}

/// A feature whose gap is `start` (m) as the step begins.
void PairSearch::searchFeature(double start, const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  if (start > bounds_.speed) return;
  if (start > touching.tolerance)
    searchFrom(0, start, 0, best);
  else if (std::isfinite(touching.deadBand))
    searchTouching(start, touching, best);
}

/// A gap is the least of those between all points of the two cores, less the spheres' radii. Of two points at distance
/// d: d'' <= relative acceleration + (speed across)^2 / d, d at least the radii's sum before they touch; and the
/// least of many accelerations upwards no more than they do. Without spheres nothing bounds it where d goes to zero:
/// then directions tell whether convex bodies stay apart.
void PairSearch::findBounds() {
  const MotionBounds shift = relativeMotionBounds(step_, a_.body, bodyB_);
  const MotionBounds& turnA = scratch_.turnOf(step_, a_.body);
  bounds_.speed = shift.speed + turnA.speed * pointReach(a_);
  pull_ = shift.acceleration + turnA.acceleration * pointReach(a_);
  if (pair_.againstPlane) {
    bounds_.acceleration = pull_;
    return;
  }
  const Collider& b = geometry_.colliders[pair_.b];
  const MotionBounds& turnB = scratch_.turnOf(step_, bodyB_);
  bounds_.speed += turnB.speed * pointReach(b);
  pull_ += turnB.acceleration * pointReach(b);
  const double radius = a_.radius + b.radius;
  if (radius > 0) bounds_.acceleration = pull_ + bounds_.speed * bounds_.speed / radius;
  if (radius > 0) return;
  if (hasMesh(a_, b))
    lookBlindly();
  else
    apart_.emplace(
        step_, a_, b,
        DirectionAccelerations{turnA.acceleration * pointReach(a_) + turnB.acceleration * pointReach(b),
                               pull_ + accelerationInFrame(turnA, b), pull_ + accelerationInFrame(turnB, a_)});
}

/// What the turning of a frame adds to the bend of the other body's points along a direction in it.
double PairSearch::accelerationInFrame(const MotionBounds& turn, const Collider& other) const {
  const double distance = (startA_.translation - startB_.translation).norm() + other.boundingRadius + bounds_.speed;
  return 2 * turn.speed * bounds_.speed + turn.acceleration * distance;
}

/// With a bound on the gap's speed alone.
void PairSearch::lookBlindly() {
  bounds_.graze = kGrazeRatio * std::min(a_.boundingRadius, geometry_.colliders[pair_.b].boundingRadius);
  const auto isSheet = [](const Collider& collider) {
    return collider.kind() == ColliderKind::mesh && collider.mesh->isSheet;
  };
  // What goes through a sheet is soon on its other side, and apart again.
  const bool isThin = isSheet(a_) || isSheet(geometry_.colliders[pair_.b]);
  if (!std::isfinite(bounds_.acceleration) && !isThin) bounds_.finest = kFinestBlindApproach;
  apart_.reset();
}

/// Whether one body is above a face of the other all the time.
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

/// Corners over a face that may turn: h'' of their height h has parts from the normal's turning.
void PairSearch::searchCorners(const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  const Collider& upper = face_->isOfA ? geometry_.colliders[pair_.b] : a_;
  if (isFlush(touching, upper)) return;
  pull_ += accelerationInFrame(scratch_.turnOf(step_, face_->isOfA ? a_.body : bodyB_), upper);
  bounds_.acceleration = pull_;
  apart_.reset();
  for (std::size_t corner = 0; corner < upper.points.size(); ++corner) {
    feature_ = corner;
    if (isCornerHeld(touching, upper)) continue;
    const double start = gap(0);
    searchFeature(start, touching, best);
  }
}

bool PairSearch::isCornerHeld(const TouchingFeatures& touching, const Collider& upper) const {
  const double near = kHeldPlace * upper.boundingRadius;
  const int lower = face_->isOfA ? a_.body : bodyB_;
  if (isPinned(upper, lower, upper.points[feature_], kPinnedRatio * upper.boundingRadius)) return true;
  return touching.held && std::any_of(touching.held->begin(), touching.held->end(), [&](const ActiveFeature& held) {
           const Attachment& corner = held.contact.centerA;
           return held.pair == pairIndex_ && corner.body == upper.body &&
                  (corner.point - upper.points[feature_]).squaredNorm() < near * near;
         });
}

/// Whether corners of a body are held that span an area: then it does not tilt, and no other comes any nearer.
bool PairSearch::isFlush(const TouchingFeatures& touching, const Collider& upper) const {
  if (!touching.held || upper.radius > 0 || upper.rimRadius > 0) return false;
  std::vector<Vec3> arms;  // m, from the first of them
  const Vec3* first = nullptr;
  for (const ActiveFeature& held : *touching.held) {
    const Attachment& corner = held.contact.centerA;
    if (held.pair != pairIndex_ || corner.body != upper.body || !std::isinf(held.contact.radiusB)) continue;
    if (first) arms.push_back(corner.point - *first);
    first = first ? first : &corner.point;
  }
  const double area = kFlushArea * upper.boundingRadius * upper.boundingRadius;
  return std::any_of(arms.begin(), arms.end(), [&](const Vec3& arm) { return arm.cross(arms[0]).norm() > area; });
}

bool PairSearch::isHeld(const TouchingFeatures& touching) const {
  return touching.held && std::any_of(touching.held->begin(), touching.held->end(), [this](const ActiveFeature& held) {
           return held.pair == pairIndex_ && held.feature == feature_;
         });
}

/// A sphere may touch a mesh at two places, as in a groove.
bool PairSearch::hasOneContact() const {
  if (pair_.againstPlane) return true;
  return hasSphere() && !hasMesh(a_, geometry_.colliders[pair_.b]);
}

bool PairSearch::hasSphere() const {
  return a_.isSphere() || geometry_.colliders[pair_.b].isSphere();
}

/// Whether the gap is that of one point, or accelerations downwards no more than one: of a sphere and what is convex,
/// of a corner over a plane. While one point of a rim leaves, another may come down.
bool PairSearch::staysOnePoint() const {
  if (pair_.againstPlane) return a_.kind() != ColliderKind::cylinder;
  return hasOneContact();
}

/// A feature that leaves stays away at least until the strongest pull could bring it back; one that does not, or by
/// no more than the dead band, has that.
void PairSearch::searchTouching(double start, const TouchingFeatures& touching, std::optional<ImpactTime>& best) {
  const double lowest = std::min(0.0, start), speed = leavingSpeed(touching.tolerance) * step_.timeStep;
  const double band = deadBand(touching);
  bounds_.graze = std::max(bounds_.graze, touching.tolerance);  // what stays flush would be looked at for ever
  if (!(speed > band)) return searchFrom(0, start, lowest - band, best);
  const bool hasOnePoint = std::isfinite(bounds_.acceleration) && staysOnePoint();
  if (hasOnePoint && speed >= 0.5 * pull_) return;
  const double from = std::min(speed / pull_, hasOnePoint ? 1 : kFirstLook);
  const double away = gap(from);
  if (away > lowest)
    searchFrom(from, away, lowest, best);
  else
    searchFrom(0, start, lowest - band, best);  // a leap within rounding
}

/// m: how far a feature that touches without a load may sink in.
double PairSearch::deadBand(const TouchingFeatures& touching) const {
  if (!hasPinnedPlaces(geometry_, pair_)) return touching.deadBand;
  double size = a_.boundingRadius;
  if (!pair_.againstPlane) size = std::min(size, geometry_.colliders[pair_.b].boundingRadius);
  return std::max(touching.deadBand, kPinnedBand * size);
}

/// Where the gap falls to `threshold` (m).
void PairSearch::searchFrom(double from, double gapFrom, double threshold, std::optional<ImpactTime>& best) {
  const double end = best ? best->fraction : 1;
  if (from >= end) return;
  const auto above = [&](double fraction) { return gap(fraction) - threshold; };
  const auto areApart = [&](const Bracket& ends) {
    if (apart_ && apart_->queries() > kMaxLooks) lookBlindly();
    return apart_ && apart_->during(ends, threshold, bounds_);
  };
  if (const auto fraction = firstRoot(above, bounds_, areApart, {from, gapFrom - threshold, end, above(end)}))
    best = ImpactTime{*fraction, pairIndex_, feature_, threshold, held_ != nullptr, face_};
}

/// m/s; of the point of the feature that leaves slowest.
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
    scratch_.findOthers(pairIndex_, *held_, step_.startState, tolerance);
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

/// m, world: of the feature, over a plane.
Vec3 PairSearch::lowestPoint(const Vec3& planeNormal) const {
  if (a_.kind() == ColliderKind::cylinder) return Core(a_, startA_).rimPoint(feature_ == 0 ? 1 : -1, -planeNormal);
  return startA_ * a_.points[feature_] - a_.radius * planeNormal;
}

double PairSearch::gap(double fraction) {
  if (face_)
    return heightOfCorner(*face_, feature_, {a_, poseAt(step_, a_.body, fraction)},
                          {geometry_.colliders[pair_.b], poseAt(step_, bodyB_, fraction)});
  if (held_) {
    for (const int body : {a_.body, bodyB_})
      if (body != kFixed) interpolatePose(step_, body, fraction, scratch_.sample_);
    return scratch_.gapOfOthers(pairIndex_, *held_, scratch_.sample_, reach_);
  }
  // A gap of twice the way that can be gone in the step stays open, however large it is.
  const double enough = 2 * bounds_.speed;
  return std::min(2 * enough, separation(geometry_, pair_, feature_, poseAt(step_, a_.body, fraction),
                                         poseAt(step_, bodyB_, fraction), enough));
}

}  // namespace cradle
