#include <gtest/gtest.h>

#include <cmath>

#include "constraints/constraint_row.h"
#include "constraints/equations_of_motion.h"
#include "constraints/invariants.h"
#include "math/rotation.h"

namespace cradle {
namespace {

// Bodies without any symmetry, so that a wrong frame or sign shows.
RigidBody lopsidedBody(double mass, const Vec3& principal, const Quat& bodyFromPrincipal) {
  const Mat3 turn = bodyFromPrincipal.toRotationMatrix();
  return makeRigidBody({mass, Vec3(0.1, 0.2, 0.3), turn * principal.asDiagonal() * turn.transpose()});
}

Mechanism twoBodies() {
  Mechanism mechanism;
  mechanism.bodies = {lopsidedBody(1.5, Vec3(0.1, 0.25, 0.3), rotationAbout(Vec3(1, 2, 3), 0.7)),
                      lopsidedBody(0.8, Vec3(0.2, 0.07, 0.16), rotationAbout(Vec3(-1, 0.5, 2), 1.9))};
  return mechanism;
}

VectorX someState() {
  VectorX state = VectorX::Zero(stateSize(2));
  centerOfMass(state, 0) = Vec3(0.3, -0.2, 0.5);
  centerOfMass(state, 1) = Vec3(1.4, 0.6, -0.3);
  setOrientation(state, 0, rotationAbout(Vec3(1, -1, 0.5), 0.8));
  setOrientation(state, 1, rotationAbout(Vec3(0.2, 1, 0.7), 2.1));
  linearVelocity(state, 0) = Vec3(0.4, -1.1, 0.2);
  linearVelocity(state, 1) = Vec3(-0.7, 0.3, 0.9);
  angularVelocity(state, 0) = Vec3(1.3, -0.6, 2.2);
  angularVelocity(state, 1) = Vec3(-0.9, 1.7, 0.4);
  return state;
}

VectorX stateRate(const Mechanism& mechanism, const VectorX& state) {
  EquationsOfMotion equations(mechanism);
  VectorX rate;
  equations.evaluate(0, state, rate);
  return rate;
}

Vec3 accelerationOfFirst(const Mechanism& mechanism, const VectorX& state) {
  const VectorX rate = stateRate(mechanism, state);
  return linearVelocity(rate, 0);
}

/// Central difference of a function of the state along its rate: its time derivative.
template <class Function>
auto secondOrderDerivative(const VectorX& state, const VectorX& rate, const Function& function) {
  const double step = 1e-5;  // error ~ step^2 f'''/6 + rounding 1e-16 / step: about 1e-10
  using Value = decltype(function(state));
  return Value((function(VectorX(state + step * rate)) - function(VectorX(state - step * rate))) / (2 * step));
}

TEST(GyroscopicTerm, KeepsAngularMomentumAndEnergyOfAFreeAsymmetricBody) {
  const Mechanism mechanism = twoBodies();
  const VectorX state = someState(), rate = stateRate(mechanism, state);
  const Vec3 torque = secondOrderDerivative(
      state, rate, [&](const VectorX& s) { return Vec3(invariantsOf(mechanism, s).angularMomentum); });
  EXPECT_LT(torque.norm(), 1e-8);
  EXPECT_NEAR(secondOrderDerivative(state, rate, [&](const VectorX& s) { return energyConstant(mechanism, s); }), 0,
              1e-8);
  EXPECT_GT(angularVelocity(rate, 0).norm(), 0.1);  // the term is there at all
}

TEST(Spring, KeepsEnergyMomentumAndAngularMomentumBetweenTwoAsymmetricBodies) {
  Mechanism mechanism = twoBodies();
  mechanism.springs = {{{0, Vec3(0.2, 0.1, -0.3)}, {1, Vec3(-0.1, 0.4, 0.2)}, 40, 0.7, 0.5}};
  const VectorX state = someState(), rate = stateRate(mechanism, state);
  const auto derivativeOf = [&](auto member) {
    return Vec3(
        secondOrderDerivative(state, rate, [&](const VectorX& s) { return Vec3(invariantsOf(mechanism, s).*member); }));
  };
  EXPECT_LT(derivativeOf(&Invariants::momentum).norm(), 1e-8);
  EXPECT_LT(derivativeOf(&Invariants::angularMomentum).norm(), 1e-8);
  EXPECT_NEAR(secondOrderDerivative(state, rate, [&](const VectorX& s) { return energyConstant(mechanism, s); }), 0,
              1e-7);
  EXPECT_GT(dissipatedEnergy(rate), 0);
}

TEST(Spring, PullsALongSpringAndPushesAShortOne) {
  Mechanism mechanism = twoBodies();
  mechanism.springs = {{{0, Vec3::Zero()}, {kFixed, Vec3(0, 3, 0)}, 10, 0, 2}};
  VectorX state = VectorX::Zero(stateSize(2));
  setOrientation(state, 0, Quat::Identity());
  setOrientation(state, 1, Quat::Identity());
  EXPECT_NEAR(accelerationOfFirst(mechanism, state).y(), 10 * 1 / 1.5, 1e-14);
  centerOfMass(state, 0).y() = 2;
  EXPECT_NEAR(accelerationOfFirst(mechanism, state).y(), -10 * 1 / 1.5, 1e-14);
}

TEST(Spring, DampingOpposesTheChangeOfLengthAlone) {
  Mechanism mechanism = twoBodies();
  mechanism.springs = {{{0, Vec3::Zero()}, {kFixed, Vec3(0, 2, 0)}, 0, 3, 2}};
  VectorX state = VectorX::Zero(stateSize(2));
  setOrientation(state, 0, Quat::Identity());
  setOrientation(state, 1, Quat::Identity());
  linearVelocity(state, 0) = Vec3(5, 0.5, 0);  // 0.5 m/s shorter, 5 m/s across
  const Vec3 acceleration = accelerationOfFirst(mechanism, state);
  EXPECT_NEAR(acceleration.y(), -3 * 0.5 / 1.5, 1e-14);
  EXPECT_NEAR(acceleration.x(), 0, 1e-14);
}

// A spring along a lever arm: 1/m_eff = 1/m + (r x n)^T I^-1 (r x n).
TEST(Spring, NaturalFrequencyCountsTheTurningOfTheBody) {
  Mechanism mechanism;
  mechanism.bodies = {makeRigidBody({2, Vec3::Zero(), Vec3(0.5, 0.6, 0.7).asDiagonal()})};
  const SpringForce spring{{0, Vec3(0.3, 0, 0)}, {kFixed, Vec3(0.3, 4, 0)}, 100, 0, 1};
  VectorX state = VectorX::Zero(stateSize(1));
  setOrientation(state, 0, Quat::Identity());
  EXPECT_NEAR(naturalFrequency(spring, mechanism.bodies, state), std::sqrt(100 * (1 / 2.0 + 0.09 / 0.7)), 1e-12);
}

/// Two lopsided bodies tied by every kind of constraint: a rod to the world, one between them, and a joint each.
/// Lengths and anchors fit `state`.
Mechanism tiedBodies(const VectorX& state) {
  Mechanism mechanism = twoBodies();
  mechanism.gravity = Vec3(0, -9.81, 0);
  const auto tie = [&](const Attachment& a, const Attachment& b) {
    const double length = (motionOf(a, state).position - motionOf(b, state).position).norm();
    mechanism.constraints.push_back({a, b, RodConstraint{length}});
  };
  tie({0, Vec3(0.2, 0.1, -0.3)}, {kFixed, Vec3(0.5, 2, 0.1)});
  tie({1, Vec3(-0.1, 0.4, 0.2)}, {0, Vec3(0.3, 0, 0.1)});
  return mechanism;
}

/// A frame of body `index` in which a world direction or point is what `state` says.
Vec3 directionInBody(const Vec3& direction, const VectorX& state, Eigen::Index index) {
  return orientation(state, index).normalized().conjugate() * direction;
}
Attachment at(const Vec3& point, const VectorX& state, int body) {
  return {body, directionInBody(point - centerOfMass(state, body), state, body)};
}

Mechanism hingedBodies(const VectorX& state) {
  Mechanism mechanism = twoBodies();
  mechanism.gravity = Vec3(0, -9.81, 0);
  const Vec3 pin(0.3, 0.6, -0.2), joint(0.1, -0.4, 0.9), axis = Vec3(1, 2, 2) / 3;
  const HingeConstraint hinge{
      directionInBody(axis, state, 0),
      {directionInBody(Vec3(2, 1, -2) / 3, state, 1), directionInBody(Vec3(2, -2, 1) / 3, state, 1)}};
  mechanism.constraints = {{at(pin, state, 0), {kFixed, pin}, BallJointConstraint()},
                           {at(joint, state, 0), at(joint, state, 1), hinge}};
  return mechanism;
}

std::vector<ConstraintRow> rowsIn(const Mechanism& mechanism, const VectorX& state) {
  std::vector<BodyFrame> frames;
  findBodyFrames(mechanism.bodies, state, frames);
  return rowsOf(mechanism.constraints, state, frames);
}

TEST(ConstraintRows, RateAndCurvatureAreTheTimeDerivativesOfTheirValues) {
  const VectorX state = someState();
  for (const Mechanism& mechanism : {tiedBodies(state), hingedBodies(state)}) {
    VectorX rate = VectorX::Zero(state.size());
    evaluatePoseRates(mechanism.bodies, state, rate);
    const std::vector<ConstraintRow> rows = rowsIn(mechanism, state);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double first =
          secondOrderDerivative(state, rate, [&](const VectorX& s) { return rowsIn(mechanism, s)[i].value; });
      EXPECT_NEAR(rateOf(rows[i], state), first, 1e-8) << i;
      // With constant velocities d^2C/dt^2 is the velocityProduct alone: rates of positions move, velocities stay.
      const double second =
          secondOrderDerivative(state, rate, [&](const VectorX& s) { return rateOf(rowsIn(mechanism, s)[i], s); });
      EXPECT_NEAR(rows[i].velocityProduct, second, 1e-8) << i;
    }
  }
}

TEST(ConstraintForces, KeepConstraintsToSecondOrderAndDoNoWork) {
  for (const bool hinged : {false, true}) {
    VectorX state = someState();
    const Mechanism mechanism = hinged ? hingedBodies(state) : tiedBodies(state);
    ConstraintSolver solver(mechanism.constraints, mechanism.bodies);
    solver.factorize(state);
    solver.constrainVelocities(state);
    const VectorX rate = stateRate(mechanism, state);
    const std::vector<ConstraintRow> rows = rowsIn(mechanism, state);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_NEAR(rateOf(rows[i], state), 0, 1e-13);
      EXPECT_NEAR(
          secondOrderDerivative(state, rate, [&](const VectorX& s) { return rateOf(rowsIn(mechanism, s)[i], s); }), 0,
          1e-7);
    }
    EXPECT_NEAR(secondOrderDerivative(state, rate, [&](const VectorX& s) { return energyConstant(mechanism, s); }), 0,
                1e-7);
  }
}

