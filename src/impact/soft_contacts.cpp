#include "impact/soft_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "impact/lanes.h"
#include "impact/soft_parameters.h"

namespace cradle {
namespace {

constexpr std::size_t kPairGrain = 512;  // pairs that a thread takes at once: tens of microseconds
constexpr std::size_t kPairsAhead = 4;   // pairs: what they need is asked for in time, for it lies anywhere
constexpr std::size_t kNearGrain = 64;   // those among them that are near take longer

/// Pairs come from the broad phase in this order.
auto orderOf(std::size_t a, std::size_t b, bool againstPlane) {
  return std::tuple(!againstPlane, againstPlane ? b : a, againstPlane ? a : b);
}
auto orderOf(const SoftPair& pair) {
  return pair.isExchanged ? orderOf(pair.shapeB, pair.shapeA, pair.againstPlane)
                          : orderOf(pair.shapeA, pair.shapeB, pair.againstPlane);
}

Vec3 inWorld(const MovingPose& pose, const PersistentManifold::Anchor& anchor) {
  return pose.rotation * anchor.cast<double>();
}
PersistentManifold::Anchor inBody(const MovingPose& pose, const Vec3& vector) {
  return (pose.rotation.transpose() * vector).cast<float>();
}

}  // namespace

SoftContacts::SoftContacts(const ContactGeometry& geometry, const SoftScale& scale)
    : geometry_(geometry), scale_(scale), generator_(geometry, scale.length) {}

void SoftContacts::takePairs() {
  taken_.clear();
  std::size_t old = 0;
  const auto release = [&](const NearPair& pair) {
    if (pair.manifold >= 0) free_.push_back(pair.manifold);
  };
  for (std::size_t i = 0; i < geometry_.pairs.size(); ++i) {
    const ColliderPair& pair = geometry_.pairs[i];
    const auto order = orderOf(pair.a, pair.b, pair.againstPlane);
    while (old < pairs_.size() && orderOf(pairs_[old]) < order) release(pairs_[old++]);
    if (old < pairs_.size() && orderOf(pairs_[old]) == order) {
      taken_.push_back(pairs_[old++]);
      taken_.back().pair = static_cast<std::uint32_t>(i);
    } else {
      taken_.push_back({generator_.pairOf(i)});
    }
  }
  while (old < pairs_.size()) release(pairs_[old++]);
  pairs_.swap(taken_);
  bodies_.clear();
  for (const NearPair& pair : pairs_) bodies_.push_back({pair.bodyA, pair.bodyB});
  beginStep();
}

std::vector<SoftContacts::Record> SoftContacts::record(const std::vector<MovingPose>& poses) const {
  const auto turnedBy = [&poses](int body) {
    return body == kFixed ? 0 : poses[static_cast<std::size_t>(body)].turned;
  };
  std::vector<Record> records;
  for (const NearPair& pair : pairs_) {
    if (pair.isEmpty) continue;
    const ColliderPair& colliders = geometry_.pairs[pair.pair];
    records.push_back({colliders.a, colliders.b, colliders.againstPlane, pair.approach, pair.offset,
                       turnedBy(pair.bodyA) + turnedBy(pair.bodyB) - pair.turned,
                       manifolds_[static_cast<std::size_t>(pair.manifold)]});
  }
  return records;
}

void SoftContacts::goOnFrom(const std::vector<Record>& records) {
  auto next = pairs_.begin();  // both are in the order of pairs
  for (const Record& record : records) {
    const auto order = orderOf(record.a, record.b, record.isAgainstPlane);
    next = std::find_if(next, pairs_.end(), [&](const NearPair& pair) { return !(orderOf(pair) < order); });
    if (next == pairs_.end()) return;       // those behind have parted, too
    if (orderOf(*next) != order) continue;  // they have parted: the broad phase finds them near no more
    giveManifold(*next);
    PersistentManifold& manifold = manifolds_[static_cast<std::size_t>(next->manifold)];
    const ContactMaterial* material = manifold.material;
    manifold = record.manifold;
    manifold.bodyA = next->bodyA, manifold.bodyB = next->bodyB, manifold.material = material;
    next->isEmpty = false, next->approach = record.approach;
    next->offset = record.offset, next->turned = -record.turned;
  }
}

/// A lower bound (m) of how far a pair's surfaces are apart now.
double SoftContacts::clearanceOf(const NearPair& pair, const MovingPose& a, const MovingPose& b) {
  if (!pair.isEmpty) return -std::numeric_limits<double>::infinity();
  const double turned = (a.turned + b.turned - pair.turned) * std::max(a.spinRadius, b.spinRadius);
  return pair.clearance - (b.position - a.position - pair.offset).norm() - turned;
}

/// Whether the boxes around them, and the spheres around both if both move, are nearer to each other than `reach` (m).
bool SoftContacts::areNear(const NearPair& pair, const SoftStepStart& look, double reach) const {
  const MovingPose& a = look.poseOf(pair.bodyA);
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry_.planes[pair.shapeB];
    return plane.normal.dot(a.boxCenter - plane.point) - plane.normal.cwiseAbs().dot(a.boxHalf) < reach;
  }
  const auto meet = [&](const Vec3& center, const Vec3& half) {
    return ((center - a.boxCenter).cwiseAbs() - half - a.boxHalf).maxCoeff() < reach;
  };
  if (pair.bodyB == kFixed) {
    const Bounds& bounds = geometry_.colliders[pair.shapeB].bounds;
    return meet(bounds.center(), bounds.sizes() / 2);
  }
  const MovingPose& b = look.poseOf(pair.bodyB);
  const double most = a.radius + b.radius + reach;
  return (b.position - a.position).squaredNorm() < most * most && meet(b.boxCenter, b.boxHalf);
}

