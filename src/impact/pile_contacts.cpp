#include "impact/pile_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace cradle {
constexpr double kMargin = 5e-3;
namespace {

constexpr double kMarginX = 5e-3;            // m: contacts are known before bodies touch
constexpr double kSamePoint = 0.1;          // of the smaller body's radius: points this near are one from step to step
constexpr double kSameNormal = 0.9;         // cosine, at least, for impulses to go on
constexpr double kRoundSide = 1e-12;        // of a side: rounding of a box's corners

auto orderOf(const ColliderPair& pair) {
  return std::tuple(!pair.againstPlane, pair.a, pair.b);
}

}  // namespace

PileContacts::PileContacts(const ContactGeometry& geometry) : geometry_(geometry) {
  for (const Collider& collider : geometry.colliders) {
    std::optional<BoxShape> box;
    if (collider.polytope && collider.polytope->vertices.size() == 8 && collider.polytope->faces.size() == 6) {
      const auto& v = collider.polytope->vertices;
      BoxShape shape;
      const Vec3 sides[3] = {v[1] - v[0], v[2] - v[0], v[4] - v[0]};
      for (int k = 0; k < 3; ++k) {
        shape.halfSize[k] = sides[k].norm() / 2;
        shape.axes.col(k) = sides[k].normalized();
      }
      shape.center = (v[0] + v[7]) / 2;
      const Vec3 last = v[0] + sides[0] + sides[1] + sides[2];
      if ((shape.axes.transpose() * shape.axes - Mat3::Identity()).norm() < kRoundSide * 1e3 &&
          (last - v[7]).norm() < kRoundSide * 1e3)
        box = shape;
    }
    boxes_.push_back(box);
  }
}

void PileContacts::takePairs() {
  std::vector<PairState> states(geometry_.pairs.size());
  std::size_t old = 0;
  const auto release = [&](const PairState& state) {
    if (state.manifold >= 0) free_.push_back(state.manifold);
  };
  for (std::size_t i = 0; i < geometry_.pairs.size(); ++i) {
    while (old < pairs_.size() && orderOf(pairs_[old]) < orderOf(geometry_.pairs[i])) release(pairStates_[old++]);
    if (old < pairs_.size() && orderOf(pairs_[old]) == orderOf(geometry_.pairs[i])) states[i] = pairStates_[old++];
  }
  while (old < pairs_.size()) release(pairStates_[old++]);
  pairs_ = geometry_.pairs;
  pairStates_.swap(states);
}

bool PileContacts::isNear(const ColliderPair& pair, const std::vector<MovingPose>& poses, double timeStep) const {
  const Collider& a = geometry_.colliders[pair.a];
  const int bodyB = bodyBOf(geometry_, pair);
  if (a.body == kFixed || bodyB == kFixed) {
    const MovingPose& pose = poses[static_cast<std::size_t>(a.body == kFixed ? bodyB : a.body)];
    if (pose.isAsleep) return false;
    if (!pair.againstPlane) return true;
    const PlaneCollider& plane = geometry_.planes[pair.b];
    const double speed = pose.linearVelocity.norm() + pose.angularVelocity.norm() * pose.radius;
    return plane.normal.dot(pose.position - plane.point) < pose.radius + kMargin + speed * timeStep;
  }
  const MovingPose &poseA = poses[static_cast<std::size_t>(a.body)], &poseB = poses[static_cast<std::size_t>(bodyB)];
  if (poseA.isAsleep && poseB.isAsleep) return false;
  const double reach = poseA.radius + poseB.radius + kMargin +
                       (poseB.linearVelocity - poseA.linearVelocity).norm() * timeStep;
  return (poseB.position - poseA.position).squaredNorm() < reach * reach;
}

