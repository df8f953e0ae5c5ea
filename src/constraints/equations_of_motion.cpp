#include "constraints/equations_of_motion.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "constraints/invariants.h"
#include "math/box_quadratic.h"
#include "math/rotation.h"

namespace cradle {
namespace {

// Of the largest pivot: motors whose responses differ by less work on one motion.
constexpr double kSameMotors = 1e-9;
// Of the response of a joint's bodies alone: with less, stops or contacts leave the coordinate no motion, and its motor
// has nothing to do.
constexpr double kBlocked = 1e-9;
// Of the terms of accelerations: targets that contradict each other by less do so by rounding, which is 1e-16 of them
// times their condition numbers.
constexpr double kContradicting = 1e-8;

/// World derivative of the angular velocity of a body without torque: body frame I w' = -w x I w. The derivative of w
/// is the same vector in both frames, since w x w = 0.
Vec3 gyroscopicAcceleration(const RigidBody& body, const Mat3& worldFromBody, const Vec3& angularVelocity) {
  const Vec3 spin = worldFromBody.transpose() * angularVelocity;
  return worldFromBody * (body.inverseInertia * -spin.cross(body.inertiaTensor * spin));
}

/// Forces, or impulses, of motors that give these accelerations, or velocities: wheels on one road share their load.
VectorX leastForces(const MatrixX& perForce, const VectorX& wanted) {
  Eigen::CompleteOrthogonalDecomposition<MatrixX> decomposition;
  decomposition.setThreshold(kSameMotors);
  return decomposition.compute(perForce).solve(wanted);
}

}  // namespace

EquationsOfMotion::EquationsOfMotion(const Mechanism& mechanism)
    : mechanism_(mechanism),
      resting_(mechanism.bodies.size(), 0),
      solver_(mechanism.constraints, mechanism.bodies),
      contactSolver_(mechanism.contacts, mechanism.constraints, mechanism.bodies) {}

RightHandSide EquationsOfMotion::rightHandSide() {
  return {
      [this](double time, const VectorX& state, VectorX& derivative) { evaluate(time, state, derivative); },
      [this](const VectorX& state, VectorX& derivative) { evaluatePoseRates(mechanism_.bodies, state, derivative); },
      static_cast<Eigen::Index>(mechanism_.bodies.size()) * kPoseSize};
}

void EquationsOfMotion::evaluate(double time, const VectorX& state, VectorX& derivative) {
  ++evaluations_;
  if (!projects_) return evaluateAt(time, state, derivative);
  projected_ = state;
  project(projected_);
  evaluateAt(time, projected_, derivative);
}

void EquationsOfMotion::evaluateAt(double time, const VectorX& state, VectorX& derivative) {
  derivative.setZero(state.size());
  findBodyFrames(mechanism_.bodies, state, frames_);
  evaluatePoseRates(mechanism_.bodies, state, derivative);
  applyGravityAndGyroscopicTerms(state, derivative);
  accelerate(mechanism_.driven, time, derivative);
  if (!mechanism_.springs.empty()) applySprings(state, derivative);
  if (!mechanism_.pushes.empty()) applyPushes(state, derivative);
  applyConstraints(time, state, derivative);
  holdResting(state, derivative);
  if (mechanism_.driven.empty()) return;
  addPowerOfConstraints(state, derivative);
  if (hasContacts()) addPowerOfContacts(state, derivative);
}

void EquationsOfMotion::evaluateWithoutContacts(double time, const VectorX& state, VectorX& derivative) {
  isWithoutContacts_ = true;
  evaluate(time, state, derivative);
  isWithoutContacts_ = false;
}

void EquationsOfMotion::applyConstraints(double time, const VectorX& state, VectorX& derivative) {
  if (hasContacts()) holdResting(state, derivative);
  factorize(time, state);
  if (!mechanism_.motors.empty()) applyMotors(state, derivative);
  constrain(derivative);
}

void EquationsOfMotion::factorize(double time, const VectorX& state) {
  if (hasContacts())
    contactSolver_.factorize(time, state, frames_, resting_);
  else if (solver_.hasConstraints())
    solver_.factorize(state, frames_);
}

/// Adds what constraints and contacts give, which were factorised.
void EquationsOfMotion::constrain(VectorX& derivative) {
  if (hasContacts()) {
    contactSolver_.constrainAccelerations(derivative);
    multipliers_ = contactSolver_.bilateralMultipliers();
  } else if (solver_.hasConstraints()) {
    solver_.constrainAccelerations(derivative);
    multipliers_.setZero(rowCount(mechanism_.constraints));
    solver_.putMultipliers(multipliers_);
  }
}

/// Adds the forces of motors, and their power to the work.
void EquationsOfMotion::applyMotors(const VectorX& state, VectorX& derivative) {
  const std::vector<JointMotor>& motors = mechanism_.motors;
  const bool areKnown = isWithoutContacts_ && motorForces_.size() == std::ssize(motors);
  if (motorForces_.size() != std::ssize(motors)) motorForces_.setZero(std::ssize(motors));
  motorMobilities_.setZero(std::ssize(motors)), motorContradictions_.setZero(std::ssize(motors));
  std::vector<ConstraintBlock> rows;
  std::vector<std::size_t> holding;
  for (std::size_t i = 0; i < motors.size(); ++i) {
    rows.push_back(rowOf(motors[i], state, frames_));
    double& force = motorForces_[static_cast<Eigen::Index>(i)];
    const bool isAsked = asksPossible_ && motors[i].hasTarget && !isResting(motors[i].joint);
    if (motors[i].mode == JointMotor::Mode::pushes && !isAsked) {
      force = motors[i].sign * motors[i].maxForce;
    } else if (!areKnown && !isResting(motors[i].joint)) {
      holding.push_back(i);
      continue;
    }
    if (force != 0) addForce(rows[i], force, state, derivative);
  }
  if (!holding.empty()) hold(holding, rows, state, derivative);
  for (std::size_t i = 0; i < motors.size(); ++i)
    if (!isStopped(motors[i]))
      pushWork(derivative) += motorForces_[static_cast<Eigen::Index>(i)] * rateOf(rows[i], 0, state);
}

/// Whether a stop holds a motor's joint. Its velocity then is an error of the step, and the stop pushes back as much as
/// the motor pushes: a strong motor would seem to work.
bool EquationsOfMotion::isStopped(const JointMotor& motor) const {
  const auto isSame = [](const Attachment& a, const Attachment& b) { return a.body == b.body && a.point == b.point; };
  return std::any_of(mechanism_.constraints.begin(), mechanism_.constraints.end(), [&](const Constraint& constraint) {
    return std::holds_alternative<JointCoordinate>(constraint.kind) &&
           isSame(constraint.anchorA, motor.joint.anchorA) && isSame(constraint.anchorB, motor.joint.anchorB);
  });
}

EquationsOfMotion::MotorResponse EquationsOfMotion::responseOf(const std::vector<std::size_t>& holding,
                                                               const std::vector<ConstraintBlock>& rows,
                                                               const VectorX& state, const VectorX& derivative) {
  const Eigen::Index count = std::ssize(holding);
  const auto accelerations = [&](VectorX rates) {
    constrain(rates);
    VectorX found(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const ConstraintBlock& row = rows[holding[static_cast<std::size_t>(k)]];
      found[k] = rateOf(row, 0, rates) + row.velocityProduct[0];
    }
    return found;
  };
  MotorResponse response{accelerations(derivative), MatrixX(count, count)};
  // The difference of two accelerations is that of a force as large as the motor's: 1 N m may be nothing beside
  // weights.
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::size_t motor = holding[static_cast<std::size_t>(k)];
    const double most = mechanism_.motors[motor].maxForce, force = most > 0 ? most : 1;
    VectorX pushed = derivative;
    addForce(rows[motor], force, state, pushed);
    response.perForce.col(k) = (accelerations(pushed) - response.free) / force;
  }
  std::vector<ConstraintBlock> held;
  for (const std::size_t motor : holding) held.push_back(rows[motor]);
  leaveOutBlocked(held, response.perForce);
  response.scale = scaleOf(holding, rows, state, derivative) + response.free.cwiseAbs().maxCoeff();
  return response;
}

