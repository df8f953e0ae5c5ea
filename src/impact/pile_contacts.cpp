#include "impact/pile_contacts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace cradle {
namespace {

constexpr double kSamePoint = 0.1;    // of the body's radius: points as near as that are one from step to step
constexpr double kSameNormal = 0.9;   // cosine, at least, for impulses to go on
constexpr double kRounding = 1e-9;    // of a unit axis or a side
constexpr double kSlowSliding = 0.1;  // m/s: slower, static friction holds; a step's gain by gravity is 0.16

constexpr double kBallPart = 0.6;  // of their approach counts: of balls the point that will touch is known
constexpr double kSpinPart = 0.5;  // of the speed of the farthest point: few touch with that one
const MovingPose kStill{};

const MovingPose& poseOf(const std::vector<MovingPose>& poses, int body) {
  return body == kFixed ? kStill : poses[static_cast<std::size_t>(body)];
}

auto orderOf(const ColliderPair& pair) {
  return std::tuple(!pair.againstPlane, pair.againstPlane ? pair.b : pair.a, pair.againstPlane ? pair.a : pair.b);
}

}  // namespace

PileContacts::PileContacts(const ContactGeometry& geometry) : geometry_(geometry) {
  for (const Collider& collider : geometry.colliders) {
    boxes_.push_back(boxOf(collider));
    isFast_.push_back(boxes_.back().has_value() || collider.isBall());
  }
}

/// A polytope that is a box with corners numbered as polytopeOf does.
std::optional<PileContacts::BoxShape> PileContacts::boxOf(const Collider& collider) {
  if (collider.kind() != ColliderKind::polytope || !collider.polytope || collider.polytope->vertices.size() != 8 ||
      collider.polytope->faces.size() != 6)
    return {};
  const std::vector<Vec3>& corners = collider.polytope->vertices;
  BoxShape box;
  Vec3 opposite = corners[0];
  for (const int k : {0, 1, 2}) {
    const Vec3 side = corners[std::size_t{1} << k] - corners[0];
    box.halfSize[k] = side.norm() / 2;
    box.axes.col(k) = side.normalized();
    opposite += side;
  }
  box.center = (corners[0] + opposite) / 2;
  const double size = box.halfSize.norm();
  if (!((box.axes.transpose() * box.axes - Mat3::Identity()).norm() < kRounding)) return {};
  if ((opposite - corners[7]).norm() > kRounding * size) return {};
  if ((corners[3] - corners[1] - corners[2] + corners[0]).norm() > kRounding * size) return {};
  return box;
}

PileContacts::NearPair PileContacts::nearPairOf(std::size_t index) const {
  const ColliderPair& pair = geometry_.pairs[index];
  NearPair near;
  near.pair = index, near.againstPlane = pair.againstPlane;
  near.shapeA = pair.a, near.shapeB = pair.b;
  near.bodyA = geometry_.colliders[pair.a].body, near.bodyB = bodyBOf(geometry_, pair);
  near.isExchanged = near.bodyA == kFixed;
  if (near.isExchanged) std::swap(near.shapeA, near.shapeB), std::swap(near.bodyA, near.bodyB);
  return near;
}

void PileContacts::takePairs() {
  taken_.clear();
  std::size_t old = 0;
  const auto release = [&](const NearPair& pair) {
    if (pair.manifold >= 0) free_.push_back(pair.manifold);
  };
  for (std::size_t i = 0; i < geometry_.pairs.size(); ++i) {
    const auto order = orderOf(geometry_.pairs[i]);
    while (old < listed_.size() && orderOf(listed_[old]) < order) release(pairs_[old++]);
    if (old < listed_.size() && orderOf(listed_[old]) == order) {
      taken_.push_back(pairs_[old++]);
      taken_.back().pair = i;
    } else {
      taken_.push_back(nearPairOf(i));
    }
  }
  while (old < listed_.size()) release(pairs_[old++]);
  listed_ = geometry_.pairs;
  pairs_.swap(taken_);
}

