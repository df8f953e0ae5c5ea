#include <gtest/gtest.h>

#include "experiments/experiment.h"

// Reference values: 20 digits from two independent formulations each (elliptic functions and extrapolation of order
// 24).

namespace cradle {
namespace {

/// Torque-free asymmetric body, inertia 1, 2, 3, spun about its intermediate axis: at 1 s.
Scene tumblingBody(const std::string& method) {
  return sceneOf(R"({"schema": "cradle-scene/1", "name": "Tumbling body", "duration": 1, "gravity": [0, 0, 0],
    "output": {"framesPerSecond": 1}, )" +
                 method + R"(,
    "bodies": [{"name": "a", "shape": {"box": {"size": [1, 1, 1]}}, "collision": "none", "mass": 1,
      "inertiaTensor": [[1, 0, 0], [0, 2, 0], [0, 0, 3]], "angularVelocityBody": [0.05, 5, 0.05]}]})");
}
const Quat kTumbledOrientation(-0.80085620989726797578, 0.0088205325449509988830, 0.59766756367361575492,
                               0.036674413520204745584);
const Vec3 kTumbledSpin(0.070771457467042494333, 5.0022600509603018438, -0.10759388317580375127);

double tumblingError(const std::string& method, double timeStep) {
  const BodyState end = endOf(simulate(tumblingBody(methodText(method, timeStep))));
  return std::max(orientationError(end.orientation, kTumbledOrientation),
                  (end.angularVelocity - kTumbledSpin).cwiseAbs().maxCoeff());
}

/// Box hung by a corner from a spring, gravity along -z: at 1 s.
Scene hungBox(const std::string& method, double duration = 1) {
  return sceneOf(
      fmt::format(R"({{"schema": "cradle-scene/1", "name": "Hung box", "duration": {}, "gravity": [0, 0, -9.81],
    "output": {{"framesPerSecond": 1}}, {},
    "bodies": [{{"name": "box", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "collision": "none", "mass": 2,
      "position": [-0.2, -0.1, -0.8]}}],
    "springs": [{{"name": "s", "bodyA": "box", "anchorA": [0.2, 0.1, 0.3], "anchorB": [0, 0, 0], "stiffness": 200,
      "restLength": 0.5}}]}})",
                  duration, method));
}
const Vec3 kHungPosition(0.29330918961669974887, 0.14641265836901917027, -1.0253644109024767643);
const Quat kHungOrientation(0.89083256337691510189, 0.21617899338570866852, -0.39326657372097569250,
                            0.070889977005361321897);

double hungBoxError(const std::string& method, double timeStep) {
  const BodyState end = endOf(simulate(hungBox(methodText(method, timeStep))));
  return std::max((end.position - kHungPosition).cwiseAbs().maxCoeff(),
                  orientationError(end.orientation, kHungOrientation));
}

template <class Error>
double orderOf(const Error& error, const std::string& method, double coarsest) {
  std::vector<double> errors;
  for (int halving = 0; halving < 4; ++halving) errors.push_back(error(method, coarsest / (1 << halving)));
  return measuredOrder(errors);
}

// Over three halvings the next term of the error still bends the slope by a few per cent at these steps.
constexpr double kSmoothOrderTolerance = 0.1;

TEST(ConvergenceOrder, OfATumblingBodyIsTheMethods) {
  EXPECT_NEAR(orderOf(tumblingError, "explicitEuler", 1.0 / 2048), 1, kSmoothOrderTolerance);
  EXPECT_NEAR(orderOf(tumblingError, "semiImplicitEuler", 1.0 / 2048), 1, kSmoothOrderTolerance);
  EXPECT_NEAR(orderOf(tumblingError, "rk4", 1.0 / 64), 4, kSmoothOrderTolerance);
}

TEST(ConvergenceOrder, OfAHungBoxIsTheMethods) {
  EXPECT_NEAR(orderOf(hungBoxError, "explicitEuler", 1.0 / 4096), 1, kSmoothOrderTolerance);
  EXPECT_NEAR(orderOf(hungBoxError, "semiImplicitEuler", 1.0 / 2048), 1, kSmoothOrderTolerance);
  EXPECT_NEAR(orderOf(hungBoxError, "rk4", 1.0 / 128), 4, kSmoothOrderTolerance);
}

// Below about 1e-13 rounding takes over: the coarsest steps are long enough for three halvings above it. The next term
// of the error bends the slope more at such steps.
TEST(ConvergenceOrder, OfDop853WithFixedStepsIsEight) {
  EXPECT_NEAR(orderOf(hungBoxError, "dop853", 1.0 / 8), 8, 0.5);
  EXPECT_NEAR(orderOf(tumblingError, "dop853", 1.0 / 2), 8, 0.5);
}

// Order 4 from step 1/64, where the error is below 1e-2, gives 1e-2 / 16^4 = 1.5e-7 at 1/1024; rounding is far below.
TEST(Rk4, ReachesTheReferences) {
  EXPECT_LT(tumblingError("rk4", 1.0 / 1024), 1e-8);
  EXPECT_LT(hungBoxError("rk4", 1.0 / 1024), 1e-8);
}