/// A bound on the accelerations of coordinates that those in `derivative` cause, whatever constraints do with them: no
/// more than sqrt(J M^-1 J^T) |a| with the norm |a|^2 = a^T M a (Cauchy, Schwarz). The rate at which errors of target
/// velocities are taken back is added.
double EquationsOfMotion::scaleOf(const std::vector<std::size_t>& holding, const std::vector<ConstraintBlock>& rows,
                                  const VectorX& state, const VectorX& derivative) const {
  VectorX moving = state;
  const Eigen::Index poses = poseComponents(state);
  moving.tail(state.size() - poses) = derivative.tail(state.size() - poses);
  const double norm = std::sqrt(2 * kineticEnergy(mechanism_.bodies, moving));
  double scale = 0;
  for (const std::size_t motor : holding) {
    const double mobility = mobilityOf(rows[motor], mechanism_.bodies, frames_);
    scale = std::max(scale,
                     std::sqrt(mobility) * norm + kMotorRelaxation * std::abs(mechanism_.motors[motor].targetVelocity));
  }
  return scale;
}

/// Sets the responses of coordinates to zero to which nothing leaves any motion.
void EquationsOfMotion::leaveOutBlocked(const std::vector<ConstraintBlock>& rows, MatrixX& perForce) const {
  for (Eigen::Index k = 0; k < perForce.cols(); ++k) {
    const double alone = mobilityOf(rows[static_cast<std::size_t>(k)], mechanism_.bodies, frames_);
    if (std::abs(perForce(k, k)) <= kBlocked * alone) perForce.row(k).setZero(), perForce.col(k).setZero();
  }
}

