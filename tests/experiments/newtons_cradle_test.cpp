#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "experiments/experiment.h"

// Five touching balls, each on two rods of one plane across the row: pendulums of 0.5 m. One, two or three are lifted
// by 30 degrees. As many as come in leave at the other end, the others hang still. References: elliptic functions, 20
// digits.

namespace cradle {
namespace {

constexpr double kLength = 0.5, kRadius = 0.025;  // m
constexpr int kBalls = 5;

std::string ballText(int ball, bool isLifted) {
  const double angle = isLifted ? -std::numbers::pi / 6 : 0, pivot = 2 * kRadius * ball;
  return fmt::format(R"({{"name": "ball{}", "shape": {{"sphere": {{"radius": {}}}}}, "mass": 0.1, "material": "steel",
    "position": [{:.17g}, {:.17g}, 0]}})",
                     ball, kRadius, pivot + kLength * std::sin(angle), -kLength * std::cos(angle));
}

std::string rodText(int ball, double side) {
  return fmt::format(R"({{"bodyA": "ball{}", "anchorA": [0, 0, 0], "anchorB": [{:.17g}, 0, {}]}})", ball,
                     2 * kRadius * ball, side);
}

/// 10 s of the cradle with the method of the plan, 20 frames a second.
Trajectory swing(int lifted) {
  std::vector<std::string> bodies, rods;
  for (int ball = 0; ball < kBalls; ++ball) {
    bodies.push_back(ballText(ball, ball < lifted));
    for (const double side : {0.2, -0.2}) rods.push_back(rodText(ball, side));
  }
  return simulate(
      sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Cradle", "duration": 10, "accuracy": 1e-10,
    "gravity": [0, -9.81, 0], "output": {{"framesPerSecond": 20}},
    "materials": {{"steel": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}}},
    "bodies": [{}], "rods": [{}]}})",
                          fmt::join(bodies, ", "), fmt::join(rods, ", "))));
}

double angleOf(const Frame& frame, int ball) {
  const Vec3& position = frame.states[static_cast<std::size_t>(ball)].position;
  return std::atan2(position.x() - 2 * kRadius * ball, -position.y());
}

double turningOf(const Frame& frame, int ball) {
  const double angle = angleOf(frame, ball);
  const Vec3& velocity = frame.states[static_cast<std::size_t>(ball)].linearVelocity;
  return velocity.dot(Vec3(std::cos(angle), std::sin(angle), 0)) / kLength;
}

/// Angle (rad) and angular velocity (rad/s) of the balls that swing.
struct Swing {
  std::size_t frame;
  bool isFirstSide;  // the side that was lifted
  double angle, turning;
};
const std::array kSwings{Swing{5, true, -0.24400104078479672080, 2.0235712973452142363},
                         Swing{10, false, 0.29941701399378028852, 1.8738519279237865424},
                         Swing{20, false, 0.18476766276992912761, -2.1422552634344917896},
                         Swing{40, false, 0.39550530603813952871, 1.4926197306641383582},
                         Swing{100, false, 0.51079219300982308960, 0.49846923900076386114}};

// RK4 with steps of 1/960 s turns a pendulum of w = 4.4 rad/s with an error of (w h)^4 / 120 = 4e-12 a radian: 1e-10
// rad after 5 s, and w times that in rad/s. Each impact is placed to 1e-12 of a ball's size: nothing beside it.
constexpr double kSwingError = 1e-9;
constexpr double kStill = 1e-9;  // rad, rad/s

void expectSwing(const Frame& frame, const Swing& swing, int lifted) {
  for (int ball = 0; ball < kBalls; ++ball) {
    const bool swings = swing.isFirstSide ? ball < lifted : ball >= kBalls - lifted;
    const double angle = swings ? swing.angle : 0, turning = swings ? swing.turning : 0;
    EXPECT_NEAR(angleOf(frame, ball), angle, swings ? kSwingError : kStill) << ball << " at " << frame.time;
    EXPECT_NEAR(turningOf(frame, ball), turning, swings ? kSwingError : kStill) << ball << " at " << frame.time;
  }
}

TEST(NewtonsCradle, ThrowsOutAsManyBallsAsFallIn) {
  for (const int lifted : {1, 2, 3}) {
    const Trajectory run = swing(lifted);
    for (const Swing& swing : kSwings) expectSwing(run.frames[swing.frame], swing, lifted);
  }
}

TEST(NewtonsCradle, KeepsItsEnergyForTenSeconds) {
  for (const int lifted : {1, 2, 3}) {
    const Trajectory run = swing(lifted);
    const double scale = lifted * 0.1 * 9.81 * kLength * (1 - std::cos(std::numbers::pi / 6));  // J
    const EnergyBalance &start = run.frames.front().energy, &end = run.frames.back().energy;
    EXPECT_NEAR(end.kinetic + end.potential, start.kinetic + start.potential, 1e-8 * scale) << lifted;
  }
}

// Balls that swing side by side touch without a load: rounding of their gaps makes no events, and no more steps.
TEST(NewtonsCradle, BallsThatSwingTogetherCostNoMoreThanOne) {
  EXPECT_LT(static_cast<double>(swing(3).cost.evaluations), 1.05 * static_cast<double>(swing(1).cost.evaluations));
}

}  // namespace
}  // namespace cradle