/// How fast bodies approach each other, at most; 0 if they cannot meet within the time.
double PileContacts::approachOf(const NearPair& pair, const std::vector<MovingPose>& poses, double time) const {
  const MovingPose &a = poseOf(poses, pair.bodyA), &b = poseOf(poses, pair.bodyB);
  const bool isBallA = geometry_.colliders[pair.shapeA].isBall();
  const bool isBallB = pair.againstPlane || geometry_.colliders[pair.shapeB].isBall();
  const double spin = kSpinPart * ((isBallA ? 0 : a.angularVelocity.norm() * a.radius) +
                                   (isBallB || pair.bodyB == kFixed ? 0 : b.angularVelocity.norm() * b.radius));
  const double part = isBallA && isBallB ? kBallPart : 1;
  const Vec3 velocity = b.linearVelocity - a.linearVelocity;
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry_.planes[pair.shapeB];
    const double closing = std::max(0.0, plane.normal.dot(velocity)) + spin;
    return plane.normal.dot(a.position - plane.point) - a.radius < closing * time ? part * closing : 0;
  }
  if (pair.bodyB == kFixed) return part * velocity.norm() + spin;
  const Vec3 offset = b.position - a.position;
  const double reach = a.radius + b.radius + (velocity.norm() + spin) * time, distance2 = offset.squaredNorm();
  if (distance2 > reach * reach || distance2 == 0) return 0;
  return part * std::max(0.0, -offset.dot(velocity) / std::sqrt(distance2)) + spin;
}

double PileContacts::fastestApproach(const std::vector<MovingPose>& poses, double time, WorkerThreads& threads) const {
  std::vector<double> fastest(static_cast<std::size_t>(threads.count()), 0);
  threads.run([&](int thread) {
    const auto [first, last] = threads.partOf(pairs_.size(), thread);
    double most = 0;
    for (std::size_t i = first; i < last; ++i) most = std::max(most, approachOf(pairs_[i], poses, time));
    fastest[static_cast<std::size_t>(thread)] = most;
  });
  return *std::max_element(fastest.begin(), fastest.end());
}

bool PileContacts::mayTouch(const NearPair& pair, const std::vector<MovingPose>& poses, double time) const {
  const MovingPose &a = poseOf(poses, pair.bodyA), &b = poseOf(poses, pair.bodyB);
  if (a.isAsleep && (pair.bodyB == kFixed || b.isAsleep)) return false;
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry_.planes[pair.shapeB];
    const double speed = a.linearVelocity.norm() + a.angularVelocity.norm() * a.radius;
    return plane.normal.dot(a.position - plane.point) < a.radius + kContactMargin + speed * time;
  }
  if (pair.bodyB == kFixed) return true;
  const double reach = a.radius + b.radius + kContactMargin + (b.linearVelocity - a.linearVelocity).norm() * time;
  return (b.position - a.position).squaredNorm() < reach * reach;
}

void PileContacts::update(const std::vector<MovingPose>& poses, const VectorX& state, double timeStep,
                          WorkerThreads& threads) {
  scratch_.resize(static_cast<std::size_t>(threads.count()));
  threads.run([&](int thread) {
    const auto [first, last] = threads.partOf(pairs_.size(), thread);
    for (std::size_t i = first; i < last; ++i) pairs_[i].isNear = mayTouch(pairs_[i], poses, timeStep);
  });
  giveManifolds();
  threads.run([&](int thread) {
    const auto [first, last] = threads.partOf(pairs_.size(), thread);
    for (std::size_t i = first; i < last; ++i)
      if (pairs_[i].isNear) updatePair(pairs_[i], poses, state, timeStep, scratch_[static_cast<std::size_t>(thread)]);
  });
  active_.clear();
  for (const NearPair& pair : pairs_)
    if (pair.isNear && !pair.isEmpty) active_.push_back(pair.manifold);
}

/// Room for the manifolds of pairs that have come near.
void PileContacts::giveManifolds() {
  for (NearPair& pair : pairs_) {
    if (!pair.isNear || pair.manifold >= 0) continue;
    if (free_.empty()) {
      free_.push_back(static_cast<std::int32_t>(manifolds_.size()));
      manifolds_.emplace_back();
      anchors_.emplace_back();
    }
    pair.manifold = free_.back();
    free_.pop_back();
    ContactManifold& manifold = manifolds_[static_cast<std::size_t>(pair.manifold)];
    manifold.bodyA = pair.bodyA, manifold.bodyB = pair.bodyB;
    manifold.law = geometry_.pairs[pair.pair].law;
  }
}