TEST(ConstraintForces, TwoEqualRodsDoWhatOneDoes) {
  const VectorX state = someState();
  Mechanism one = tiedBodies(state), two = one;
  two.constraints.push_back(two.constraints[0]);  // redundant: the matrix is singular
  const VectorX expected = stateRate(one, state), got = stateRate(two, state);
  EXPECT_LT((expected - got).cwiseAbs().maxCoeff(), 1e-9 * expected.cwiseAbs().maxCoeff());
}

TEST(Projection, RestoresLengthsAndKeepsMomentumOfFreeBodies) {
  VectorX state = someState();
  Mechanism mechanism = tiedBodies(state);
  mechanism.constraints.erase(mechanism.constraints.begin());  // what is left is free: no outside force
  double& length = std::get<RodConstraint>(mechanism.constraints[0].kind).length;
  length *= 1.01;
  const Invariants before = invariantsOf(mechanism, state);
  const Vec3 centre = 1.5 * Vec3(centerOfMass(state, 0)) + 0.8 * Vec3(centerOfMass(state, 1));
  ConstraintSolver solver(mechanism.constraints, mechanism.bodies);
  const double error = solver.project(state);
  // |C| / length with the old distance d: (length^2 - d^2) / (2 length), d = length / 1.01.
  EXPECT_NEAR(error, length * (1 - 1 / (1.01 * 1.01)) / 2, 1e-14);
  EXPECT_NEAR(rowsIn(mechanism, state)[0].value, 0, 1e-14);
  EXPECT_NEAR(rateOf(rowsIn(mechanism, state)[0], state), 0, 1e-14);
  EXPECT_LT((invariantsOf(mechanism, state).momentum - before.momentum).norm(), 1e-14);
  const Vec3 moved = 1.5 * Vec3(centerOfMass(state, 0)) + 0.8 * Vec3(centerOfMass(state, 1)) - centre;
  EXPECT_LT(moved.norm(), 1e-14);
}

