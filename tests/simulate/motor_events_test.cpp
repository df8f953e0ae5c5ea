#include "simulate/motor_events.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/invariants.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/rk4.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using Mode = JointMotor::Mode;

// The scene's motors below turn or push a cube of 2 kg, 2/60 (0.3^2 + 0.3^2) = 0.03 kg m^2 about its middle.
constexpr double kWheelMass = 2, kWheelInertia = 0.03, kWheelTorque = 0.6;

std::string wheel(const std::string& name, double x) {
  return fmt::format(R"({{"name": "{}", "mass": 2, "shape": {{"box": {{"size": [0.3, 0.3, 0.3]}}}},
    "collision": "none", "position": [{}, 0, 0]}})",
                     name, x);
}

std::string hingeOf(const std::string& name, double x, const std::string& motor) {
  return fmt::format(R"({{"bodyA": "{}", "anchorB": [{}, 0, 0], "motor": {{{}}}}})", name, x, motor);
}

std::string targetOf(double velocity, double torque = kWheelTorque) {
  return fmt::format(R"("targetVelocity": {}, "maxTorque": {})", velocity, torque);
}

/// A wheel that a motor turns about z, without gravity.
OneIsland turned(const std::string& motor) {
  return OneIsland(fmt::format(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [{}], "hinges": [{}])",
                               wheel("wheel", 0), hingeOf("wheel", 0, motor)));
}

void takeMotorStep(IslandState& island, double length) {
  rk4(island.rightHandSide, island.state, 0, length, island.step);
  prepareInterpolant(island.rightHandSide, island.step);
}

// A torque T takes a wheel from rest to w at I w / T, and a motor looks for the instant at which it is past that by
// 1e-9 of the largest velocity that it misses, w. The velocity grows evenly, so that chords have no error.
TEST(MotorEvents, FindWhereAWheelComesToItsTarget) {
  for (const double target : {8.0, -8.0}) {
    OneIsland at = turned(targetOf(target));
    MotorEvents motors(at.island);
    EXPECT_TRUE(motors.any());
    motors.resolve(std::nullopt);
    takeMotorStep(at.island, 0.5);
    const auto change = motors.firstChange(at.island.step);
    ASSERT_TRUE(change);
    EXPECT_EQ(change->motor, 0u);
    EXPECT_NEAR(change->fraction, kWheelInertia * 8 / kWheelTorque / 0.5 * (1 + 1e-9), 1e-14);
    VectorX state = at.state();
    angularVelocity(state, 0).z() = 0.75 * target;
    EXPECT_NEAR(motors.margin(*change, state), 0.25 + 1e-9, 1e-15);
    takeMotorStep(at.island, 0.39);
    EXPECT_FALSE(motors.firstChange(at.island.step));
  }
}

TEST(MotorEvents, AreInTheOrderOfTime) {
  OneIsland at(fmt::format(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [{}, {}], "hinges": [{}, {}])",
                           wheel("one", 0), wheel("two", 1), hingeOf("one", 0, targetOf(8)),
                           hingeOf("two", 1, targetOf(-6))));
  MotorEvents motors(at.island);
  motors.resolve(std::nullopt);
  takeMotorStep(at.island, 0.5);
  const auto change = motors.firstChange(at.island.step);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->motor, 1u);
  EXPECT_NEAR(change->fraction, kWheelInertia * 6 / kWheelTorque / 0.5, 1e-8);
}

// A motor with F moves a body at v against a spring, with the force k v t: up to F / (k v).
TEST(MotorEvents, FindWhereHoldingTakesAllOfTheForce) {
  for (const double side : {1.0, -1.0}) {
    OneIsland at(fmt::format(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [{}],
      "sliders": [{{"bodyA": "box", "anchorB": [0, 0, 0], "axis": [{}, 0, 0],
        "motor": {{"targetVelocity": {}, "maxForce": 20}}}}],
      "springs": [{{"bodyA": "box", "anchorB": [-1, 0, 0], "stiffness": 50, "restLength": 1}}])",
                             wheel("box", 0), side, side * 0.5));
    linearVelocity(at.state(), 0).x() = 0.5;
    MotorEvents motors(at.island);
    EXPECT_TRUE(motors.resolve(std::nullopt));
    EXPECT_EQ(at.mechanism().motors[0].mode, Mode::holds);
    takeMotorStep(at.island, 1);
    const auto change = motors.firstChange(at.island.step);
    ASSERT_TRUE(change);
    EXPECT_NEAR(change->fraction, 20 / (50 * 0.5), 1e-13);
    VectorX state = at.state();
    centerOfMass(state, 0).x() = 0.3;
    EXPECT_NEAR(motors.margin(*change, state), (20 - 50 * 0.3) / 20, 1e-13);
  }
}

