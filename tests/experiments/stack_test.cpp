#include <gtest/gtest.h>

#include "experiments/experiment.h"

// Stacks and other groups of many contacts, moved by the contact step.

namespace cradle {
namespace {

std::string cube(int number, double mass, double height) {
  return fmt::format(R"({{"name": "cube{}", "shape": {{"box": {{"size": [1, 1, 1]}}}}, "mass": {}, "material": "m",
      "position": [0, {:.17g}, 0]}})",
                     number, mass, height);
}

/// Ten cubes of 1 m and 1 kg above each other on a box, `gap` (m) apart, the highest of mass `top` (kg).
Trajectory runStack(double gap, double top, double duration) {
  std::string cubes;
  for (int i = 0; i < 10; ++i) cubes += ", " + cube(i, i == 9 ? top : 1, 0.5 + gap + i * (1 + gap));
  return simulate(
      sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Stack", "duration": {}, "accuracy": 1e-3,
    "materials": {{"m": {{"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.5}}}},
    "bodies": [{{"name": "ground", "motion": "static", "material": "m", "position": [0, -0.5, 0],
      "shape": {{"box": {{"size": [10, 1, 10]}}}}}}{}]}})",
                          duration, cubes)));
}

TEST(Stack, DroppedComesToRestAndStandsAlsoUnderAHeavyTop) {
  for (const double top : {1.0, 1000.0}) {
    const Trajectory run = runStack(0.01, top, 0.4);
    const Frame& end = run.frames.back();
    EXPECT_EQ(end.energy.kinetic, 0) << top;
    for (std::size_t i = 0; i < 10; ++i) {
      // Overlaps beyond 1e-9 of a cube's size (0.87 m) are taken out at each of ten contacts; sliding on impact is less
      // than what edges that meet off their middle give.
      EXPECT_NEAR(end.states[i].position.y(), 0.5 + static_cast<double>(i), 1e-8) << top << " " << i;
      EXPECT_LT(std::hypot(end.states[i].position.x(), end.states[i].position.z()), 1e-4) << top << " " << i;
    }
    double before = INFINITY;
    for (const Frame& frame : run.frames) {
      const double energy = frame.energy.kinetic + frame.energy.potential;
      EXPECT_LT(energy, before + 1e-12 * top * 100);
      before = energy;
    }
  }
}

TEST(Stack, ThatTouchesRestsAtOnce) {
  const Trajectory run = runStack(0, 1000, 0.1);
  EXPECT_EQ(run.cost.evaluations, 1);
  EXPECT_EQ(run.frames.back().states[9].position, Vec3(0, 9.5, 0));
}

// Soft contacts give by a part of the size: each of ten layers by the load of those above over its stiffness m w^2, w =
// 2 pi 100/s for bodies of 30 mm (4 points), together 55 g/w^2 = 1.4 mm, and half as much again while it settles; that
// is 0.07 of the size there, and of any smaller one. Nothing goes sideways.
TEST(Towers, OfSmallBoxesStand) {
  for (const double size : {0.002, 0.005, 0.01, 0.02, 0.03}) {
    const Trajectory run = simulate(
        sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Towers", "duration": 2, "accuracy": "visual",
      "materials": {{"m": {{"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.5}}}},
      "bodies": [{{"name": "floor", "motion": "static", "material": "m", "shape": {{"plane": {{}}}}}},
        {{"name": "b", "shape": {{"box": {{"size": [{0}, {0}, {0}]}}}}, "mass": {1:.17g}, "material": "m",
          "position": [0, {2:.17g}, 0], "copies": {{"count": [3, 10, 3], "spacing": [{3:.17g}, {0}, {3:.17g}]}}}}]}})",
                            size, 1000 * size * size * size, size / 2, 3 * size)));
    const std::vector<BodyState>&starts = run.frames.front().states, &ends = run.frames.back().states;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const Vec3 way = ends[i].position - starts[i].position;
      EXPECT_LT(std::hypot(way.x(), way.z()), 1e-6 * size) << size << " " << i;
      EXPECT_LT(std::abs(way.y()), 0.07 * size) << size << " " << i;
    }
  }
}

// Twelve turned bricks of very different masses drop onto each other, with more friction than Newton's restitution
// agrees with. No step may gain energy, in a heap that chatters and slides: rounding, and an error of order 4 in their
// flight.
TEST(Heap, OfTurnedBricksNeverGainsEnergy) {
  std::string bricks;
  for (int i = 0; i < 12; ++i)
    bricks += fmt::format(R"(, {{"name": "b{0}", "shape": {{"box": {{"size": [0.3, {1}, 0.2]}}}}, "mass": {2},
        "material": "m", "position": [{3}, {4}, {5}], "orientation": {{"axis": [1, 2, {6}], "angleDegrees": {7}}},
        "angularVelocity": [{8}, 1, -2]}})",
                          i, 0.1 + 0.05 * (i % 3), 1 + i % 4 * 3, 0.1 * (i % 3), 0.3 + 0.32 * i, 0.07 * (i % 2),
                          i % 5 - 2, 37 * i, i % 3);
  for (const double restitution : {0.0, 0.5}) {
    const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 0.9, "output": {{"framesPerSecond": 960}}, {},
        "materials": {{"m": {{"restitution": {}, "staticFriction": 1, "dynamicFriction": 0.8}}}},
        "bodies": [{{"name": "floor", "motion": "static", "material": "m", "shape": {{"plane": {{}}}}}}{}])",
                                                          methodText("rk4", 1.0 / 960), restitution, bricks)));
    double before = INFINITY;
    for (const Frame& frame : run.frames) {
      const double energy = frame.energy.kinetic + frame.energy.potential;  // J, of 1500 at the start
      EXPECT_LT(energy - before, 1e-9) << restitution << " " << frame.time;
      before = energy;
    }
  }
}

