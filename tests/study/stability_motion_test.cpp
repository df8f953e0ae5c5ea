// What the maps of drift and of the logistic equation show, against closed forms.

#include <gmock/gmock.h>

#include <cmath>

#include "study/sample_scenes.h"
#include "study/stability/island_steps.h"
#include "study/stability/logistic_equation.h"
#include "study/stability/rotation_drift.h"
#include "study/stability/stability_region.h"
#include "study/stability/tumbling.h"

namespace cradle {
namespace {

// Exact rationals: R11 of tests/experiments/references.json.
TEST(LogisticEquation, StepsAreThoseOfExactArithmetic) {
  const std::vector<double> euler = {
      10, 39.65, 153.09757125, 530.35425287072910703, 1136.9522940996739717, 23.497359693905505362};
  const std::vector<double> kutta = {10,
                                     141.63029004621243278,
                                     648.60187280154227887,
                                     651.92165362429259892,
                                     652.11412349679621478,
                                     652.12788324384224344};
  const std::vector<double> exact = {10,
                                     164.27675231039392995,
                                     708.39088668387532810,
                                     848.27450902210084892,
                                     856.69694418958627528,
                                     857.12064546424603734};
  const auto explicitSteps = logisticSteps(fixedStepMethod("explicitEuler").integrate, 0.5, 5);
  const auto kuttaSteps = logisticSteps(fixedStepMethod("rk4").integrate, 0.5, 5);
  for (std::size_t i = 0; i < euler.size(); ++i) {
    EXPECT_NEAR(explicitSteps[i], euler[i], 1e-12 * euler[i]);  // each step makes rounding at most 5 times larger
    EXPECT_NEAR(kuttaSteps[i], kutta[i], 1e-12 * kutta[i]);
    EXPECT_NEAR(logisticSolution(0.5 * static_cast<double>(i)), exact[i], 1e-13 * exact[i]);
  }
}

TEST(LogisticEquation, Rk4SettlesAtAFalseEquilibriumBeyondItsLimit) {
  const auto settled = [](const char* name, double timeStep) {
    return logisticSteps(fixedStepMethod(name).integrate, timeStep, 400).back();
  };
  EXPECT_NEAR(settled("rk4", 0.5), 652.13, 0.005);
  // The false equilibrium is there a little before the true one is lost.
  EXPECT_NEAR(settled("rk4", 0.97 * decayLimit(fixedStepMethod("rk4")) / kLogisticGrowth), 857.14, 0.005);
  EXPECT_LT(settled("rk4", 1.01 * decayLimit(fixedStepMethod("rk4")) / kLogisticGrowth), 850);
  EXPECT_NEAR(settled("dop853FixedStep", 0.5), 857.14, 0.005);
}

// Only the angle turned in a step counts, whatever the speed.
TEST(Tumbling, GoesWrongBeforeEnergyShowsIt) {
  for (const double speed : {2.0, 50.0}) {
    const auto after = [&](const char* name, double angle) {
      return tumblingOf(speed, fixedStepMethod(name), angle / speed);
    };
    EXPECT_EQ(after("semiImplicitEuler", 0.02), Tumbling::right);
    EXPECT_EQ(after("semiImplicitEuler", 0.1), Tumbling::energyWrong);
    EXPECT_EQ(after("semiImplicitEuler", 1), Tumbling::stopped);
    EXPECT_EQ(after("explicitEuler", 0.1), Tumbling::energyWrong);
    EXPECT_EQ(after("rk4", 0.1), Tumbling::right);
    EXPECT_EQ(after("rk4", 0.5), Tumbling::flipsWrong);
    EXPECT_EQ(after("rk4", 1.5), Tumbling::energyWrong);
    EXPECT_EQ(after("dop853FixedStep", 0.5), Tumbling::right);
    EXPECT_EQ(after("dop853FixedStep", 2), Tumbling::flipsWrong);
  }
}

struct Drift {
  double angle, shape;
};
Drift displacementOf(RotationStorage storage, const Vec3& rotation, bool isExact) {
  TurnedOrientation orientation(storage, rotation, isExact);
  for (int i = 0; i < 1000; ++i) orientation.turn();
  return {orientation.angleError(), orientation.shapeError()};
}

TEST(RotationDrift, OfTheFirstOrderIsThatOfTheory) {
  const double a = 0.01;
  const Vec3 rotation = a * Vec3(2, -1, 2) / 3;
  const Drift matrix = displacementOf(RotationStorage::matrix, rotation, false);
  EXPECT_NEAR(matrix.angle, 1000 * (a - std::atan(a)), 1e-11);
  // R^T R grows by 1 + a^2 a turn across the axis n: its largest entry on the diagonal is where n is least, 1 - 1/9.
  EXPECT_NEAR(matrix.shape, 8.0 / 9 * (std::pow(1 + a * a, 1000) - 1), 1e-11);
  const Drift quaternion = displacementOf(RotationStorage::quaternion, rotation, false);
  EXPECT_NEAR(quaternion.angle, 1000 * (a - 2 * std::atan(a / 2)), 1e-11);
  EXPECT_NEAR(quaternion.shape, std::pow(1 + a * a / 4, 1000) - 1, 1e-11);
}

TEST(RotationDrift, GramSchmidtKeepsTheShapeAndSpoilsTheAngle) {
  // The favoured column c goes from its circle about n towards the plane across it: by a^2 / 2 sin cos a turn, of the
  // angle between c and n. With the first axis of the body at (2/3, ...) from n that is 0.000025 at first.
  const Vec3 rotation = 0.01 * Vec3(2, -1, 2) / 3;
  const Drift drift = displacementOf(RotationStorage::orthogonalisedMatrix, rotation, false);
  EXPECT_LT(drift.shape, 1e-15);
  EXPECT_NEAR(drift.angle, 1000 * 0.5e-4 * (2.0 / 3) * std::sqrt(5.0) / 3, 0.1 * drift.angle);
  EXPECT_LT(displacementOf(RotationStorage::normalizedQuaternion, rotation, false).shape, 1e-15);
}

TEST(RotationDrift, OfExactProductsIsRounding) {
  for (const auto storage : {RotationStorage::matrix, RotationStorage::orthogonalisedMatrix,
                             RotationStorage::quaternion, RotationStorage::normalizedQuaternion})
    EXPECT_LT(displacementOf(storage, Vec3(0.003, 0.007, -0.002), true).angle, 1000 * 1e-15);
}

TEST(RotationDrift, EulerAnglesLoseTheirWayPastGimbalLock) {
  EXPECT_LT(displacementOf(RotationStorage::eulerAngles, Vec3(0, 0, 0.003), false).angle, 1e-12);  // yaw alone is exact
  const double near = displacementOf(RotationStorage::eulerAngles, Vec3(6e-6, 0.003, 0), false).angle;
  const double far = displacementOf(RotationStorage::eulerAngles, Vec3(6e-4, 0.003, 0), false).angle;
  EXPECT_GT(near, 0.002);
  EXPECT_LT(far, 0.5 * near);
}

/// Error (m) of the length of a pendulum's rod after 2 s.
double rodError(const char* method, double timeStep, bool projects) {
  const Scene scene = sceneOf(
      R"({"schema": "cradle-scene/1", "name": "rod", "duration": 2,
      "bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [1, 0, 0]}],
      "rods": [{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}]})");
  IslandSteps steps(scene, fixedStepMethod(method).integrate, timeStep, projects);
  while (steps.time() < 2 - timeStep / 2) steps.advance();
  return std::abs(centerOfMass(steps.state(), 0).norm() - 1);
}

TEST(RodDrift, FallsWithTheOrderOfTheMethodAndVanishesByProjection) {
  for (const FixedStepMethod& method : fixedStepMethods()) {
    EXPECT_LT(rodError(method.name.c_str(), 0.02, true), 1e-15) << method.name;
    EXPECT_GT(rodError(method.name.c_str(), 0.02, false), 1e-14) << method.name;
  }
  EXPECT_NEAR(std::log2(rodError("semiImplicitEuler", 0.01, false) / rodError("semiImplicitEuler", 0.005, false)), 1,
              0.2);
  EXPECT_NEAR(std::log2(rodError("rk4", 0.04, false) / rodError("rk4", 0.02, false)), 4, 0.5);
}

}  // namespace
}  // namespace cradle