void PileContacts::update(const std::vector<MovingPose>& poses, const VectorX& state, double timeStep,
                          WorkerThreads& threads) {
  threads.run([&](int thread) {
    const auto [first, last] = threads.partOf(pairs_.size(), thread);
    for (std::size_t i = first; i < last; ++i) pairStates_[i].isNear = isNear(pairs_[i], poses, timeStep);
  });
  static const double um = getenv("UM") ? atof(getenv("UM")) : 0.5;
  shocks_.assign(poses.size(), 0);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (!pairStates_[i].isNear) continue;
    const int a = geometry_.colliders[pairs_[i].a].body, b = bodyBOf(geometry_, pairs_[i]);
    Vec3 velocity = Vec3::Zero();
    if (a != kFixed) velocity -= poses[static_cast<std::size_t>(a)].linearVelocity;
    if (b != kFixed) velocity += poses[static_cast<std::size_t>(b)].linearVelocity;
    const double shock = um * timeStep * velocity.norm();
    if (a != kFixed) shocks_[static_cast<std::size_t>(a)] = std::max(shocks_[static_cast<std::size_t>(a)], shock);
    if (b != kFixed) shocks_[static_cast<std::size_t>(b)] = std::max(shocks_[static_cast<std::size_t>(b)], shock);
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    PairState& pairState = pairStates_[i];
    if (!pairState.isNear || pairState.manifold >= 0) continue;
    if (free_.empty()) {
      free_.push_back(static_cast<std::int32_t>(manifolds_.size()));
      manifolds_.emplace_back();
      origins_.emplace_back();
    }
    pairState.manifold = free_.back();
    free_.pop_back();
    const std::size_t slot = static_cast<std::size_t>(pairState.manifold);
    manifolds_[slot] = {};
    origins_[slot] = {};
    ContactManifold& manifold = manifolds_[slot];
    manifold.bodyA = geometry_.colliders[pairs_[i].a].body;
    manifold.bodyB = bodyBOf(geometry_, pairs_[i]);
    if (manifold.bodyA == kFixed) std::swap(manifold.bodyA, manifold.bodyB);
    manifold.law = pairs_[i].law;
  }
  threads.run([&](int thread) {
    const auto [first, last] = threads.partOf(pairs_.size(), thread);
    for (std::size_t i = first; i < last; ++i)
      if (pairStates_[i].isNear) updatePair(i, poses, state, timeStep);
  });
  active_.clear();
  for (PairState& pairState : pairStates_) {
    if (!pairState.isNear) continue;
    if (manifolds_[static_cast<std::size_t>(pairState.manifold)].patch.count > 0)
      active_.push_back(pairState.manifold);
  }
}

