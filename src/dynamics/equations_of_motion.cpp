#include "dynamics/equations_of_motion.h"

#include "math/rotation.h"

namespace cradle {
namespace {

/// Adds the accelerations that a force (N) at `arm` (m) gives a body to its velocity rates.
void addForce(const std::vector<RigidBody>& bodies, int body, const Vec3& arm, const Vec3& force, const VectorX& state,
              VectorX& rate) {
  if (body == kFixed) return;
  const RigidBody& inertia = bodies[static_cast<std::size_t>(body)];
  linearVelocity(rate, body) += inertia.inverseMass * force;
  angularVelocity(rate, body) += worldInverseInertia(inertia, orientation(state, body)) * arm.cross(force);
}

/// World rate of the angular velocity of a body without torque: body frame I w' = -w x I w. The rate of w is the same
/// vector in both frames, since w x w = 0.
Vec3 gyroscopicAcceleration(const RigidBody& body, const Quat& worldFromBody, const Vec3& angularVelocity) {
  const Vec3 spin = worldFromBody.conjugate() * angularVelocity;
  return worldFromBody * (body.inverseInertia * -spin.cross(body.inertiaTensor * spin));
}

}  // namespace

EquationsOfMotion::EquationsOfMotion(const Mechanism& mechanism)
    : mechanism_(mechanism), resting_(mechanism.bodies.size(), 0) {}

RightHandSide EquationsOfMotion::rightHandSide() {
  return {[this](double, const VectorX& state, VectorX& rate) { evaluate(state, rate); },
          [this](const VectorX& state, VectorX& rate) { evaluatePoseRates(state, rate); },
          static_cast<Eigen::Index>(mechanism_.bodies.size()) * kPoseSize};
}

void EquationsOfMotion::evaluate(const VectorX& state, VectorX& rate) {
  ++evaluations_;
  rate.setZero(state.size());
  evaluatePoseRates(state, rate);
  applyGravityAndGyroscopicTerms(state, rate);
  applySprings(state, rate);
  applyPushes(state, rate);
  applyConstraintForces(state, rate);
  for (std::size_t body = 0; body < resting_.size(); ++body)
    if (resting_[body]) rate.segment<kVelocitySize>(velocityOffset(state, static_cast<Eigen::Index>(body))).setZero();
}

void EquationsOfMotion::applyGravityAndGyroscopicTerms(const VectorX& state, VectorX& rate) const {
  for (std::size_t i = 0; i < mechanism_.bodies.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    linearVelocity(rate, body) = mechanism_.gravity;
    angularVelocity(rate, body) = gyroscopicAcceleration(mechanism_.bodies[i], orientation(state, body).normalized(),
                                                         angularVelocity(state, body));
  }
}

void EquationsOfMotion::applySprings(const VectorX& state, VectorX& rate) const {
  for (const SpringForce& spring : mechanism_.springs) {
    const SpringAction action = actionOf(spring, state);
    addForce(mechanism_.bodies, spring.anchorA.body, action.a.arm, action.forceOnA, state, rate);
    addForce(mechanism_.bodies, spring.anchorB.body, action.b.arm, -action.forceOnA, state, rate);
    dissipatedEnergy(rate) += action.dissipation;
  }
}

void EquationsOfMotion::applyPushes(const VectorX& state, VectorX& rate) const {
  for (const PushForce& push : mechanism_.pushes) {
    addForce(mechanism_.bodies, push.point.body, motionOf(push.point, state).arm, push.force, state, rate);
    pushWork(rate) += powerOf(push, state);
  }
}

void EquationsOfMotion::applyConstraintForces(const VectorX& state, VectorX& rate) {
  if (mechanism_.rods.empty()) return;
  solver_.setRows(mechanism_.rods, mechanism_.bodies, state);
  constraintResidual_.resize(static_cast<Eigen::Index>(mechanism_.rods.size()));
  for (std::size_t i = 0; i < mechanism_.rods.size(); ++i)
    constraintResidual_[static_cast<Eigen::Index>(i)] =
        -(solver_.rows()[i].curvature + rateOf(solver_.rows()[i], rate));
  multipliers_ = solver_.solve(constraintResidual_);
  for (Eigen::Index body = 0; body < bodyCount(state); ++body) {
    const auto [linear, angular] = solver_.response(body, multipliers_);
    linearVelocity(rate, body) += linear;
    angularVelocity(rate, body) += angular;
  }
}

void evaluatePoseRates(const VectorX& state, VectorX& rate) {
  for (Eigen::Index body = 0; body < bodyCount(state); ++body) {
    centerOfMass(rate, body) = linearVelocity(state, body);
    setOrientation(rate, body, orientationRate(orientation(state, body), angularVelocity(state, body)));
  }
}

}  // namespace cradle