// A stack that lasts, and balls that rain on the floor around it, more in each step than steps are cut for. Between
// steps, too, all energy is accounted for, and none comes back: a rebound has no middle. A ball that strikes within a
// step is where it would be had it struck at its end: off by m g times (1 + e) 4 m/s times a step, 0.07 J, at most.
TEST(Heap, AccountsForItsEnergyBetweenSteps) {
  std::string bodies;
  for (int i = 0; i < 3; ++i)
    bodies += fmt::format(R"(, {{"name": "s{0}", "shape": {{"box": {{"size": [0.4, 0.4, 0.4]}}}}, "mass": 1,
        "material": "m", "position": [0, {1}, 0], "angularVelocity": [0.1, 0, 0]}})",
                          i, 0.2 + 0.4 * i);
  for (int i = 0; i < 12; ++i)
    bodies += fmt::format(R"(, {{"name": "b{0}", "shape": {{"sphere": {{"radius": 0.05}}}}, "mass": 1, "material": "m",
        "position": [{1}, {2}, {3}], "linearVelocity": [0, -4, 0]}})",
                          i, i % 4 - 1.5, 0.2 + 0.0004 * i, i / 4 - 1 + (i / 4 == 1 ? 0.4 : 0.0));
  const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 0.08, "output": {{"framesPerSecond": 7000}}, {},
        "materials": {{"m": {{"restitution": 0.8, "staticFriction": 0.5, "dynamicFriction": 0.5}}}},
        "bodies": [{{"name": "floor", "motion": "static", "material": "m", "shape": {{"plane": {{}}}}}}{}])",
                                                        methodText("rk4", 1.0 / 960), bodies)));
  double before = INFINITY;
  for (const Frame& frame : run.frames) {
    EXPECT_NEAR(ledgerConstantOf(frame), ledgerConstantOf(run.frames[0]), 1e-9) << frame.time;
    const double energy = frame.energy.kinetic + frame.energy.potential;
    EXPECT_LT(energy, before + 0.05) << frame.time;
    before = energy;
  }
}

// A box of 10 kg on a floor, pushed diagonally, under 25 balls of 1 kg that roll on it: a = (F - mu (M + n m) g) / (M +
// 2 n m / 7), the balls follow with 2/7 of it. Forces are constant, so that velocities are exact but for forces
// that are solved to 1e-7 of the largest acceleration, 10.6 m/s^2, over 0.5 s.
TEST(TrayOfBalls, IsPushedDiagonallyWithTheAccelerationOfTheClosedForm) {
  std::string balls;
  for (int i = 0; i < 25; ++i)
    balls +=
        fmt::format(R"(, {{"name": "ball{}", "shape": {{"sphere": {{"radius": 0.2}}}}, "mass": 1, "material": "ball",
      "position": [{}, 0.3, {}]}})",
                    i, 2 * (i % 5 - 2), 2 * (i / 5 - 2));
  const Trajectory run = simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Tray", "duration": 0.5,
    "accuracy": 1e-3, "gravity": [0, -9.81, 0],
    "materials": {{"tray": {{"restitution": 0, "staticFriction": 0.4, "dynamicFriction": 0.4}},
                   "ball": {{"restitution": 0, "staticFriction": 0.8, "dynamicFriction": 0.8}}}},
    "pairs": [{{"materials": ["tray", "ball"], "restitution": 0, "staticFriction": 0.8, "dynamicFriction": 0.8}}],
    "pushes": [{{"body": "tray", "point": [0, 0, 0], "force": [106.06601717798212, 0, 106.06601717798212], "start": 0,
                 "duration": 1}}],
    "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "tray"}},
      {{"name": "tray", "shape": {{"box": {{"size": [20, 0.1, 20]}}}}, "mass": 10, "material": "tray",
        "position": [0, 0.05, 0]}}{}]}})",
                                                      balls)));
  const Frame& end = run.frames.back();
  EXPECT_NEAR(end.states[0].linearVelocity.norm(), 0.7385 * 0.5, 1e-6);
  EXPECT_NEAR(end.states[0].linearVelocity.x(), end.states[0].linearVelocity.z(), 1e-6);
  for (std::size_t ball = 1; ball <= 25; ++ball)
    EXPECT_NEAR(end.states[ball].linearVelocity.norm(), 0.211 * 0.5, 1e-6) << ball;
}

}  // namespace
}  // namespace cradle