VectorX EquationsOfMotion::missingVelocities(const std::vector<std::size_t>& holding,
                                             const std::vector<ConstraintBlock>& rows, const VectorX& state) const {
  VectorX missing(holding.size());
  for (std::size_t k = 0; k < holding.size(); ++k)
    missing[static_cast<Eigen::Index>(k)] =
        mechanism_.motors[holding[k]].targetVelocity - rateOf(rows[holding[k]], 0, state);
  return missing;
}

VectorX EquationsOfMotion::limitsOf(const std::vector<std::size_t>& holding) const {
  VectorX limits(holding.size());
  for (std::size_t k = 0; k < holding.size(); ++k)
    limits[static_cast<Eigen::Index>(k)] = mechanism_.motors[holding[k]].maxForce;
  return limits;
}

/// Dry friction in reverse: a motor that is off its target pushes towards it, and the others are a linear
/// complementarity problem with bounds.
VectorX EquationsOfMotion::possibleForces(const std::vector<std::size_t>& holding, const MotorResponse& response,
                                          const VectorX& missing) const {
  const VectorX limits = limitsOf(holding);
  VectorX forces = VectorX::Zero(limits.size());
  std::vector<Eigen::Index> atTarget;
  for (Eigen::Index k = 0; k < limits.size(); ++k) {
    const std::size_t index = holding[static_cast<std::size_t>(k)];
    const bool isReached = !reached_.empty() && reached_[index];
    const JointMotor& motor = mechanism_.motors[index];
    if (!isReached && std::abs(missing[k]) > settledSpeed(motor, response.perForce(k, k)))
      forces[k] = std::copysign(limits[k], missing[k]);
    else
      atTarget.push_back(k);
  }
  if (atTarget.empty()) return forces;
  const VectorX accelerations = response.free + response.perForce * forces;
  const VectorX found = boxMinimum(response.perForce(atTarget, atTarget), -accelerations(atTarget), limits(atTarget),
                                   kContradicting * response.scale);
  for (std::size_t k = 0; k < atTarget.size(); ++k) forces[atTarget[k]] = found[static_cast<Eigen::Index>(k)];
  return forces;
}