/// A bound on how far (m) points of a pair come nearer to each other in the step, and the margin.
double SoftContacts::reachOf(const NearPair& pair, const SoftStepStart& look) {
  const MovingPose &a = look.poseOf(pair.bodyA), &b = look.poseOf(pair.bodyB);
  const double speed = (b.linearVelocity - a.linearVelocity).norm() + a.spinSpeed + b.spinSpeed;
  return look.margin + speed * look.timeStep;
}

/// What most pairs are: too far from each other along some axis. Without a root.
bool SoftContacts::areFar(const NearPair& pair, const SoftStepStart& look) {
  if (pair.bodyB == kFixed) return false;
  const MovingPose &a = look.poseOf(pair.bodyA), &b = look.poseOf(pair.bodyB);
  const double speed = (b.linearVelocity - a.linearVelocity).lpNorm<1>() + a.spinSpeed + b.spinSpeed;
  const double reach = look.margin + speed * look.timeStep;
  return ((b.boxCenter - a.boxCenter).cwiseAbs() - b.boxHalf - a.boxHalf).maxCoeff() >= reach;
}

/// How fast bodies approach each other, at most; 0 if they do not come near within the step.
double SoftContacts::approachOf(const NearPair& pair, const SoftStepStart& look) const {
  const MovingPose &a = look.poseOf(pair.bodyA), &b = look.poseOf(pair.bodyB);
  if (a.isAsleep && (pair.bodyB == kFixed || b.isAsleep)) return 0;
  using Soft = SoftParameters;
  const bool areSpheres = a.spinRadius == 0 && (pair.againstPlane || b.spinRadius == 0);
  const double pressed = scale_.speed() * Soft::kPressed;
  const auto counted = [&](double speed) {
    return areSpheres ? Soft::kBallRatio * speed
                      : std::min(speed, pressed) + Soft::kQuickRatio * std::max(0.0, speed - pressed);
  };
  const double spin = Soft::kSpinRatio * (a.spinSpeed + b.spinSpeed);
  const Vec3 velocity = b.linearVelocity - a.linearVelocity;
  if (areFar(pair, look) || !areNear(pair, look, reachOf(pair, look))) return 0;
  if (pair.againstPlane) return counted(std::max(0.0, geometry_.planes[pair.shapeB].normal.dot(velocity))) + spin;
  if (pair.bodyB == kFixed) return counted(velocity.norm()) + spin;
  const Vec3 offset = b.position - a.position;
  const double distance = offset.norm();
  return distance > 0 ? counted(std::max(0.0, -offset.dot(velocity) / distance)) + spin : 0;
}

double SoftContacts::fastestApproach(const SoftStepStart& look, WorkerThreads& threads) const {
  std::vector<double> fastest(static_cast<std::size_t>(threads.count()), 0);
  threads.share(pairs_.size(), kPairGrain, [&](int thread, std::size_t first, std::size_t last) {
    double& most = fastest[static_cast<std::size_t>(thread)];
    for (std::size_t i = first; i < last; ++i) most = std::max(most, approachOf(pairs_[i], look));
  });
  return *std::max_element(fastest.begin(), fastest.end());
}

