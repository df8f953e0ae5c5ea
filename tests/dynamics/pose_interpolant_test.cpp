#include "dynamics/integrators/pose_interpolant.h"

#include <gtest/gtest.h>

#include <random>

#include "dynamics/equations_of_motion.h"
#include "dynamics/integrators/dop853.h"
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

/// Random steps: the bound holds for every point, and is no more than `slack` times what is reached.
void expectBound(Integrator integrate, double spin, double timeStep, double slack) {
  std::mt19937 random(1);
  double tightest = 1e9;
  for (int i = 0; i < 50; ++i) {
    const Step step = stepOf(integrate, randomState(random, spin), timeStep);
    const Vec3 point = 0.7 * randomVector(random, 1).normalized();
    const double bound = motionBound(step, 0, 0.7), reached = fastest(step, point);
    EXPECT_GE(bound, reached);
    tightest = std::min(tightest, bound / reached);
  }
  EXPECT_LT(tightest, slack);
}

TEST(MotionBound, HoldsForTheCubicOfRk4) {
  expectBound(rk4, 5, 0.02, 4);
  expectBound(rk4, 20, 0.05, 4);
}

TEST(MotionBound, HoldsForTheInterpolantOfDop853) {
  expectBound(dop853, 5, 0.02, 4);
  expectBound(dop853, 20, 0.05, 4);
  expectBound(dop853, 5, 0.3, 6);   // the body turns by 2 rad
  expectBound(dop853, 20, 0.2, 8);  // by 5 rad
}

// A motion that is a correction alone: the body ends where it starts, at rest at both ends, and goes by 1/16 of each
// correction's basis function in between.
TEST(MotionBound, CountsTheCorrections) {
  for (std::size_t correction = 0; correction < 4; ++correction) {
    Step step;
    step.timeStep = 1;
    step.startState = VectorX::Zero(stateSize(1));
    setOrientation(step.startState, 0, Quat::Identity());
    step.state = step.startState;
    step.startRate = step.endRate = VectorX::Zero(stateSize(1));
    step.hasEndRate = true;
    step.interpolant = InterpolantKind::degreeSeven;
    step.corrections.fill(VectorX::Zero(stateSize(1)));
    step.corrections[correction][1] = 1;
    const double bound = motionBound(step, 0, 0.5), reached = fastest(step, Vec3(0.5, 0, 0));
    EXPECT_GE(bound, reached) << correction;
    EXPECT_LT(bound, 1.001 * reached) << correction;
  }
}

TEST(PoseAt, AgreesWithTheInterpolatedState) {
  std::mt19937 random(2);
  for (const Integrator integrate : {rk4, dop853}) {
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