VectorX EquationsOfMotion::possibleMotorForces(double time, const VectorX& state, const std::vector<char>& reached) {
  asksPossible_ = true, reached_ = reached;
  VectorX derivative;
  evaluate(time, state, derivative);
  asksPossible_ = false;
  return motorForces_;
}

void EquationsOfMotion::keepTargets(VectorX& state) {
  const auto holds = [](const JointMotor& motor) { return motor.mode == JointMotor::Mode::holds; };
  if (std::none_of(mechanism_.motors.begin(), mechanism_.motors.end(), holds)) return;
  findBodyFrames(mechanism_.bodies, state, frames_);
  std::vector<ConstraintBlock> rows;
  std::vector<double> missing;
  for (const JointMotor& motor : mechanism_.motors) {
    if (!holds(motor) || isResting(motor.joint)) continue;
    ConstraintBlock& row = rows.emplace_back(rowOf(motor, state, frames_));
    missing.push_back(motor.targetVelocity - rateOf(row, 0, state));
    const auto isAtRest = [this](int body) { return body != kFixed && resting_[static_cast<std::size_t>(body)]; };
    if (isAtRest(row.bodyA)) row.bodyA = kFixed, row.turnsA = false;
    if (isAtRest(row.bodyB)) row.bodyB = kFixed, row.turnsB = false;
  }
  if (rows.empty()) return;
  factorize(0, state);  // friction of sliding, which alone asks for a time, answers to no velocity
  const Eigen::Index count = std::ssize(rows);
  MatrixX responses(state.size(), count), perImpulse(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const ConstraintBlock& row = rows[static_cast<std::size_t>(k)];
    const double one = 1;
    BlockResponse alone;
    findResponse(row, mechanism_.bodies, frames_, alone);
    VectorX response = VectorX::Zero(state.size());
    addResponse(row, alone, &one, response);
    if (hasContacts())
      contactSolver_.constrainVelocities(response);
    else if (solver_.hasConstraints())
      solver_.constrainVelocities(response);
    responses.col(k) = response;
    for (Eigen::Index i = 0; i < count; ++i) perImpulse(i, k) = rateOf(rows[static_cast<std::size_t>(i)], 0, response);
  }
  leaveOutBlocked(rows, perImpulse);
  state += responses * leastForces(perImpulse, Eigen::Map<const VectorX>(missing.data(), count));
}

/// The shortfall of the accelerations by these forces from those `wanted`, in units of ten times what boxMinimum, by
/// which such contradictions are resolved, takes for rounding; 0 for coordinates to which nothing leaves any motion.
VectorX EquationsOfMotion::contradictionOf(const MotorResponse& response, const VectorX& forces,
                                           const VectorX& wanted) {
  VectorX left = (response.perForce * forces - wanted).cwiseAbs();
  const VectorX terms = response.perForce.cwiseAbs() * forces.cwiseAbs();
  left /= 10 * kContradicting * (response.scale + terms.maxCoeff());
  return (response.perForce.diagonal().array() != 0).select(left, 0.0);
}