bool SoftContacts::mayTouch(const NearPair& pair, const SoftStepStart& look) const {
  const MovingPose &a = look.poseOf(pair.bodyA), &b = look.poseOf(pair.bodyB);
  if (a.isAsleep && (pair.bodyB == kFixed || b.isAsleep)) return false;
  if (!pair.isEmpty) return true;
  if (areFar(pair, look)) return false;
  const double reach = reachOf(pair, look);
  return clearanceOf(pair, a, b) <= reach && areNear(pair, look, reach);
}

void SoftContacts::update(const SoftStepStart& look, WorkerThreads& threads) {
  scratch_.resize(static_cast<std::size_t>(threads.count()));
  findNear(look, threads);
  giveManifolds();
  threads.share(near_.size(), kNearGrain, [&](int thread, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      if (i + kPairsAhead < last) {
        fetchAhead<true>(manifolds_[static_cast<std::size_t>(active_[i + kPairsAhead].manifold)]);
        fetchAhead<true>(pairs_[near_[i + kPairsAhead]]);
        fetchAhead<false>(look.poseOf(active_[i + kPairsAhead].bodyB));
      }
      updatePair(pairs_[near_[i]], look, scratch_[static_cast<std::size_t>(thread)]);
      const NearPair& pair = pairs_[near_[i]];
      active_[i].count = pair.isEmpty ? 0 : manifolds_[static_cast<std::size_t>(pair.manifold)].count;
    }
  });
  std::erase_if(active_, [](const ManifoldLink& link) { return link.count == 0; });
}

/// Most pairs cannot come near within the step: looked at once, and when one of the bodies is deflected.
bool SoftContacts::isInReach(std::size_t index, const SoftStepStart& look) {
  const auto [a, b] = bodies_[index];
  if (!inReach_[index] && (b == kFixed || sweptBounds_.areRenewed(a, b)))
    inReach_[index] = b == kFixed || !pairs_[index].isEmpty || sweptBounds_.mayMeet(a, b, look);
  return inReach_[index];
}

/// Each part of the pairs lists its own in place; put together they are in the order of pairs.
void SoftContacts::findNear(const SoftStepStart& look, WorkerThreads& threads) {
  const bool isOnlyLook = sweptBounds_.areForgotten() && look.timeLeft == look.timeStep;
  if (!isOnlyLook) sweptBounds_.renew(look, threads);
  near_.resize(pairs_.size());
  nearOfPart_.assign(pairs_.size() / kPairGrain + 1, 0);
  threads.share(pairs_.size(), kPairGrain, [&](int, std::size_t first, std::size_t last) {
    std::size_t inReach = 0, count = 0;
    for (std::size_t i = first; i < last; ++i)
      if (isOnlyLook || isInReach(i, look)) near_[first + inReach++] = i;
    for (std::size_t i = first; i < first + inReach; ++i) {
      if (i + kPairsAhead < first + inReach) fetchAhead<false>(pairs_[near_[i + kPairsAhead]]);
      if (mayTouch(pairs_[near_[i]], look)) near_[first + count++] = near_[i];
    }
    nearOfPart_[first / kPairGrain] = count;
  });
  std::size_t count = 0;
  for (std::size_t part = 0; part < nearOfPart_.size(); ++part)
    for (std::size_t i = 0; i < nearOfPart_[part]; ++i) near_[count++] = near_[part * kPairGrain + i];
  near_.resize(count);
}

/// Room for the manifolds of pairs that have come near.
void SoftContacts::giveManifolds() {
  active_.clear();
  for (const std::size_t index : near_) {
    NearPair& pair = pairs_[index];
    if (pair.manifold < 0) giveManifold(pair);
    active_.push_back({pair.manifold, pair.bodyA, pair.bodyB, 0});
  }
}

void SoftContacts::giveManifold(NearPair& pair) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::int32_t>(manifolds_.size()));
    manifolds_.emplace_back();
  }
  pair.manifold = free_.back();
  free_.pop_back();
  PersistentManifold& manifold = manifolds_[static_cast<std::size_t>(pair.manifold)];
  manifold.bodyA = pair.bodyA, manifold.bodyB = pair.bodyB;
  const int surfaceB =
      pair.againstPlane ? geometry_.planes[pair.shapeB].surface : geometry_.colliders[pair.shapeB].surface;
  manifold.material = &geometry_.materials[static_cast<std::size_t>(geometry_.colliders[pair.shapeA].surface)]
                                          [static_cast<std::size_t>(surfaceB)];
}