void PileContacts::updatePair(NearPair& pair, const std::vector<MovingPose>& poses, const VectorX& state,
                              double timeStep, std::vector<Contact>& scratch) {
  const MovingPose &poseA = poseOf(poses, pair.bodyA), &poseB = poseOf(poses, pair.bodyB);
  ContactManifold& manifold = manifolds_[static_cast<std::size_t>(pair.manifold)];
  Anchors& anchors = anchors_[static_cast<std::size_t>(pair.manifold)];
  if (pair.versionA == poseA.version && pair.versionB == poseB.version) {
    if (pair.isEmpty) return;
    follow(poseA, poseB, anchors, manifold.patch);
  } else {
    const double speed = (poseB.linearVelocity - poseA.linearVelocity).norm() +
                         poseA.radius * poseA.angularVelocity.norm() + poseB.radius * poseB.angularVelocity.norm();
    const ContactPatch patch = isFast(pair) ? patchOf(pair, poseA, poseB, timeStep)
                                            : patchOfAnyShapes(pair, state, kContactMargin + timeStep * speed, scratch);
    const bool wasEmpty = pair.isEmpty;
    pair.versionA = poseA.version, pair.versionB = poseB.version;
    pair.isEmpty = patch.count == 0;
    if (pair.isEmpty) return;
    renew(patch, poseA, poseB, wasEmpty, manifold, anchors);
  }
  const ContactPatch::Point& point = manifold.patch.points[0];
  const Vec3 sliding = poseB.linearVelocity - poseA.linearVelocity +
                       poseB.angularVelocity.cross(point.onB - poseB.position) -
                       poseA.angularVelocity.cross(point.onA - poseA.position);
  const double approach = -manifold.patch.normal.dot(sliding);
  const double across2 = sliding.squaredNorm() - approach * approach;
  const auto& impulses = manifold.impulses;
  pair.approach = std::all_of(impulses.begin(), impulses.end(), [](double p) { return p == 0; }) ? approach : 0;
  manifold.friction =
      across2 < kSlowSliding * kSlowSliding ? manifold.law.staticFriction : manifold.law.dynamicFriction;
}

/// Where a manifold's points are after a small motion.
void PileContacts::follow(const MovingPose& poseA, const MovingPose& poseB, const Anchors& anchors,
                          ContactPatch& patch) const {
  patch.normal = poseA.rotation * anchors.normal;
  for (std::size_t i = 0; i < patch.count; ++i) {
    ContactPatch::Point& point = patch.points[i];
    point.onA = poseA.position + poseA.rotation * anchors.onA[i];
    point.onB = poseB.position + poseB.rotation * anchors.onB[i];
    point.separation = patch.normal.dot(point.onB - point.onA);
  }
}

/// Takes a new patch; points that were there before keep their impulses.
void PileContacts::renew(const ContactPatch& patch, const MovingPose& poseA, const MovingPose& poseB, bool wasEmpty,
                         ContactManifold& manifold, Anchors& anchors) const {
  const bool goesOn = !wasEmpty && manifold.patch.normal.dot(patch.normal) > kSameNormal;
  const std::array<double, ContactPatch::kMostPoints> before = manifold.impulses;
  const Anchors old = anchors;
  const double near = kSamePoint * poseA.radius;
  manifold.impulses.fill(0);
  if (!goesOn) manifold.frictionImpulse.setZero(), manifold.twistImpulse = 0;
  anchors.normal = poseA.rotation.transpose() * patch.normal;
  for (std::size_t i = 0; i < patch.count; ++i) {
    anchors.onA[i] = poseA.rotation.transpose() * (patch.points[i].onA - poseA.position);
    anchors.onB[i] = poseB.rotation.transpose() * (patch.points[i].onB - poseB.position);
    for (std::size_t k = 0; goesOn && k < manifold.patch.count; ++k)
      if (patch.count == 1 && manifold.patch.count == 1)
        manifold.impulses[0] = before[0];
      else if ((anchors.onA[i] - old.onA[k]).squaredNorm() < near * near)
        manifold.impulses[i] = before[k];
  }
  manifold.patch = patch;
}

