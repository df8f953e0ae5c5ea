#include "impact/soft_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "impact/soft_parameters.h"
#include "math/principal_axes.h"

namespace cradle {
namespace {

constexpr double kRestSubStep = 1.0 / 480;  // s, for loads at rest
constexpr std::size_t kBodyGrain = 256;     // bodies that a thread takes at once: tens of microseconds

std::vector<double> massesOf(const std::vector<RigidBody>& bodies) {
  std::vector<double> masses;
  for (const RigidBody& body : bodies) masses.push_back(1 / body.inverseMass);
  return masses;
}

/// Turns by a small rotation vector: q + 1/2 (0, r) q, made of unit length, turns by 2 atan(|r| / 2).
Quat turned(const Quat& worldFromBody, const Vec3& rotation) {
  const Quat half(0, rotation.x() / 2, rotation.y() / 2, rotation.z() / 2);
  Quat sum = half * worldFromBody;
  sum.coeffs() += worldFromBody.coeffs();
  return sum.normalized();
}

Vec3 pointOf(const MovingPose& pose, const PersistentManifold::Anchor& anchor) {
  return pose.position + pose.rotation * anchor.cast<double>();
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

SoftStep::SoftStep(const std::vector<RigidBody>& bodies, ContactGeometry& geometry, const Vec3& gravity, int threads)
    : bodies_(bodies),
      geometry_(geometry),
      gravity_(gravity),
      threads_(threads),
      scale_(scaleOf(geometry_)),
      broadPhase_(threads_),
      contacts_(geometry_, scale_),
      solver_(scale_),
      sleep_(massesOf(bodies), scale_.time * SoftParameters::kStillTime) {
  const std::size_t count = bodies.size();
  geometry_.pairs.clear();
  for (const RigidBody& body : bodies) {
    const PrincipalAxes principal = principalAxes(body.inertiaTensor);
    principalAxes_.push_back(body.isSpherical ? Mat3(Mat3::Identity()) : principal.axes);
    rootMoments_.push_back(principal.moments.cwiseSqrt());
  }
  poses_.resize(count);
  bounds_.assign(count, Bounds(Vec3(Vec3::Zero()), Vec3(Vec3::Zero())));
  isSphere_.assign(count, 0), isLed_.assign(count, 0), isLedStill_.assign(count, 0);
  for (const Collider& collider : geometry_.colliders)
    if (collider.body != kFixed) {
      MovingPose& pose = poses_[static_cast<std::size_t>(collider.body)];
      pose.radius = collider.boundingRadius;
      bounds_[static_cast<std::size_t>(collider.body)] = collider.bounds;
      pose.spinRadius = collider.isSphere() && collider.points[0].isZero() ? 0 : pose.radius;
      isSphere_[static_cast<std::size_t>(collider.body)] = collider.isSphere();
      isLed_[static_cast<std::size_t>(collider.body)] = collider.isDriven;
    }
  hasManySpheres_ = static_cast<double>(std::count(isSphere_.begin(), isSphere_.end(), 1)) >
                    SoftParameters::kManySpheres * static_cast<double>(count);
  for (const std::vector<ContactMaterial>& row : geometry.materials)
    for (const ContactMaterial& material : row) rebounds_ = rebounds_ || material.restitution > 0;
  worldFromPrincipal_.assign(count, Mat3::Identity());
  solverBodies_.resize(count);
  motions_.resize(count);
  for (std::size_t i = 0; i < count; ++i) motions_.pulls[i] = pullOf(i);
  reaches_.assign(count, 0);
  displacements_.assign(count, Vec3::Zero());
  speeds_.assign(count, 0);
}

double SoftStep::maxMargin() const {
  using Soft = SoftParameters;
  return scale_.length * (Soft::kContactMargin + Soft::kDeflected * Soft::kMaxApproach);
}

void SoftStep::advance(double timeStep, VectorX& state) {
  using Soft = SoftParameters;
  impacts_.clear(), fallenAsleep_.clear(), woken_.clear();
  taken_ = {};
  wakeLed(state);
  if (allAsleep()) return;
  slowestRebound_ = timeStep * gravity_.norm(), slow_ = Soft::kStillRatio * slowestRebound_;

  // How fast do bodies approach each other, and how often must they be looked at for that?
  placeBodies(timeStep, state);
  const double maxApproach = scale_.length * Soft::kMaxApproach, margin = scale_.length * Soft::kContactMargin;
  if (broadPhase_.update({state, reaches_, displacements_}, maxMargin(), geometry_)) contacts_.takePairs();
  const double approach = timeStep * contacts_.fastestApproach({poses_, state, timeStep, maxMargin()}, threads_);
  const int substepGroups = std::clamp(static_cast<int>(std::ceil(approach / maxApproach)), 1, Soft::kMaxSubstepGroups);
  const double groupApproach = std::min(approach / substepGroups, maxApproach);
  const int fewest = static_cast<int>(std::ceil(groupApproach / (scale_.length * Soft::kMaxSubStepApproach)));
  const int subSteps = std::max(
      ((isDisturbed_ ? Soft::kDisturbedSubSteps : Soft::kSubSteps) + substepGroups - 1) / substepGroups, fewest);
  margin_ = margin + Soft::kDeflected * groupApproach;

  contacts_.beginStep();
  for (int substepGroup = 0; substepGroup < substepGroups; ++substepGroup) {
    if (substepGroups > 1) placeBodies(timeStep / substepGroups, state);
    takeSubstepGroup(timeStep / substepGroups, subSteps, substepGroups - substepGroup, state);
  }
  letSleep(timeStep, state);
}

/// A step with one look for contacts, the first of so many pieces that are left.
void SoftStep::takeSubstepGroup(double timeStep, int subSteps, int substepGroups, VectorX& state) {
  const double ahead = substepGroups;
  const SoftStepStart look{poses_, state, timeStep, margin_, substepGroups * timeStep};
  if (broadPhase_.update({state, reaches_, displacements_, ahead}, margin_, geometry_)) contacts_.takePairs();
  contacts_.update(look, threads_);
  wakeTouched(look);
  ++detections_;
  const ContactColors& colors = coloring_.color(contacts_.active(), bodies_.size());
  const double subStep = timeStep / subSteps;
  solver_.prepare(colors, contacts_.manifolds(), solverBodies_, subStep, threads_);
  solver_.solve({subStep, subSteps, slowestRebound_, rebounds_}, gravity_, motions_, threads_);
  solver_.store(contacts_.manifolds(), threads_);
  taken_.byImpact += solver_.taken().byImpact, taken_.byFriction += solver_.taken().byFriction;
  recordImpacts(timeStep);
  threads_.share(bodies_.size(), kBodyGrain, [&](int, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) moveBody(i, timeStep, subStep, state);
  });
}

void SoftStep::placeBodies(double timeStep, const VectorX& state) {
  threads_.share(bodies_.size(), kBodyGrain, [&](int, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      if (!poses_[i].isAsleep) placeBody(i, state);
      const MovingPose& pose = poses_[i];
      motions_.velocities[i] = motions_.starts[i];
      motions_.displacements[i] = {};
      displacements_[i] = timeStep * pose.linearVelocity;
      reaches_[i] = pose.isAsleep ? 0 : timeStep * (timeStep * gravity_.norm() + pose.spinSpeed);
    }
  });
}

void SoftStep::placeBody(std::size_t index, const VectorX& state) {
  const Eigen::Index body = static_cast<Eigen::Index>(index);
  MovingPose& pose = poses_[index];
  const Quat turn = orientation(state, body);
  pose.position = centerOfMass(state, body);
  pose.rotation = turn.toRotationMatrix();
  pose.linearVelocity = linearVelocity(state, body);
  pose.angularVelocity = angularVelocity(state, body);
  pose.spinSpeed = pose.spinRadius * pose.angularVelocity.norm();
  pose.boxCenter = pose.position + pose.rotation * bounds_[index].center();
  pose.boxHalf = pose.rotation.cwiseAbs() * (bounds_[index].sizes() / 2);
  Mat3& axes = worldFromPrincipal_[index];
  if (!bodies_[index].isSpherical) axes = pose.rotation * principalAxes_[index];
  solverBodies_[index] = solverBody(index);
  motions_.starts[index] =
      motionOf(pose.linearVelocity, rootMoments_[index].cwiseProduct(axes.transpose() * pose.angularVelocity));
}

/// A body where it was placed, and one that nothing moves.
SolverBody SoftStep::solverBody(std::size_t index) const {
  const Vec3 inverseRoots = rootMoments_[index].cwiseInverse();
  return {bodies_[index].inverseMass, Mat3(inverseRoots.asDiagonal() * worldFromPrincipal_[index].transpose()),
          poses_[index].rotation};
}
SolverBody SoftStep::stillBody(std::size_t index) const {
  return {0, Mat3(Mat3::Zero()), poses_[index].rotation};
}

void SoftStep::moveBody(std::size_t index, double timeStep, double subStep, VectorX& state) {
  if (poses_[index].isAsleep) return;
  const Eigen::Index body = static_cast<Eigen::Index>(index);
  const BodyMotion &velocity = motions_.velocities[index], &displacement = motions_.displacements[index];
  const Vec3 inverseRoots = rootMoments_[index].cwiseInverse();
  const auto unscaled = [&](const Vec3& scaled) -> Vec3 {
    return worldFromPrincipal_[index] * inverseRoots.cwiseProduct(scaled);
  };
  centerOfMass(state, body) += linearOf(displacement);
  // Falling by sub-steps goes too far by g h/2 a unit of time: what touches nothing falls exactly.
  if (!coloring_.isTouched(index) && !isLed_[index]) centerOfMass(state, body) -= timeStep * subStep / 2 * gravity_;
  linearVelocity(state, body) = linearOf(velocity);
  const Vec3 rotation = unscaled(angularOf(displacement));
  const Quat turn = turned(orientation(state, body), rotation);
  poses_[index].turned += rotation.norm();
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

std::vector<SoftContactSolver::MeanLoad> SoftStep::loadsAtRest(int subSteps) {
  std::vector<ManifoldLink> links;
  contacts_.forEachContact([&](const ColliderPair&, std::int32_t index, bool) {
    const PersistentManifold& manifold = contacts_.manifolds()[static_cast<std::size_t>(index)];
    links.push_back({index, manifold.bodyA, manifold.bodyB, manifold.count});
  });
  SolverMotions motions;
  motions.resize(bodies_.size());
  std::vector<SolverBody> bodies(bodies_.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    motions.pulls[i] = isLed_[i] ? SolverMotions::Pull::asleep : SolverMotions::Pull::gravity;
    bodies[i] = isLed_[i] ? stillBody(i) : solverBody(i);
  }
  ContactColoring coloring;
  SoftContactSolver solver(scale_);
  const double subStep = scale_.time * kRestSubStep;
  solver.prepare(coloring.color(links, bodies_.size()), contacts_.manifolds(), bodies, subStep, threads_);
  solver.solve({subStep, subSteps, INFINITY, false}, gravity_, motions, threads_);
  return solver.meanLoads(contacts_.manifolds().size());
}

/// The force of the last sub-step stands for all: where bodies meet fast, a look has few.
void SoftStep::recordImpacts(double timeStep) {
  for (const SoftContacts::Meeting& meeting : contacts_.meetings(slowestRebound_)) {
    const PersistentManifold& manifold = contacts_.manifolds()[static_cast<std::size_t>(meeting.manifold)];
    double impulse = 0;
    for (std::int32_t i = 0; i < manifold.count; ++i)
      impulse += timeStep * manifold.forces[static_cast<std::size_t>(i)];
    if (impulse <= 0) continue;
    const Vec3 onA = pointOf(poses_[static_cast<std::size_t>(manifold.bodyA)], manifold.onA[0]);
    const Vec3 onB = manifold.bodyB == kFixed
                         ? Vec3(onA + manifold.separations[0] * manifold.normal)
                         : pointOf(poses_[static_cast<std::size_t>(manifold.bodyB)], manifold.onB[0]);
    impacts_.push_back({meeting.pair, (onA + onB) / 2, (meeting.isExchanged ? -1 : 1) * manifold.normal, impulse});
  }
}

/// A body that is led sleeps while it stands still, and nothing that it touches does while it moves.
void SoftStep::wakeLed(const VectorX& state) {
  for (std::size_t i = 0; i < isLed_.size(); ++i) {
    if (!isLed_[i]) continue;
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    isLedStill_[i] = linearVelocity(state, body).isZero(0) && angularVelocity(state, body).isZero(0);
    if (isLedStill_[i] || !poses_[i].isAsleep) continue;
    sleep_.wakeRestless(static_cast<int>(i));
    poses_[i].isAsleep = false, motions_.pulls[i] = pullOf(i);
  }
}

/// Wakes what is disturbed, and finds what it touches.
void SoftStep::wakeTouched(const SoftStepStart& look) {
  const std::size_t before = woken_.size();
  sleep_.wakeTouched(contacts_, poses_, slow_, woken_);
  if (woken_.size() == before) return;
  for (std::size_t i = before; i < woken_.size(); ++i) {
    const std::size_t body = static_cast<std::size_t>(woken_[i]);
    poses_[body].isAsleep = false, motions_.pulls[body] = pullOf(body);
    placeBody(body, look.state);
  }
  contacts_.update(look, threads_);
}

/// Slow: as fast as gravity makes a body in a part of a step, which the contacts of a heap at rest cannot be told from.
/// The spin of a sphere that stays in place does not count: nothing in the laws of contact would ever stop it.
/// A heap is stirred while something else than spheres moves in it. Many spheres go on rolling for long whatever is
/// done: with them it counts as still.
void SoftStep::letSleep(double timeStep, VectorX& state) {
  isDisturbed_ = false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (poses_[i].isAsleep) continue;
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const double spin = isSphere_[i] ? 0 : poses_[i].radius * angularVelocity(state, body).norm();
    if (isLed_[i]) {
      speeds_[i] = isLedStill_[i] ? 0 : std::numeric_limits<double>::infinity();
      continue;
    }
    speeds_[i] = coloring_.isTouched(i) ? std::max(linearVelocity(state, body).norm(), spin)
                                        : std::numeric_limits<double>::infinity();
    isDisturbed_ = isDisturbed_ || (coloring_.isTouched(i) && speeds_[i] >= slow_ && !isSphere_[i] && !hasManySpheres_);
  }
  const std::size_t before = fallenAsleep_.size();
  sleep_.letSleep(contacts_, speeds_, slow_, timeStep, fallenAsleep_);
  for (std::size_t i = before; i < fallenAsleep_.size(); ++i) {
    const std::size_t sleeper = static_cast<std::size_t>(fallenAsleep_[i]);
    linearVelocity(state, fallenAsleep_[i]).setZero();
    angularVelocity(state, fallenAsleep_[i]).setZero();
    putToSleep(sleeper);
  }
}

void SoftStep::putToSleep(std::size_t body) {
  MovingPose& pose = poses_[body];
  pose.linearVelocity.setZero(), pose.angularVelocity.setZero();
  pose.spinSpeed = 0, pose.isAsleep = true;
  motions_.pulls[body] = SolverMotions::Pull::asleep, motions_.starts[body] = {};
  solverBodies_[body] = stillBody(body);
}

void SoftStep::goOnFrom(const Record& record, const VectorX& state) {
  sleep_.goOnFrom(record.sleep);
  isDisturbed_ = record.isDisturbed;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    placeBody(i, state);
    if (sleep_.isAsleep(i)) putToSleep(i);
  }
  broadPhase_.update({state, reaches_, displacements_}, maxMargin(), geometry_);
  contacts_.takePairs();
  contacts_.goOnFrom(record.contacts);
}

}  // namespace cradle