void SoftContacts::updatePair(NearPair& pair, const SoftStepStart& look, std::vector<Contact>& scratch) {
  const MovingPose &poseA = look.poseOf(pair.bodyA), &poseB = look.poseOf(pair.bodyB);
  PersistentManifold& manifold = manifolds_[static_cast<std::size_t>(pair.manifold)];
  const Vec3 offset = poseB.position - poseA.position;
  const double turned = poseA.turned + poseB.turned;
  const double keptMotion = scale_.length * SoftParameters::kKeptMotion;
  const double slowSliding = scale_.speed() * SoftParameters::kSlowSliding;
  if (!pair.isEmpty && (offset - pair.offset).squaredNorm() <= keptMotion * keptMotion &&
      turned - pair.turned <= SoftParameters::kKeptTurn) {
    follow(pair, poseA, poseB, manifold);
  } else {
    const PredictedManifold found = generator_.manifoldOf(pair, look, scratch);
    const bool wasEmpty = pair.isEmpty;
    pair.isEmpty = found.count == 0;
    pair.offset = offset, pair.turned = turned, pair.clearance = found.clearance;
    if (pair.isEmpty) return;
    renew(found, poseA, poseB, wasEmpty, manifold);
  }
  const Vec3 sliding = poseB.linearVelocity - poseA.linearVelocity +
                       poseB.angularVelocity.cross(inWorld(poseB, manifold.onB[0])) -
                       poseA.angularVelocity.cross(inWorld(poseA, manifold.onA[0]));
  const double approach = -manifold.normal.dot(sliding);
  const double across2 = sliding.squaredNorm() - approach * approach;
  const bool isPressed = std::any_of(manifold.forces.begin(), manifold.forces.end(), [](double f) { return f != 0; });
  pair.approach = isPressed ? 0 : static_cast<float>(approach);
  manifold.friction =
      across2 < slowSliding * slowSliding ? manifold.material->staticFriction : manifold.material->dynamicFriction;
}

/// How far a manifold's points are apart after a small motion. What is fixed keeps its normal.
void SoftContacts::follow(const NearPair& pair, const MovingPose& poseA, const MovingPose& poseB,
                          PersistentManifold& manifold) {
  const bool isFixed = manifold.bodyB == kFixed;
  if (!isFixed) manifold.normal = inWorld(poseA, manifold.normalOnA);
  const Vec3 offset = poseB.position - poseA.position - (isFixed ? pair.offset : Vec3(Vec3::Zero()));
  const Vec3 normalOnA = poseA.rotation.transpose() * manifold.normal;
  const Vec3 normalOnB = poseB.rotation.transpose() * manifold.normal;
  const double apart = manifold.normal.dot(offset);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i)
    manifold.separations[i] =
        apart + normalOnB.dot(manifold.onB[i].cast<double>()) - normalOnA.dot(manifold.onA[i].cast<double>());
}

/// Takes a new manifold; points that were there before keep their forces.
void SoftContacts::renew(const PredictedManifold& found, const MovingPose& poseA, const MovingPose& poseB,
                         bool wasEmpty, PersistentManifold& manifold) {
  const bool goesOn = !wasEmpty && manifold.normal.dot(found.normal) > SoftParameters::kKeptNormal;
  const auto forces = manifold.forces;
  const auto onA = manifold.onA;
  const std::size_t count = static_cast<std::size_t>(manifold.count);
  constexpr double keptPoint = SoftParameters::kKeptPoint;
  const float near2 = static_cast<float>(keptPoint * keptPoint * poseA.radius * poseA.radius);
  const Vec3& from = manifold.bodyB == kFixed ? poseA.position : poseB.position;
  manifold.forces.fill(0);
  if (!goesOn) manifold.frictionForce.setZero(), manifold.twist = 0;
  manifold.normal = found.normal, manifold.normalOnA = inBody(poseA, found.normal);
  manifold.count = static_cast<std::int32_t>(found.count);
  for (std::size_t i = 0; i < found.count; ++i) {
    manifold.onA[i] = inBody(poseA, found.points[i].onA - poseA.position);
    manifold.onB[i] = inBody(poseB, found.points[i].onB - from);
    manifold.separations[i] = found.points[i].separation;
    for (std::size_t k = 0; goesOn && k < count; ++k)
      if (found.count == 1 && count == 1)
        manifold.forces[0] = forces[0];
      else if ((manifold.onA[i] - onA[k]).squaredNorm() < near2)
        manifold.forces[i] = forces[k];
  }
}

std::vector<SoftContacts::Meeting> SoftContacts::meetings(double slowest) const {
  std::vector<Meeting> found;
  for (const std::size_t index : near_) {
    const NearPair& pair = pairs_[index];
    if (!pair.isEmpty && pair.approach > slowest)
      found.push_back({geometry_.pairs[pair.pair], pair.manifold, pair.isExchanged});
  }
  return found;
}

}  // namespace cradle
