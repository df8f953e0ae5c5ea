#include "impact/pile_step.h"

#include <cmath>

#include "math/principal_axes.h"

namespace cradle {
namespace {

constexpr double kMargin = 5e-3;  // m
constexpr double kKeptMotion = 5e-4;  // m: half of what two bodies may move against each other with one manifold
constexpr double kKeptTurn = 5e-3;    // rad

}  // namespace

PileStep::PileStep(const std::vector<RigidBody>& bodies, ContactGeometry geometry, const Vec3& gravity, int threads)
    : bodies_(bodies), geometry_(std::move(geometry)), gravity_(gravity), threads_(threads), contacts_(geometry_) {
  const std::size_t n = bodies.size();
  poses_.resize(n);
  for (const Collider& collider : geometry_.colliders)
    if (collider.body != kFixed) poses_[static_cast<std::size_t>(collider.body)].radius = collider.boundingRadius;
  for (const RigidBody& body : bodies) {
    const PrincipalAxes principal = principalAxes(body.inertiaTensor);
    principalAxes_.push_back(body.isSpherical ? Mat3::Identity() : principal.axes);
    rootMoments_.push_back(principal.moments.cwiseSqrt());
  }
  principals_.assign(n, Mat3::Identity());
  solverBodies_.resize(n);
  motions_.velocities.resize(n + 1);
  motions_.displacements.resize(n + 1);
  motions_.starts.resize(n + 1);
  reach_.resize(n);
  markedPositions_.assign(n, Vec3::Constant(1e300));
  markedOrientations_.assign(n, Quat::Identity());
  calmTimes_.assign(n, 0);
  awake_ = n;
}

void PileStep::placeBodies(double timeStep, const VectorX& state) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    MovingPose& pose = poses_[i];
    const Quat turn = orientation(state, body);
    pose.position = centerOfMass(state, body);
    pose.rotation = turn.toRotationMatrix();
    const Vec3 velocity = linearVelocity(state, body);
    pose.linearVelocity = velocity + timeStep * gravity_;
    pose.angularVelocity = angularVelocity(state, body);
    const double cosine = std::abs(turn.dot(markedOrientations_[i]));
    if ((pose.position - markedPositions_[i]).squaredNorm() > kKeptMotion * kKeptMotion ||
        8 * (1 - cosine) > kKeptTurn * kKeptTurn) {
      markedPositions_[i] = pose.position, markedOrientations_[i] = turn;
      ++pose.version;
    }
    if (!bodies_[i].isSpherical) principals_[i] = pose.rotation * principalAxes_[i];
    const Vec3& roots = rootMoments_[i];
    solverBodies_[i] = {pose.position, bodies_[i].inverseMass,
                        Mat3(roots.cwiseInverse().asDiagonal() * principals_[i].transpose())};
    const Vec3 scaled = roots.cwiseProduct(principals_[i].transpose() * pose.angularVelocity);
    const auto motionOf = [&](const Vec3& linear) {
      return BodyMotion{{linear.x(), linear.y()}, {linear.z(), scaled.x()}, {scaled.y(), scaled.z()}};
    };
    motions_.starts[i] = motionOf(velocity);
    motions_.velocities[i] = motionOf(pose.linearVelocity);
    motions_.displacements[i] = {};
    reach_[i] = timeStep * (pose.linearVelocity.norm() + pose.radius * pose.angularVelocity.norm());
  }
}

void PileStep::moveBodies(double, VectorX& state) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const BodyMotion &velocity = motions_.velocities[i], &displacement = motions_.displacements[i];
    const Mat3 worldFromScaled = principals_[i] * rootMoments_[i].cwiseInverse().asDiagonal();
    centerOfMass(state, body) += Vec3(displacement.xy[0], displacement.xy[1], displacement.zu[0]);
    linearVelocity(state, body) = Vec3(velocity.xy[0], velocity.xy[1], velocity.zu[0]);
    angularVelocity(state, body) = worldFromScaled * Vec3(velocity.zu[1], velocity.vw[0], velocity.vw[1]);
    turnBody(state, body, worldFromScaled * Vec3(displacement.zu[1], displacement.vw[0], displacement.vw[1]));
  }
}

void PileStep::advance(double timeStep, VectorX& state) {
  placeBodies(timeStep, state);
  if (sweep.update(state, reach_, 2 * kMargin, geometry_)) contacts_.takePairs();
  contacts_.update(poses_, state, timeStep, threads_);
  solver_.prepare(coloring_.color(contacts_.manifolds(), contacts_.active(), bodies_.size()), contacts_.manifolds(),
                  solverBodies_, threads_);
  solver_.solve(timeStep, gravity_.norm() * timeStep, motions_, threads_);
  solver_.store(contacts_.manifolds(), threads_);
  moveBodies(timeStep, state);
}

}  // namespace cradle