namespace {

/// One surface in the world: a ball, a box or a plane.
struct BallAt {
  Vec3 center;
  double radius;
};

ContactPatch single(const Vec3& normal, const Vec3& onA, const Vec3& onB) {
  ContactPatch patch;
  patch.normal = normal;
  patch.count = 1;
  patch.points[0] = {onA, onB, normal.dot(onB - onA)};
  return patch;
}

/// Balls: the normal is that of the instant at which they meet.
ContactPatch contactOfBalls(const BallAt& a, const BallAt& b, const Vec3& motion, double margin) {
  const Vec3 offset = b.center - a.center;
  const double reach = a.radius + b.radius, distance2 = offset.squaredNorm();
  Vec3 direction = offset;
  if (distance2 > (reach + margin) * (reach + margin)) {
    // |offset + part motion| = reach
    const double along = offset.dot(motion), speed2 = motion.squaredNorm();
    const double root = along * along - speed2 * (distance2 - reach * reach);
    if (along >= 0 || root < 0) return {};
    const double part = (distance2 - reach * reach) / (std::sqrt(root) - along);
    if (part > 1) return {};
    direction = offset + part * motion;
  }
  const double length = direction.norm();
  const Vec3 normal = length > 0 ? Vec3(direction / length) : Vec3(Vec3::UnitY());
  return single(normal, a.center + a.radius * normal, b.center - b.radius * normal);
}

ContactPatch contactOfBallOnPlane(const BallAt& a, const PlaneCollider& plane, const Vec3& motion, double margin) {
  const double height = plane.normal.dot(a.center - plane.point);
  if (height - a.radius + std::min(0.0, -plane.normal.dot(motion)) > margin) return {};
  return single(-plane.normal, a.center - a.radius * plane.normal, a.center - height * plane.normal);
}

/// Nearest point of a box's surface to `center`, with the normal out of it there.
ContactPatch contactOfBallOnBox(const BallAt& ball, const PosedBox& box, const Vec3& motion, double margin) {
  const auto nearest = [&](const Vec3& center, Vec3& normal, Vec3& onBox) {
    const Vec3 local = box.axes.transpose() * (center - box.center);
    const Vec3 clamped = local.cwiseMin(box.halfSize).cwiseMax(-box.halfSize);
    const double distance = (local - clamped).norm();
    if (distance > 0) {
      normal = box.axes * ((local - clamped) / distance);
      onBox = box.center + box.axes * clamped;
      return distance;
    }
    int axis = 0;
    const Vec3 depths = box.halfSize - local.cwiseAbs();
    depths.minCoeff(&axis);
    const double sign = local[axis] < 0 ? -1 : 1;
    normal = sign * box.axes.col(axis);
    onBox = center + depths[axis] * normal;
    return -depths[axis];
  };
  Vec3 normal, onBox;
  double gap = nearest(ball.center, normal, onBox) - ball.radius;
  const double closing = normal.dot(motion);  // of the box as seen from the ball
  if (gap - std::max(0.0, motion.norm()) > margin) return {};
  if (gap > 1e-3 && closing > 0) {
    const double part = std::min(1.0, gap / closing);
    gap = nearest(ball.center - part * motion, normal, onBox) - ball.radius;
    onBox += part * motion;
    onBox -= part * motion;
    if (gap > margin && part == 1.0) return {};
    // The box's point where it is now.
  } else if (gap > margin) {
    return {};
  }
  return single(-normal, ball.center - ball.radius * normal, onBox);
}

ContactPatch contactOfBoxOnPlane(const PosedBox& box, const PlaneCollider& plane, double reach) {
  ContactPatch::Point points[8];
  std::size_t count = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Vec3 at = box.center + box.axes * signs.cwiseProduct(box.halfSize);
    const double height = plane.normal.dot(at - plane.point);
    if (height <= reach) points[count++] = {at, at - height * plane.normal, height};
  }
  ContactPatch patch;
  patch.normal = -plane.normal;
  appendSpanning(points, count, patch);
  return patch;
}

ContactPatch mirrored(ContactPatch patch) {
  patch.normal = -patch.normal;
  for (ContactPatch::Point& point : patch.points) std::swap(point.onA, point.onB);
  return patch;
}

}  // namespace