TEST(Projection, BringsJointsTogether) {
  VectorX state = someState();
  const Mechanism mechanism = hingedBodies(state);
  centerOfMass(state, 0) += Vec3(0.01, -0.02, 0.01);
  turnBody(state, 1, Vec3(0.03, 0.01, -0.02));
  ConstraintSolver solver(mechanism.constraints, mechanism.bodies);
  EXPECT_GT(solver.project(state), 0.01);
  for (const ConstraintRow& row : rowsIn(mechanism, state)) {
    EXPECT_NEAR(row.value, 0, 2e-15);  // sums of terms of about 1 m
    EXPECT_NEAR(rateOf(row, state), 0, 1e-14);
  }
}

TEST(RestingBody, DoesNotMoveWhateverActsOnIt) {
  Mechanism mechanism = twoBodies();
  mechanism.gravity = Vec3(0, -9.81, 0);
  EquationsOfMotion equations(mechanism);
  equations.setResting(1, true);
  VectorX rate;
  equations.evaluate(0, someState(), rate);
  EXPECT_EQ(linearVelocity(rate, 1), Vec3::Zero());
  EXPECT_EQ(linearVelocity(rate, 0), mechanism.gravity);
}

// Methods that ask for the rates of positions alone step on with what is written there.
TEST(RatesOfPositions, AreAllWrittenEvenOfBodiesThatDoNotTurn) {
  Mechanism mechanism = twoBodies();
  mechanism.bodies[1].hasConstantSpin = true;
  EquationsOfMotion equations(mechanism);
  const RightHandSide rightHandSide = equations.rightHandSide();
  const VectorX state = someState();
  VectorX rate = VectorX::Constant(state.size(), NAN);
  rightHandSide.positionRate(state, rate);
  EXPECT_TRUE(rate.head(rightHandSide.positions).allFinite());
  EXPECT_EQ(rate.segment<4>(kPoseSize + 3).norm(), 0);
}