// All of a force F against a spring gives a velocity of V sin(w t), V = F w / k: it passes a target of 0.9 V and is
// below it again at the end of a step from w t = 1 to 2.1. The instant is that of a chord over the first quarter of the
// step; the interpolant of degree 7 has an error of (w h)^8 / 8! of V at most, 5e-5.
TEST(MotorEvents, FindTargetsThatAreAtTheEndOutOfReachAgain) {
  const double rate = 5, place = 20.0 / 50, most = place * rate;  // w of 50 N/m and 2 kg; F / k
  OneIsland at(fmt::format(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [{}],
    "sliders": [{{"bodyA": "box", "anchorB": [0, 0, 0], "axis": [1, 0, 0],
      "motor": {{"targetVelocity": {}, "maxForce": 20}}}}],
    "springs": [{{"bodyA": "box", "anchorB": [-1, 0, 0], "stiffness": 50, "restLength": 1}}])",
                           wheel("box", 0), 0.9 * most));
  centerOfMass(at.state(), 0).x() = place * (1 - std::cos(1)), linearVelocity(at.state(), 0).x() = most * std::sin(1);
  dop853(at.island.rightHandSide, at.state(), 0, 1.1 / rate, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  MotorEvents motors(at.island);
  const auto change = motors.firstChange(at.island.step);
  ASSERT_TRUE(change);
  const double start = std::sin(1), quarter = std::sin(1 + 1.1 / 4);
  EXPECT_NEAR(change->fraction, (0.9 - start) / (quarter - start) / 4, 5e-5 / (quarter - start) / 4);
}

// Off its target a motor pushes towards it, as often as it is asked; at it, it holds.
TEST(MotorEvents, PushTowardsTheTargetAndHoldAtIt) {
  for (const double target : {8.0, -8.0}) {
    OneIsland at = turned(targetOf(target));
    MotorEvents motors(at.island);
    const JointMotor& motor = at.mechanism().motors[0];
    motors.resolve(std::nullopt);
    EXPECT_EQ(motor.mode, Mode::pushes);
    EXPECT_EQ(motor.sign, target < 0 ? -1 : 1);
    EXPECT_FALSE(motors.resolve(std::nullopt));
    angularVelocity(at.state(), 0).z() = target;
    EXPECT_TRUE(motors.resolve(std::nullopt));
    EXPECT_EQ(motor.mode, Mode::holds);
    EXPECT_FALSE(motors.resolve(std::nullopt));
    angularVelocity(at.state(), 0).z() = 1.5 * target;  // as an impact may leave it
    EXPECT_TRUE(motors.resolve(std::nullopt));
    EXPECT_EQ(motor.mode, Mode::pushes);
    EXPECT_EQ(motor.sign, target < 0 ? 1 : -1);
    EXPECT_EQ(angularVelocity(at.state(), 0).z(), 1.5 * target);
    EXPECT_EQ(pushWork(at.state()), 0);
  }
}