void PileContacts::updatePair(std::size_t index, const std::vector<MovingPose>& poses, const VectorX&,
                              double timeStep) {
  const ColliderPair& pair = pairs_[index];
  const std::size_t slot = static_cast<std::size_t>(pairStates_[index].manifold);
  ContactManifold& manifold = manifolds_[slot];
  Origin& origin = origins_[slot];
  const MovingPose still{Vec3::Zero(), Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), 0, 0, false};
  const MovingPose& poseA = poses[static_cast<std::size_t>(manifold.bodyA)];
  const MovingPose& poseB = manifold.bodyB == kFixed ? still : poses[static_cast<std::size_t>(manifold.bodyB)];
  const Vec3 motion = (poseB.linearVelocity - poseA.linearVelocity) * timeStep;

  const double kMargin = cradle::kMargin + shocks_[static_cast<std::size_t>(manifold.bodyA)] +
                         (manifold.bodyB == kFixed ? 0 : shocks_[static_cast<std::size_t>(manifold.bodyB)]);
  // Only just moved: the same points, where they are now.
  if (origin.versionA == poseA.version && origin.versionB == poseB.version) {
    ContactPatch& patch = manifold.patch;
    patch.normal = poseA.rotation * origin.localNormal;
    for (std::size_t i = 0; i < patch.count; ++i) {
      ContactPatch::Point& point = patch.points[i];
      point.onA = poseA.position + poseA.rotation * origin.localA[i];
      point.onB = poseB.position + poseB.rotation * origin.localB[i];
      point.separation = patch.normal.dot(point.onB - point.onA);
    }
    return;
  }

  const bool flipped = geometry_.colliders[pair.a].body == kFixed;
  const std::size_t colliderA = flipped ? pair.b : pair.a, colliderB = flipped ? pair.a : pair.b;
  const Collider& a = geometry_.colliders[colliderA];
  const auto posedBox = [&](const BoxShape& box, const MovingPose& pose) {
    return PosedBox{pose.position + pose.rotation * box.center, pose.rotation * box.axes, box.halfSize};
  };
  const auto posedBall = [&](const Collider& ball, const MovingPose& pose) {
    return BallAt{pose.position + pose.rotation * ball.points[0], ball.radius};
  };
  const ContactManifold before = manifold;
  ContactPatch& patch = manifold.patch;
  const auto& boxA = boxes_[colliderA];
  const double spinA = boxA ? poseA.angularVelocity.norm() * poseA.radius * timeStep : 0;
  bool isKept = true;
  if (pair.againstPlane) {
    const PlaneCollider& plane = geometry_.planes[pair.b];
    if (boxA) {
      patch = contactOfBoxOnPlane(posedBox(*boxA, poseA), plane,
                                  kMargin + spinA + std::max(0.0, plane.normal.dot(motion)));
    } else {
      patch = contactOfBallOnPlane(posedBall(a, poseA), plane, motion, kMargin);
      isKept = false;
    }
  } else {
    const auto& boxB = boxes_[colliderB];
    const Collider& b = geometry_.colliders[colliderB];
    const double spinB = boxB ? poseB.angularVelocity.norm() * poseB.radius * timeStep : 0;
    if (boxA && boxB) {
      patch = contactOfBoxes(posedBox(*boxA, poseA), posedBox(*boxB, poseB), motion, kMargin + spinA + spinB);
    } else if (boxB) {
      patch = contactOfBallOnBox(posedBall(a, poseA), posedBox(*boxB, poseB), motion, kMargin + spinB);
    } else if (boxA) {
      patch = mirrored(contactOfBallOnBox(posedBall(b, poseB), posedBox(*boxA, poseA), -motion, kMargin + spinA));
    } else {
      patch = contactOfBalls(posedBall(a, poseA), posedBall(b, poseB), motion, kMargin);
      isKept = false;
    }
  }
  if (patch.count > 0) {
    if (before.patch.count > 0 && before.patch.normal.dot(patch.normal) > kSameNormal) {
      if (!isKept) {
        manifold.impulses = before.impulses, manifold.carried = before.carried;
      } else {
        manifold.impulses.fill(0), manifold.carried.fill(0);
        const double near = kSamePoint * poseA.radius;
        for (std::size_t i = 0; i < patch.count; ++i) {
          const Vec3 local = poseA.rotation.transpose() * (patch.points[i].onA - poseA.position);
          for (std::size_t j = 0; j < before.patch.count; ++j)
            if ((local - origin.localA[j]).squaredNorm() < near * near)
              manifold.impulses[i] = before.impulses[j], manifold.carried[i] = before.carried[j];
        }
      }
    } else {
      manifold.impulses.fill(0), manifold.carried.fill(0);
      manifold.frictionImpulse.setZero();
      manifold.twistImpulse = 0;
    }
  }
  if (!isKept) return;
  origin.versionA = poseA.version, origin.versionB = poseB.version;
  if (patch.count == 0) return;
  origin.localNormal = poseA.rotation.transpose() * patch.normal;
  for (std::size_t i = 0; i < patch.count; ++i) {
    origin.localA[i] = poseA.rotation.transpose() * (patch.points[i].onA - poseA.position);
    origin.localB[i] = poseB.rotation.transpose() * (patch.points[i].onB - poseB.position);
  }
}

}  // namespace cradle
