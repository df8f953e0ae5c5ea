#include "impact/pile_step.h"

#include <algorithm>
#include <cmath>

#include "math/principal_axes.h"

namespace cradle {
namespace {

constexpr double kMostApproach = 3e-3;  // m: bodies that come nearer to each other in a step are looked at more often
constexpr int kMostPieces = 32;         // looks a step
constexpr int kSubSteps = 4;            // a step, at least: fewer do not bring boxes to rest
constexpr double kKeptMotion = 5e-4;    // m: half of what two bodies may move against each other with one manifold
constexpr double kKeptTurn = 5e-3;      // rad
constexpr double kCalmTime = 0.5;       // s: slow for so long is at rest

/// Turns by a small rotation vector: q + 1/2 (0, r) q, made of unit length, turns by 2 atan(|r| / 2).
Quat turned(const Quat& worldFromBody, const Vec3& rotation) {
  const Quat half(0, rotation.x() / 2, rotation.y() / 2, rotation.z() / 2);
  Quat sum = half * worldFromBody;
  sum.coeffs() += worldFromBody.coeffs();
  return sum.normalized();
}

BodyMotion motionOf(const Vec3& linear, const Vec3& angular) {
  return BodyMotion{Lanes{linear.x(), linear.y()}, Lanes{linear.z(), angular.x()}, Lanes{angular.y(), angular.z()}};
}
Vec3 linearOf(const BodyMotion& motion) {
  return {motion.xy[0], motion.xy[1], motion.zu[0]};
}
Vec3 angularOf(const BodyMotion& motion) {
  return {motion.zu[1], motion.vw[0], motion.vw[1]};
}

}  // namespace

PileStep::PileStep(const std::vector<RigidBody>& bodies, ContactGeometry& geometry, const Vec3& gravity, int threads)
    : bodies_(bodies), geometry_(geometry), gravity_(gravity), threads_(threads), contacts_(geometry_) {
  const std::size_t count = bodies.size();
  geometry_.pairs.clear();
  for (const RigidBody& body : bodies) {
    const PrincipalAxes principal = principalAxes(body.inertiaTensor);
    principalAxes_.push_back(body.isSpherical ? Mat3(Mat3::Identity()) : principal.axes);
    rootMoments_.push_back(principal.moments.cwiseSqrt());
  }
  poses_.resize(count);
  isBall_.assign(count, 0);
  for (const Collider& collider : geometry_.colliders)
    if (collider.body != kFixed) {
      poses_[static_cast<std::size_t>(collider.body)].radius = collider.boundingRadius;
      isBall_[static_cast<std::size_t>(collider.body)] = collider.isBall();
    }
  worldFromPrincipal_.assign(count, Mat3::Identity());
  solverBodies_.resize(count);
  motions_.resize(count);
  reaches_.assign(count, 0);
  markedPositions_.assign(count, Vec3::Constant(std::numeric_limits<double>::infinity()));
  markedOrientations_.assign(count, Quat::Identity());
  calmTimes_.assign(count, 0);
  sleepIslands_.assign(count, -1);
  awake_ = count;
}

void PileStep::advance(double timeStep, VectorX& state) {
  impacts_.clear(), fallenAsleep_.clear(), woken_.clear();
  if (allAsleep()) return;
  slowestRebound_ = timeStep * gravity_.norm();

  // How fast do bodies approach each other, and how often must they be looked at for that?
  placeBodies(timeStep, state);
  if (broadPhase_.update(state, reaches_, kContactMargin, geometry_)) contacts_.takePairs();
  const double approach = timeStep * contacts_.fastestApproach(poses_, timeStep, threads_);
  const int pieces = std::clamp(static_cast<int>(std::ceil(approach / kMostApproach)), 1, kMostPieces);
  const int subSteps = (kSubSteps + pieces - 1) / pieces;

  for (int piece = 0; piece < pieces; ++piece) {
    if (pieces > 1) placeBodies(timeStep / pieces, state);
    takePiece(timeStep / pieces, subSteps, state);
  }
  letSleep(timeStep, state);
}

/// A step with one look for contacts.
void PileStep::takePiece(double timeStep, int subSteps, VectorX& state) {
  if (broadPhase_.update(state, reaches_, kContactMargin, geometry_)) contacts_.takePairs();
  contacts_.update(poses_, state, timeStep, threads_);
  ++looks_;
  const ContactColors& colors = coloring_.color(contacts_.manifolds(), contacts_.active(), bodies_.size());
  const double subStep = timeStep / subSteps;
  solver_.prepare(colors, contacts_.manifolds(), solverBodies_, subStep, threads_);
  solver_.solve({subStep, subSteps, slowestRebound_}, gravity_, motions_, threads_);
  solver_.store(contacts_.manifolds(), threads_);
  recordImpacts(subSteps);
  wakeTouched();
  threads_.run([&](int thread) {
    const auto [first, last] = threads_.partOf(bodies_.size(), thread);
    for (std::size_t i = first; i < last; ++i) moveBody(i, timeStep, subStep, state);
  });
}

void PileStep::placeBodies(double timeStep, const VectorX& state) {
  threads_.run([&](int thread) {
    const auto [first, last] = threads_.partOf(bodies_.size(), thread);
    for (std::size_t i = first; i < last; ++i) {
      if (!poses_[i].isAsleep) placeBody(i, state);
      const MovingPose& pose = poses_[i];
      motions_.velocities[i] = motions_.starts[i];
      motions_.displacements[i] = {};
      reaches_[i] = pose.isAsleep ? 0
                                  : timeStep * (pose.linearVelocity.norm() + timeStep * gravity_.norm() +
                                                pose.radius * pose.angularVelocity.norm());
    }
  });
}

void PileStep::placeBody(std::size_t index, const VectorX& state) {
  const Eigen::Index body = static_cast<Eigen::Index>(index);
  MovingPose& pose = poses_[index];
  const Quat turn = orientation(state, body);
  pose.position = centerOfMass(state, body);
  pose.rotation = turn.toRotationMatrix();
  pose.linearVelocity = linearVelocity(state, body);
  pose.angularVelocity = angularVelocity(state, body);
  // |q - p|^2 = 2 (1 - q.p) is a quarter of the squared angle between two orientations, if that is small.
  const double cosine = std::abs(turn.dot(markedOrientations_[index]));
  if (!((pose.position - markedPositions_[index]).squaredNorm() <= kKeptMotion * kKeptMotion &&
        8 * (1 - cosine) <= kKeptTurn * kKeptTurn)) {
    markedPositions_[index] = pose.position, markedOrientations_[index] = turn;
    ++pose.version;
  }
  Mat3& axes = worldFromPrincipal_[index];
  if (!bodies_[index].isSpherical) axes = pose.rotation * principalAxes_[index];
  const Vec3& roots = rootMoments_[index];
  solverBodies_[index] = {pose.position, bodies_[index].inverseMass,
                          Mat3(roots.cwiseInverse().asDiagonal() * axes.transpose())};
  motions_.starts[index] = motionOf(pose.linearVelocity, roots.cwiseProduct(axes.transpose() * pose.angularVelocity));
}

void PileStep::moveBody(std::size_t index, double timeStep, double subStep, VectorX& state) {
  if (poses_[index].isAsleep) return;
  const Eigen::Index body = static_cast<Eigen::Index>(index);
  const BodyMotion &velocity = motions_.velocities[index], &displacement = motions_.displacements[index];
  const Vec3 inverseRoots = rootMoments_[index].cwiseInverse();
  const auto unscaled = [&](const Vec3& scaled) -> Vec3 {
    return worldFromPrincipal_[index] * inverseRoots.cwiseProduct(scaled);
  };
  centerOfMass(state, body) += linearOf(displacement);
  // Falling by sub-steps goes too far by g h/2 a unit of time: what touches nothing falls exactly.
  if (!coloring_.isTouched(index)) centerOfMass(state, body) -= timeStep * subStep / 2 * gravity_;
  linearVelocity(state, body) = linearOf(velocity);
  const Quat turn = turned(orientation(state, body), unscaled(angularOf(displacement)));
  setOrientation(state, body, turn);
  Vec3 spin = unscaled(angularOf(velocity));
  if (!bodies_[index].isSpherical && !spin.isZero()) {
    // Without torque the angular momentum stays, and the energy: the spin that belongs to both at the new orientation.
    const Mat3 axes = turn.toRotationMatrix() * principalAxes_[index];
    const Vec3 momentum = worldFromPrincipal_[index] * rootMoments_[index].cwiseProduct(angularOf(velocity));
    const Vec3 next = axes * inverseRoots.cwiseAbs2().cwiseProduct(axes.transpose() * momentum);
    spin = std::sqrt(momentum.dot(spin) / momentum.dot(next)) * next;
  }
  angularVelocity(state, body) = spin;
}

/// The impulse of the last sub-step stands for each: where bodies meet fast, a look has but one.
void PileStep::recordImpacts(int subSteps) {
  for (const PileContacts::Meeting& meeting : contacts_.meetings(slowestRebound_)) {
    const ContactManifold& manifold = contacts_.manifolds()[static_cast<std::size_t>(meeting.manifold)];
    double impulse = 0;
    for (std::size_t i = 0; i < manifold.patch.count; ++i) impulse += subSteps * manifold.impulses[i];
    if (impulse <= 0) continue;
    const ContactPatch::Point& point = manifold.patch.points[0];
    impacts_.push_back(
        {meeting.pair, (point.onA + point.onB) / 2, (meeting.isExchanged ? -1 : 1) * manifold.patch.normal, impulse});
  }
}

/// Wakes sleepers that were pushed, with all that fell asleep with them.
void PileStep::wakeTouched() {
  if (awake_ == bodies_.size()) return;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const BodyMotion& velocity = motions_.velocities[i];
    if (!poses_[i].isAsleep || (linearOf(velocity).isZero(0) && angularOf(velocity).isZero(0))) continue;
    const int island = sleepIslands_[i];
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (sleepIslands_[k] != island) continue;
      poses_[k].isAsleep = false, motions_.falls[k] = 1, sleepIslands_[k] = -1, calmTimes_[k] = 0;
      ++awake_;
      woken_.push_back(static_cast<int>(k));
    }
  }
}