/// Adds the forces of motors that hold: those with which their coordinates' accelerations, after all constraints and
/// contacts, are zero, or take back an error of the velocity; in steps of a fixed length, and where it is asked what
/// they can have, within all they have.
void EquationsOfMotion::hold(const std::vector<std::size_t>& holding, const std::vector<ConstraintBlock>& rows,
                             const VectorX& state, VectorX& derivative) {
  const MotorResponse response = responseOf(holding, rows, state, derivative);
  const VectorX missing = missingVelocities(holding, rows, state);
  VectorX forces, left = VectorX::Zero(missing.size());
  if (asksPossible_) {
    forces = possibleForces(holding, response, missing);
  } else if (motorTimeStep_ > 0) {
    const VectorX limits = limitsOf(holding);
    forces = boxMinimum(response.perForce, missing / motorTimeStep_ - response.free, limits,
                        kContradicting * response.scale);
    for (Eigen::Index k = 0; k < forces.size(); ++k)  // against a stop
      if (response.perForce(k, k) == 0 && missing[k] != 0) forces[k] = std::copysign(limits[k], missing[k]);
  } else {
    forces = leastForces(response.perForce, kMotorRelaxation * missing - response.free);
    left = contradictionOf(response, forces, kMotorRelaxation * missing - response.free);
  }
  for (std::size_t k = 0; k < holding.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k), motor = static_cast<Eigen::Index>(holding[k]);
    motorForces_[motor] = forces[at], motorMobilities_[motor] = response.perForce(at, at);
    motorContradictions_[motor] = left[at];
    addForce(rows[holding[k]], forces[at], state, derivative);
  }
}

bool EquationsOfMotion::isResting(const Constraint& constraint) const {
  const auto rests = [this](int body) {
    return body == kFixed || mechanism_.bodies[static_cast<std::size_t>(body)].isDriven() ||
           resting_[static_cast<std::size_t>(body)];
  };
  return rests(constraint.anchorA.body) && rests(constraint.anchorB.body);
}

/// Adds the accelerations that a force along a row's coordinate gives. What drives a body works against it.
void EquationsOfMotion::addForce(const ConstraintBlock& row, double force, const VectorX& state,
                                 VectorX& derivative) const {
  const auto add = [&](int body, const Vec3& linear, const Vec3& angular) {
    if (body == kFixed) return;
    const std::size_t index = static_cast<std::size_t>(body);
    if (mechanism_.bodies[index].isDriven()) {
      pushWork(derivative) -=
          force * (linear.dot(linearVelocity(state, body)) + angular.dot(angularVelocity(state, body)));
      return;
    }
    linearVelocity(derivative, body) += force * mechanism_.bodies[index].inverseMass * linear;
    angularVelocity(derivative, body) += force * (frames_[index].inverseInertia * angular);
  };
  add(row.bodyA, row.linear.row(0), row.angularA.row(0));
  add(row.bodyB, -row.linear.row(0), row.angularB.row(0));
}

void EquationsOfMotion::setResting(std::size_t body, bool resting) {
  resting_[body] = resting;
  solver_.exclude(resting_);
}

void EquationsOfMotion::holdResting(const VectorX& state, VectorX& derivative) const {
  for (std::size_t body = 0; body < resting_.size(); ++body)
    if (resting_[body])
      derivative.segment<kVelocitySize>(velocityOffset(state, static_cast<Eigen::Index>(body))).setZero();
}

double EquationsOfMotion::project(VectorX& state) {
  if (!mechanism_.contacts.empty()) return contactSolver_.project(state, resting_);
  return solver_.hasConstraints() ? solver_.project(state) : 0;
}

void EquationsOfMotion::applyGravityAndGyroscopicTerms(const VectorX& state, VectorX& derivative) const {
  for (std::size_t i = 0; i < mechanism_.bodies.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    linearVelocity(derivative, body) = mechanism_.gravity;
    if (mechanism_.bodies[i].isSpherical) continue;
    const Vec3 spin = angularVelocity(state, body);
    if (spin != Vec3::Zero())
      angularVelocity(derivative, body) = gyroscopicAcceleration(mechanism_.bodies[i], frames_[i].rotation, spin);
  }
}

void EquationsOfMotion::applySprings(const VectorX& state, VectorX& derivative) const {
  for (const SpringForce& spring : mechanism_.springs) {
    const AttachmentMotion a = motionOf(spring.anchorA, state, frames_), b = motionOf(spring.anchorB, state, frames_);
    const SpringPull pull = pullOf(spring, a, b);
    addForce(spring.anchorA.body, a.arm, pull.forceOnA, state, derivative);
    addForce(spring.anchorB.body, b.arm, -pull.forceOnA, state, derivative);
    dampingEnergy(derivative) += pull.dissipation;
  }
}