// A force at an arm gives a / m and I^-1 (r x f), and its power is booked as work.
TEST(Push, AcceleratesAndTurnsAndDoesWork) {
  const VectorX state = someState();
  Mechanism mechanism = twoBodies();
  const VectorX without = stateRate(mechanism, state);
  const PushForce push{{1, Vec3(0.2, -0.1, 0.3)}, Vec3(2, -1, 4)};
  mechanism.pushes = {push};
  const VectorX rate = stateRate(mechanism, state), change = rate - without;
  const AttachmentMotion at = motionOf(push.point, state);
  EXPECT_LT((Vec3(linearVelocity(change, 1)) - push.force / 0.8).norm(), 1e-14);
  const Mat3 inverse = worldInverseInertia(mechanism.bodies[1], orientation(state, 1));
  EXPECT_LT((Vec3(angularVelocity(change, 1)) - inverse * at.arm.cross(push.force)).norm(), 1e-13);
  EXPECT_EQ(Vec3(linearVelocity(change, 0)), Vec3::Zero());
  EXPECT_NEAR(pushWork(rate), push.force.dot(at.velocity), 1e-14);
}

// Rows of a body at rest have no multiplier, and those after it keep their places.
TEST(RestingBody, HasNoMultipliers) {
  const VectorX state = someState();
  Mechanism mechanism = hingedBodies(state);
  mechanism.constraints.insert(mechanism.constraints.begin(),
                               {{1, Vec3::Zero()}, {kFixed, Vec3(3, 0, 0)}, RodConstraint{2}});
  EquationsOfMotion equations(mechanism);
  VectorX rate;
  equations.setResting(1, true);
  equations.evaluate(0, state, rate);
  const VectorX multipliers = equations.multipliers();
  ASSERT_EQ(multipliers.size(), 1 + 3 + 5);
  EXPECT_EQ(multipliers[0], 0);
  EXPECT_GT(multipliers.segment(1, 3).norm(), 0.1);  // of the joint to the world
  EXPECT_EQ(multipliers.tail(5).norm(), 0);
  EXPECT_EQ(equations.evaluations(), 1);
}

}  // namespace
}  // namespace cradle