// What the spring and gravity do to two lopsided boxes in free flight. RK4 at 1/1000: energy drifts by its own error,
// of order h^4; linear momentum is a linear invariant, kept to rounding by any Runge-Kutta method.
TEST(TwoBodiesOnASpring, KeepEnergyAndMomenta) {
  const Trajectory run = simulate(sceneOf(R"({"schema": "cradle-scene/1", "name": "Two boxes", "duration": 2,
    "gravity": [0, 0, 0], "output": {"framesPerSecond": 10}, )" +
                                          methodText("rk4", 0.001) + R"(,
    "bodies": [
      {"name": "A", "shape": {"box": {"size": [0.2, 0.3, 0.4]}}, "collision": "none", "mass": 1,
       "linearVelocity": [1, 0, 5], "angularVelocityBody": [1, 2, 3]},
      {"name": "B", "shape": {"box": {"size": [0.5, 0.2, 0.3]}}, "collision": "none", "mass": 3,
       "position": [1, 0.5, 0.5], "linearVelocity": [0, 1, 5], "angularVelocityBody": [-2, 1, 0.5]}],
    "springs": [{"bodyA": "A", "anchorA": [0.1, 0.15, 0.2], "bodyB": "B", "anchorB": [-0.25, -0.1, -0.15],
      "stiffness": 50, "restLength": 0.4}]})"));
  const Frame& start = run.frames.front();
  for (const Frame& frame : run.frames) {
    EXPECT_LT((frame.energy.momentum - start.energy.momentum).norm(), 1e-12);
    EXPECT_LT((frame.energy.angularMomentum - start.energy.angularMomentum).norm(), 1e-7);
    EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(start), 1e-7 * energyConstantOf(start));
  }
  EXPECT_GT(std::abs(run.frames.back().energy.kinetic - start.energy.kinetic), 0.1);  // something happened
}

TEST(DampedSpring, DissipatesWhatItTakesFromTheMotion) {
  Scene scene = hungBox(methodText("rk4", 0.001), 3);
  scene.springs[0].damping = 2;
  const Trajectory run = simulate(scene);
  EXPECT_GT(run.frames.back().energy.dissipated, 0.5);
  for (const Frame& frame : run.frames) EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(run.frames[0]), 1e-7);
}

/// A ball on a massless rod of 1 m, released horizontally, at 1 s.
double pendulumError(const std::string& method, double timeStep) {
  const Trajectory run = simulate(sceneOf(R"({"schema": "cradle-scene/1", "name": "Pendulum", "duration": 1,
    "output": {"framesPerSecond": 1}, )" + methodText(method, timeStep) +
                                          R"(,
    "bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.01}}, "mass": 1, "position": [-1, 0, 0]}],
    "rods": [{"name": "bar", "bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}]})"));
  const BodyState end = endOf(run);
  EXPECT_NEAR(end.position.norm(), 1, 1e-14) << "length of the rod";
  EXPECT_NEAR(end.position.dot(end.linearVelocity), 0, 1e-13) << "velocity along the rod";
  return (end.position - Vec3(0.98629175113187531936, -0.16501085312554116875, 0)).norm();
}

TEST(RodPendulum, ConvergesToTheEllipticSolutionWithTheMethodsOrder) {
  EXPECT_NEAR(orderOf(pendulumError, "explicitEuler", 1.0 / 1024), 1, kSmoothOrderTolerance);
  EXPECT_NEAR(orderOf(pendulumError, "semiImplicitEuler", 1.0 / 1024), 1, kSmoothOrderTolerance);
  EXPECT_NEAR(orderOf(pendulumError, "rk4", 1.0 / 128), 4, kSmoothOrderTolerance);
  EXPECT_NEAR(orderOf(pendulumError, "dop853", 1.0 / 8), 8, 0.5);
  EXPECT_LT(pendulumError("rk4", 1.0 / 1024), 1e-10);
}

TEST(TooStiffSpring, StopsTheRunNamingBodySpringAndASafeStep) {
  Scene scene = hungBox(methodText("semiImplicitEuler", 0.01), 10);
  scene.springs[0].stiffness = 1e6;
  try {
    simulate(scene);
    FAIL() << "ran to its end";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    for (const char* word : {"unstable at", "\"box\"", "spring \"s\"", "step x omega", "semi-implicit Euler is 2"})
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in " << error.what();
  }
}

void expectRefusalOfItsSpring(double stiffness, double damping, double mass) {
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 1, "bodies": [{{"name": "a", "shape": {{"sphere": {{"radius": 0.01}}}}, "mass": {}}}],
      "springs": [{{"name": "s", "bodyA": "a", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0], "restLength": 0.5, "stiffness": {},
        "damping": {}}}])",
      mass, stiffness, damping));
  try {
    simulate(scene);
    FAIL() << "ran to its end";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    for (const char* word : {"unstable at", "\"a\"", "spring \"s\"", "less stiffness"})
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in " << error.what();
  }
}

// 1e20 N/m on 1 kg: 1e10 rad/s, of which DOP853 follows 6 rad a step at most.
TEST(SpringBeyondAllMeasure, StopsTheRunSoonAndIsNamed) {
  expectRefusalOfItsSpring(1e20, 0, 1);
  expectRefusalOfItsSpring(1e30, 0, 1);
  expectRefusalOfItsSpring(1, 1e30, 1);
  expectRefusalOfItsSpring(1, 0, 1e-36);
}

}  // namespace
}  // namespace cradle