void EquationsOfMotion::applyPushes(const VectorX& state, VectorX& derivative) const {
  for (const PushForce& push : mechanism_.pushes) {
    addForce(push.point.body, motionOf(push.point, state, frames_).arm, push.force, state, derivative);
    if (!push.torque.isZero()) {
      const auto index = static_cast<std::size_t>(push.point.body);
      angularVelocity(derivative, push.point.body) += frames_[index].inverseInertia * push.torque;
    }
    pushWork(derivative) += powerOf(push, state);
  }
}

/// Adds the accelerations that a force (N, world) at `arm` (m, world) gives a body to its velocity rates. A driven body
/// is not accelerated: what drives it works against the force.
void EquationsOfMotion::addForce(int body, const Vec3& arm, const Vec3& force, const VectorX& state,
                                 VectorX& derivative) const {
  if (body == kFixed) return;
  const std::size_t index = static_cast<std::size_t>(body);
  if (mechanism_.bodies[index].isDriven()) {
    pushWork(derivative) -= force.dot(pointVelocity(body, centerOfMass(state, body) + arm, state));
    return;
  }
  linearVelocity(derivative, body) += mechanism_.bodies[index].inverseMass * force;
  if (!mechanism_.bodies[index].hasConstantSpin)
    angularVelocity(derivative, body) += frames_[index].inverseInertia * arm.cross(force);
}

/// Adds the power of the drives of driven bodies against the constraints: -lambda . J v, v the velocities of driven
/// bodies alone.
void EquationsOfMotion::addPowerOfConstraints(const VectorX& state, VectorX& derivative) const {
  const auto isDriven = [this](int body) {
    return body != kFixed && mechanism_.bodies[static_cast<std::size_t>(body)].isDriven();
  };
  ConstraintBlock block;
  Eigen::Index first = 0;
  for (const Constraint& constraint : mechanism_.constraints) {
    const int rows = rowCount(constraint), a = constraint.anchorA.body, b = constraint.anchorB.body;
    if (isDriven(a) || isDriven(b)) {
      findRows(constraint, state, frames_, block);
      if (!isDriven(a)) block.bodyA = kFixed;
      if (!isDriven(b)) block.bodyB = kFixed;
      for (int i = 0; i < rows; ++i) pushWork(derivative) -= multipliers_[first + i] * rateOf(block, i, state);
    }
    first += rows;
  }
}

void EquationsOfMotion::addPowerOfContacts(const VectorX& state, VectorX& derivative) const {
  for (std::size_t i = 0; i < mechanism_.contacts.size(); ++i) {
    const ContactForce& contact = contactSolver_.forces()[i];
    const Vec3 onA = contact.normal * contact.direction + contact.tangential;
    const int a = mechanism_.contacts[i].centerA.body, b = mechanism_.contacts[i].surfaceB.body;
    pushWork(derivative) += powerOfDriven(mechanism_.bodies, a, contact.point, -onA, state) +
                            powerOfDriven(mechanism_.bodies, b, contact.point, onA, state);
  }
}

void evaluatePoseRates(const std::vector<RigidBody>& bodies, const VectorX& state, VectorX& derivative) {
  for (Eigen::Index body = 0; body < bodyCount(state); ++body) {
    centerOfMass(derivative, body) = linearVelocity(state, body);
    const Vec3 spin = angularVelocity(state, body);
    if (bodies[static_cast<std::size_t>(body)].hasConstantSpin || spin == Vec3::Zero())
      derivative.segment<4>(body * kPoseSize + 3).setZero();
    else
      setOrientation(derivative, body, orientationRate(orientation(state, body), spin));
  }
}

}  // namespace cradle