/// Puts to sleep what has been slow for a while together with all that it touches. Slow: as fast as gravity makes a
/// body in a sub-step, which the contacts of a pile at rest cannot be told from. The spin of a ball that stays in
/// place does not count: nothing in the laws of contact would ever stop it.
void PileStep::letSleep(double timeStep, VectorX& state) {
  const double slow = gravity_.norm() * timeStep / kSubSteps;
  bool someAreCalm = false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (poses_[i].isAsleep) continue;
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const double spin = isBall_[i] ? 0 : poses_[i].radius * angularVelocity(state, body).norm();
    const bool isSlow = std::max(linearVelocity(state, body).norm(), spin) < slow;
    calmTimes_[i] = isSlow && coloring_.isTouched(i) ? calmTimes_[i] + timeStep : 0;
    someAreCalm = someAreCalm || calmTimes_[i] >= kCalmTime;
  }
  if (!someAreCalm) return;
  const std::vector<int>& islands = contacts_.islands(poses_);
  std::vector<char> isRestless(bodies_.size(), 0);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (!poses_[i].isAsleep && calmTimes_[i] < kCalmTime) isRestless[static_cast<std::size_t>(islands[i])] = 1;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (poses_[i].isAsleep || isRestless[static_cast<std::size_t>(islands[i])]) continue;
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    linearVelocity(state, body).setZero();
    angularVelocity(state, body).setZero();
    poses_[i].linearVelocity.setZero(), poses_[i].angularVelocity.setZero();
    poses_[i].isAsleep = true, motions_.falls[i] = 0, motions_.starts[i] = {}, sleepIslands_[i] = islands[i];
    --awake_;
    fallenAsleep_.push_back(static_cast<int>(i));
  }
}

}  // namespace cradle