ContactPatch PileContacts::patchOf(const NearPair& pair, const MovingPose& poseA, const MovingPose& poseB,
                                   double timeStep) const {
  const auto ballAt = [&](const Collider& ball, const MovingPose& pose) {
    return PosedBall{pose.position + pose.rotation * ball.points[0], ball.radius};
  };
  const auto boxAt = [](const BoxShape& box, const MovingPose& pose) {
    return PosedBox{pose.position + pose.rotation * box.center, pose.rotation * box.axes, box.halfSize};
  };
  const Vec3 motion = timeStep * (poseB.linearVelocity - poseA.linearVelocity);
  const auto spinOf = [&](bool isBox, const MovingPose& pose) {
    return isBox ? timeStep * pose.radius * pose.angularVelocity.norm() : 0;
  };
  const Collider& a = geometry_.colliders[pair.shapeA];
  const auto& boxA = boxes_[pair.shapeA];
  const double marginA = kContactMargin + spinOf(boxA.has_value(), poseA);
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry_.planes[pair.shapeB];
    return boxA ? contactOfBoxAndPlane(boxAt(*boxA, poseA), plane, motion, marginA)
                : contactOfBallAndPlane(ballAt(a, poseA), plane, motion, marginA);
  }
  const Collider& b = geometry_.colliders[pair.shapeB];
  const auto& boxB = boxes_[pair.shapeB];
  const double margin = marginA + spinOf(boxB.has_value(), poseB);
  if (boxA && boxB) return contactOfBoxes(boxAt(*boxA, poseA), boxAt(*boxB, poseB), motion, margin);
  if (boxB) return contactOfBallAndBox(ballAt(a, poseA), boxAt(*boxB, poseB), motion, margin);
  if (boxA) return exchanged(contactOfBallAndBox(ballAt(b, poseB), boxAt(*boxA, poseA), -motion, margin));
  return contactOfBalls(ballAt(a, poseA), ballAt(b, poseB), motion, margin);
}

bool PileContacts::isFast(const NearPair& pair) const {
  return isFast_[pair.shapeA] && (pair.againstPlane || isFast_[pair.shapeB]);
}

/// Through the general search. One patch: of contacts with several normals those along the deepest one's.
ContactPatch PileContacts::patchOfAnyShapes(const NearPair& pair, const VectorX& state, double reach,
                                            std::vector<Contact>& scratch) const {
  scratch.clear();
  appendContacts(geometry_, pair.pair, state, reach, scratch);
  ContactPatch patch;
  if (scratch.empty()) return patch;
  const auto deepest = std::min_element(scratch.begin(), scratch.end(),
                                        [](const Contact& a, const Contact& b) { return a.separation < b.separation; });
  patch.normal = deepest->normal;
  constexpr std::size_t kMostCandidates = 16;
  ContactPatch::Point points[kMostCandidates];
  std::size_t count = 0;
  for (const Contact& contact : scratch) {
    if (contact.normal.dot(patch.normal) < kSameNormal || count == kMostCandidates) continue;
    const Vec3 half = contact.separation / 2 * contact.normal;
    points[count++] = {contact.point - half, contact.point + half, contact.separation};
  }
  appendSpanning(points, count, patch);
  return pair.isExchanged ? exchanged(patch) : patch;
}

std::vector<PileContacts::Meeting> PileContacts::meetings(double slowest) const {
  std::vector<Meeting> found;
  for (const NearPair& pair : pairs_)
    if (pair.isNear && !pair.isEmpty && pair.approach > slowest)
      found.push_back({geometry_.pairs[pair.pair], pair.manifold, pair.isExchanged});
  return found;
}

const std::vector<int>& PileContacts::islands(const std::vector<MovingPose>& poses) {
  islands_.resize(poses.size());
  std::iota(islands_.begin(), islands_.end(), 0);
  const auto root = [&](int body) {
    while (islands_[static_cast<std::size_t>(body)] != body) {
      int& parent = islands_[static_cast<std::size_t>(body)];
      parent = islands_[static_cast<std::size_t>(parent)];
      body = parent;
    }
    return body;
  };
  for (const std::int32_t index : active_) {
    const ContactManifold& manifold = manifolds_[static_cast<std::size_t>(index)];
    if (manifold.bodyB == kFixed || poseOf(poses, manifold.bodyA).isAsleep || poseOf(poses, manifold.bodyB).isAsleep)
      continue;
    const int a = root(manifold.bodyA), b = root(manifold.bodyB);
    islands_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  for (std::size_t body = 0; body < islands_.size(); ++body) islands_[body] = root(static_cast<int>(body));
  return islands_;
}

}  // namespace cradle