// What the search for the instant leaves is taken out, and booked as the motor's work, I (w^2 - w'^2) / 2. Another
// motor that is as far off pushes. Energies of 0.96 J have a rounding of 1e-16 J.
TEST(MotorEvents, BringTheOneThatHasComeToItsTarget) {
  const double target = 8, late = target * (1 + 1e-9);
  for (const bool isReached : {true, false}) {
    OneIsland at = turned(targetOf(target));
    MotorEvents motors(at.island);
    angularVelocity(at.state(), 0).z() = late;
    motors.resolve(isReached ? std::optional(MotorChange{0.5, 0}) : std::nullopt);
    EXPECT_EQ(at.mechanism().motors[0].mode, isReached ? Mode::holds : Mode::pushes);
    EXPECT_NEAR(angularVelocity(at.state(), 0).z(), isReached ? target : late, 2e-15);
    const double work = kWheelInertia / 2 * (target - late) * (target + late);
    EXPECT_NEAR(pushWork(at.state()), isReached ? work : 0, 1e-15);
  }
}

// An arm of r = 0.5 m is level as long as its motor has more than m g r. One that holds needs no more than that; one
// that pushes against the load already, or has just come to the end of its force, needs 1e-6 more.
TEST(MotorEvents, HoldLoadsUpToTheirForce) {
  const double moment = kWheelMass * kGravity * 0.5;
  const auto modeOf = [&](double part, Mode before, const std::optional<MotorChange>& change) {
    OneIsland at(fmt::format(R"("duration": 9, "bodies": [{}], "hinges": [{{"bodyA": "arm", "anchorA": [-0.5, 0, 0],
      "anchorB": [-0.5, 0, 0], "motor": {{{}}}}}])",
                             wheel("arm", 0), targetOf(0, part * moment)));
    at.mechanism().motors[0].mode = before;
    MotorEvents motors(at.island);
    motors.resolve(change);
    EXPECT_EQ(at.mechanism().motors[0].sign, 1);  // against the weight
    return at.mechanism().motors[0].mode;
  };
  const MotorChange end{0.5, 0};
  EXPECT_EQ(modeOf(1 - 1e-9, Mode::holds, std::nullopt), Mode::pushes);
  EXPECT_EQ(modeOf(1 + 1e-9, Mode::holds, std::nullopt), Mode::holds);
  EXPECT_EQ(modeOf(1 + 0.9e-6, Mode::holds, end), Mode::pushes);
  EXPECT_EQ(modeOf(1 + 1.1e-6, Mode::holds, end), Mode::holds);
  EXPECT_EQ(modeOf(1 + 0.9e-6, Mode::pushes, std::nullopt), Mode::pushes);
  EXPECT_EQ(modeOf(1 + 1.1e-6, Mode::pushes, std::nullopt), Mode::holds);
}

TEST(MotorEvents, AreNoneOfConstantForcesAndOfMotorsWithoutAny) {
  OneIsland constant = turned(R"("torque": -0.6)");
  MotorEvents ofConstant(constant.island);
  EXPECT_FALSE(ofConstant.any());
  EXPECT_FALSE(ofConstant.resolve(std::nullopt));
  EXPECT_EQ(constant.mechanism().motors[0].sign, -1);
  // It falls past the velocity that a motor without force would have it keep.
  OneIsland idle(fmt::format(R"("duration": 9, "bodies": [{}], "sliders": [{{"bodyA": "box", "anchorB": [0, 0, 0],
    "axis": [0, -1, 0], "motor": {{"targetVelocity": 2, "maxForce": 0}}}}])",
                             wheel("box", 0)));
  MotorEvents ofIdle(idle.island);
  takeMotorStep(idle.island, 1);
  EXPECT_LT(linearVelocity(idle.island.step.state, 0).y(), -2);
  EXPECT_FALSE(ofIdle.firstChange(idle.island.step));
}

TEST(MotorEvents, AreNoneOfBodiesAtRest) {
  OneIsland at = turned(targetOf(-8));
  MotorEvents motors(at.island);
  at.mechanism().motors[0].sign = -1;
  takeMotorStep(at.island, 0.5);
  ASSERT_TRUE(motors.firstChange(at.island.step));
  at.island.equations.setResting(0, true);
  EXPECT_FALSE(motors.firstChange(at.island.step));
  angularVelocity(at.state(), 0).z() = -8;
  EXPECT_FALSE(motors.resolve(std::nullopt));
  EXPECT_EQ(at.mechanism().motors[0].mode, Mode::pushes);
}

}  // namespace
}  // namespace cradle
