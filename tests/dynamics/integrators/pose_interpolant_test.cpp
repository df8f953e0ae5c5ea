#include "dynamics/integrators/pose_interpolant.h"

#include <gtest/gtest.h>

#include <random>

#include "constraints/equations_of_motion.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/dormand_prince5.h"
#include "dynamics/integrators/rk4.h"
#include "math/rotation.h"

namespace cradle {
namespace {

Vec3 randomVector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> part(-size, size);
  const double x = part(random), y = part(random), z = part(random);
  return {x, y, z};
}

/// A tumbling lopsided body on an off-centre spring: its path bends and its spin changes.
Mechanism tumblingBody() {
  Mechanism mechanism;
  mechanism.gravity = Vec3(0, -9.81, 0);
  mechanism.bodies = {makeRigidBody({1, Vec3::Zero(), Vec3(0.05, 0.09, 0.12).asDiagonal()})};
  SpringForce spring;
  spring.anchorA = {0, Vec3(0.2, 0.1, -0.3)};
  spring.anchorB = {kFixed, Vec3(0, 2, 0)};
  spring.stiffness = 30;
  spring.restLength = 1;
  mechanism.springs = {spring};
  return mechanism;
}

VectorX randomState(std::mt19937& random, double spin) {
  VectorX state = VectorX::Zero(stateSize(1));
  centerOfMass(state, 0) = randomVector(random, 1);
  setOrientation(state, 0, rotationAbout(randomVector(random, 1), 1));
  linearVelocity(state, 0) = randomVector(random, 5);
  angularVelocity(state, 0) = randomVector(random, spin);
  return state;
}

Step stepOf(Integrator integrate, const VectorX& start, double timeStep) {
  const Mechanism mechanism = tumblingBody();
  EquationsOfMotion equations(mechanism);
  const RightHandSide rightHandSide = equations.rightHandSide();
  Step step;
  integrate(rightHandSide, start, 0, timeStep, step);
  prepareInterpolant(rightHandSide, step);
  return step;
}

/// Fastest motion (m per step) of a body's point, over short parts of the step.
double fastest(const Step& step, const Vec3& point) {
  constexpr int kParts = 500;
  double most = 0;
  for (int i = 0; i < kParts; ++i) {
    const double from = double(i) / kParts, to = double(i + 1) / kParts;
    most = std::max(most, (poseAt(step, 0, to) * point - poseAt(step, 0, from) * point).norm() * kParts);
  }
  return most;
}

/// Largest acceleration (m per step squared) of a body's point, by second differences.
double mostBent(const Step& step, const Vec3& point) {
  constexpr int kParts = 500;
  double most = 0;
  for (int i = 1; i < kParts; ++i) {
    const auto at = [&](int k) -> Vec3 { return poseAt(step, 0, double(k) / kParts) * point; };
    most = std::max(most, (at(i + 1) - 2 * at(i) + at(i - 1)).norm() * kParts * kParts);
  }
  return most;
}

/// Random steps: the bound holds for every point, and is no more than `slack` times what is reached.
void expectBound(Integrator integrate, double spin, double timeStep, double slack) {
  std::mt19937 random(1);
  double tightest = 1e9, tightestBend = 1e9;
  for (int i = 0; i < 50; ++i) {
    const Step step = stepOf(integrate, randomState(random, spin), timeStep);
    const Vec3 point = 0.7 * randomVector(random, 1).normalized();
    const double bound = motionBound(step, 0, 0.7), reached = fastest(step, point);
    EXPECT_GE(bound, reached);
    const double bend = motionBounds(step, 0, 0.7).acceleration;
    EXPECT_GE(bend, mostBent(step, point));
    tightestBend = std::min(tightestBend, bend / mostBent(step, point));
    tightest = std::min(tightest, bound / reached);
  }
  EXPECT_LT(tightest, slack);
  EXPECT_LT(tightestBend, 4 * slack);  // the bound of turning alone is 3/2 of its w^2 r, and it is squared
}

TEST(MotionBound, HoldsForTheCubicOfRk4) {
  expectBound(rk4, 5, 0.02, 1.5);
  expectBound(rk4, 20, 0.05, 2);
}

TEST(MotionBound, HoldsForTheInterpolantOfDormandPrince5) {
  expectBound(dormandPrince5, 5, 0.02, 1.5);
  expectBound(dormandPrince5, 20, 0.05, 2);
}

TEST(MotionBound, HoldsForTheInterpolantOfDop853) {
  expectBound(dop853, 5, 0.02, 1.5);
  expectBound(dop853, 20, 0.05, 2);
  expectBound(dop853, 5, 0.3, 3);   // the body turns by 2 rad
  expectBound(dop853, 20, 0.2, 4);  // by 5 rad
}

/// A step whose interpolant is a correction of one component alone: the body ends where it starts, at rest at both
/// ends, and moves in between.
Step bentStep(std::size_t correction, Eigen::Index component, double size) {
  Step step;
  step.timeStep = 1;
  step.startState = VectorX::Zero(stateSize(1));
  setOrientation(step.startState, 0, Quat::Identity());
  step.state = step.startState;
  step.startDerivative = step.endDerivative = VectorX::Zero(stateSize(1));
  step.hasEndDerivative = true;
  step.interpolant = InterpolantKind::degreeSeven;
  step.corrections.fill(VectorX::Zero(stateSize(1)));
  step.corrections[correction][component] = size;
  return step;
}

TEST(MotionBound, CountsTheCorrections) {
  const Vec3 point(0.5, 0, 0);
  for (std::size_t correction = 0; correction < 4; ++correction) {
    const Step moved = bentStep(correction, 1, 1), turned = bentStep(correction, 5, 1e-3);
    // Numbers rounded up, slopes averaged over 1/500 of the step, and for the quaternion its length: below 1e-3.
    for (const Step* step : {&moved, &turned}) {
      const double bound = motionBound(*step, 0, point.norm()), reached = fastest(*step, point);
      EXPECT_GE(bound, reached) << correction;
      EXPECT_LT(bound, 1.001 * reached) << correction;
      // Second differences round a peak at the very end of the step off by one part in 500.
      const double bend = motionBounds(*step, 0, point.norm()).acceleration, bent = mostBent(*step, point);
      EXPECT_GE(bend, bent) << correction;
      EXPECT_LT(bend, 1.02 * bent) << correction;
    }
  }
}

// At rest at both ends, 1 m apart: x = 3 s^2 - 2 s^3 is fastest in the middle, 3/2.
TEST(MotionBound, CountsTheWayBetweenSlowEnds) {
  Step step = bentStep(0, 0, 0);
  step.state[2] += 1;
  EXPECT_DOUBLE_EQ(motionBound(step, 0, 0.5), 1.5);
}

// Nothing bends: the bound is the way itself, h (v + omega x reach). The quaternion's cubic turns evenly up to (h
// omega)^2, and its length is taken 1/4 of its slope too short.
TEST(MotionBound, IsTheWayItselfOfAnEvenMotion) {
  const Mechanism mechanism{Vec3::Zero(), {makeRigidBody({1, Vec3::Zero(), Mat3::Identity()})}, {}, {}, {}};
  EquationsOfMotion equations(mechanism);
  VectorX state = VectorX::Zero(stateSize(1));
  setOrientation(state, 0, Quat::Identity());
  linearVelocity(state, 0) = Vec3(0, 3, 0);
  angularVelocity(state, 0) = Vec3(0, 0, 4);
  const double timeStep = 1e-3, way = timeStep * (3 + 4 * 0.5);
  for (const Integrator integrate : {rk4, dormandPrince5, dop853}) {
    Step step;
    integrate(equations.rightHandSide(), state, 0, timeStep, step);
    prepareInterpolant(equations.rightHandSide(), step);
    EXPECT_GE(motionBound(step, 0, 0.5), way * (1 - 1e-15));
    EXPECT_LT(motionBound(step, 0, 0.5), way * (1 + 2e-3));
  }
}

TEST(PoseAt, AgreesWithTheInterpolatedState) {
  std::mt19937 random(2);
  for (const Integrator integrate : {rk4, dormandPrince5, dop853}) {
    const Step step = stepOf(integrate, randomState(random, 10), 0.1);
    VectorX state;
    interpolate(step, 0.3, state);
    const RigidTransform pose = poseAt(step, 0, 0.3);
    EXPECT_LT((pose * Vec3::Zero() - centerOfMass(state, 0)).norm(), 1e-14);
    EXPECT_LT(
        (pose * Vec3(1, 2, 3) - centerOfMass(state, 0) - orientation(state, 0).normalized() * Vec3(1, 2, 3)).norm(),
        1e-14 * 5);
  }
}

}  // namespace
}  // namespace cradle
