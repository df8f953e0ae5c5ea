#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/experiment.h"

namespace cradle {
namespace {

/// A ball on a rope of 1 m, thrown down beside its anchor: falls, goes taut, swings, goes slack, and so on.
Trajectory throwBall(const std::string& method, double restitution = 0) {
  return simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Rope", "duration": 2,
    "output": {{"framesPerSecond": 1}}, {},
    "bodies": [{{"name": "ball", "shape": {{"sphere": {{"radius": 0.01}}}}, "collision": "none", "mass": 1,
      "position": [0.9, 0, 0], "linearVelocity": [0, -2, 0]}}],
    "ropes": [{{"name": "rope", "bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "maxLength": 1,
      "restitution": {}}}]}})",
                                      method, restitution)));
}

// Reference: free flight in closed form and the pendulum by quadrature, 20 digits.
constexpr double kFirstTaut = 0.15727856536060116689, kFirstImpulse = 1.5443154950246054845;
constexpr double kFirstSlack = 0.95883195443785861301, kSecondTaut = 1.2575584218549062059;

double slackTimeError(double timeStep) {
  const Trajectory run = throwBall(methodText("rk4", timeStep));
  return std::abs(run.events.at(1).time - kFirstSlack);
}

TEST(Rope, GoesTautAndSlackWhenTheReferenceDoes) {
  const Trajectory run = throwBall(methodText("rk4", 0.001));
  ASSERT_GE(run.events.size(), 3u);
  EXPECT_EQ(run.events[0].kind, EventKind::taut);
  EXPECT_EQ(run.events[1].kind, EventKind::slack);
  EXPECT_EQ(run.events[2].kind, EventKind::taut);
  // RK4 is exact in free flight; the event is found to 1e-13 m.
  EXPECT_NEAR(run.events[0].time, kFirstTaut, 1e-12);
  EXPECT_NEAR(run.events[0].impulse, kFirstImpulse, 1e-11);
  EXPECT_EQ(run.events[0].bodyB, -1);
  EXPECT_LT((run.events[0].point - Vec3(0.9, -0.43588989435406735522, 0)).norm(), 1e-11);
  // Order 4 in between: 1e-9 at this step, with a margin.
  EXPECT_NEAR(run.events[1].time, kFirstSlack, 1e-8);
  EXPECT_NEAR(run.events[2].time, kSecondTaut, 1e-8);
}

TEST(Rope, LocatesTheEndOfTensionWithTheMethodsOrder) {
  EXPECT_NEAR(measuredOrder({slackTimeError(1.0 / 64), slackTimeError(1.0 / 128), slackTimeError(1.0 / 256)}), 4, 0.3);
}

TEST(Rope, IsNeverLongerThanItIsAndKeepsTheEnergyAccount) {
  for (const char* method : {"explicitEuler", "semiImplicitEuler", "rk4"}) {
    const Trajectory run = throwBall(methodText(method, 0.0005));
    for (const Frame& frame : run.frames) EXPECT_LE(frame.states[0].position.norm(), 1 + 1e-12) << method;
    // The impulse takes half the square of the radial speed, per mass.
    EXPECT_NEAR(run.frames[1].energy.dissipated, 0.5 * kFirstImpulse * kFirstImpulse,
                method == std::string("rk4") ? 1e-11 : 2e-2)
        << method;
  }
}

// Restitution e sends the radial velocity back: v_r' = -e v_r, so the impulse is (1 + e) times the inelastic one.
TEST(Rope, ReboundsWithItsRestitution) {
  const Trajectory run = throwBall(methodText("rk4", 0.001), 0.5);
  EXPECT_NEAR(run.events[0].time, kFirstTaut, 1e-12);
  EXPECT_NEAR(run.events[0].impulse, 1.5 * kFirstImpulse, 1e-11);
}

// Two balls in free flight tied by a rope: taut, they turn about their centre of mass, which moves on undisturbed.
TEST(Rope, BetweenTwoBodiesKeepsTheirMomentum) {
  const Trajectory run = simulate(sceneOf(R"({"schema": "cradle-scene/1", "name": "Bolas", "duration": 2,
    "gravity": [0, 0, 0], "output": {"framesPerSecond": 10}, )" +
                                          methodText("rk4", 0.001) + R"(,
    "bodies": [{"name": "a", "shape": {"sphere": {"radius": 0.05}}, "mass": 1, "linearVelocity": [1, 2, 0]},
      {"name": "b", "shape": {"sphere": {"radius": 0.05}}, "mass": 3, "position": [0.6, 0, 0],
       "linearVelocity": [2, -1, 0.5]}],
    "ropes": [{"bodyA": "a", "anchorA": [0, 0.05, 0], "bodyB": "b", "anchorB": [-0.05, 0, 0], "maxLength": 1}]})"));
  ASSERT_GE(run.events.size(), 1u);
  EXPECT_EQ(run.events[0].kind, EventKind::taut);
  const Frame& start = run.frames.front();
  for (const Frame& frame : run.frames) {
    EXPECT_LT((frame.energy.momentum - start.energy.momentum).norm(), 1e-12);
    EXPECT_LT((frame.energy.angularMomentum - start.energy.angularMomentum).norm(), 1e-6);
    EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(start), 1e-6);
  }
  const Frame& end = run.frames.back();
  const Vec3 tieA = end.states[0].position + end.states[0].orientation * Vec3(0, 0.05, 0);
  const Vec3 tieB = end.states[1].position + end.states[1].orientation * Vec3(-0.05, 0, 0);
  EXPECT_LE((tieA - tieB).norm(), 1 + 1e-12);
}

}  // namespace
}  // namespace cradle
