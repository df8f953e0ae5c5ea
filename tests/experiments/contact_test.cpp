#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/experiment.h"

namespace cradle {
namespace {

int countOf(const Trajectory& run, EventKind kind) {
  return static_cast<int>(
      std::count_if(run.events.begin(), run.events.end(), [kind](const Event& event) { return event.kind == kind; }));
}

/// Five touching balls on rods of 0.5 m, the first lifted by 30 degrees; e = 1.
std::string cradleText(const std::string& method, double duration) {
  std::string bodies, rods;
  for (int i = 0; i < 5; ++i) {
    const double pivot = 0.05 * i, angle = i == 0 ? M_PI / 6 : 0;
    bodies +=
        fmt::format(R"({}{{"name": "b{}", "shape": {{"sphere": {{"radius": 0.025}}}}, "mass": 0.1, "material": "steel",
      "position": [{:.17g}, {:.17g}, 0]}})",
                    i ? "," : "", i, pivot - 0.5 * std::sin(angle), -0.5 * std::cos(angle));
    rods += fmt::format(R"({}{{"bodyA": "b{}", "anchorA": [0, 0, 0], "anchorB": [{:.17g}, 0, 0]}})", i ? "," : "", i,
                        pivot);
  }
  return fmt::format(
      R"({{"schema": "cradle-scene/1", "name": "Cradle", "duration": {}, "output": {{"framesPerSecond": 20}},
    {}, "materials": {{"steel": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}}},
    "bodies": [{}], "rods": [{}]}})",
      duration, method, bodies, rods);
}

// A quarter period of the pendulum, 0.36079944780303988843 s, after the start the first ball stands still where it was
// at the bottom and the last one has its velocity of 1.1464252216671861390 m/s. RK4's own error at 1/960 is below
// 1e-10.
TEST(NewtonsCradle, PassesTheMotionThroughToTheLastBall) {
  const Trajectory run = simulate(sceneOf(cradleText(methodText("rk4", 1.0 / 960), 0.5)));
  ASSERT_GE(countOf(run, EventKind::impact), 4);
  const auto first = std::find_if(run.events.begin(), run.events.end(),
                                  [](const Event& event) { return event.kind == EventKind::impact; });
  EXPECT_NEAR(first->time, 0.36079944780303988843, 1e-8);
  EXPECT_NEAR(first->impulse, 0.1 * 1.1464252216671861390, 1e-9);
  const Frame& after = run.frames[8];  // 0.4 s
  for (std::size_t ball = 0; ball < 4; ++ball) EXPECT_LT(after.states[ball].linearVelocity.norm(), 1e-8) << ball;
  EXPECT_GT(after.states[4].linearVelocity.x(), 1.0);
}

TEST(NewtonsCradle, KeepsItsEnergyOverTenSeconds) {
  const Trajectory run = simulate(sceneOf(cradleText(methodText("rk4", 1.0 / 960), 10)));
  const double swing = 0.1 * 9.81 * 0.5 * (1 - std::cos(M_PI / 6));  // J
  for (const Frame& frame : run.frames)
    EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(run.frames[0]), 1e-6 * swing);
  const double mechanical = run.frames.back().energy.kinetic + run.frames.back().energy.potential;
  EXPECT_NEAR(mechanical, run.frames[0].energy.potential, 1e-6 * swing);
}

/// A box of 0.3 x 0.2 x 0.1 m dropped askew onto a plane.
Trajectory dropBox(const std::string& method) {
  return simulate(
      sceneOf(R"({"schema": "cradle-scene/1", "name": "Box", "duration": 4, "output": {"framesPerSecond": 10},
    )" + method +
              R"(, "materials": {"m": {"restitution": 0.4, "staticFriction": 0.6, "dynamicFriction": 0.5}},
    "bodies": [{"name": "ground", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static", "material": "m"},
      {"name": "box", "shape": {"box": {"size": [0.3, 0.2, 0.1]}}, "material": "m", "position": [0, 0.6, 0],
       "orientation": {"axis": [1, 2, 3], "angleDegrees": 50}, "angularVelocity": [1, -3, 2]}]})"));
}

TEST(DroppedBox, ComesToRestOnAFaceAndStays) {
  for (const char* method : {"semiImplicitEuler", "rk4"}) {
    const Trajectory run = dropBox(methodText(method, 1.0 / 960));
    EXPECT_EQ(countOf(run, EventKind::rest), 1) << method;
    const BodyState end = endOf(run);
    EXPECT_EQ(end.linearVelocity, Vec3::Zero()) << method;
    EXPECT_EQ(end.position, run.frames[30].states[0].position) << method;
    // It lies on a face: one edge upright, the centre half of it above the ground; 1e-6 of the size is the support
    // margin.
    const Vec3 up = end.orientation.conjugate() * Vec3::UnitY();
    Eigen::Index axis = 0;
    EXPECT_NEAR(up.cwiseAbs().maxCoeff(&axis), 1, 1e-9) << method;
    EXPECT_NEAR(end.position.y(), Vec3(0.3, 0.2, 0.1)[axis] / 2, 1e-6) << method;
  }
}

TEST(DroppedBox, NeverGoesBelowTheGroundNorGainsEnergy) {
  const Trajectory run = dropBox(methodText("rk4", 1.0 / 960));
  for (const Frame& frame : run.frames) {
    double lowest = 1;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      lowest = std::min(
          lowest,
          (frame.states[0].position + frame.states[0].orientation * signs.cwiseProduct(Vec3(0.3, 0.2, 0.1)) / 2).y());
    }
    EXPECT_GT(lowest, -1e-5) << frame.time;
    EXPECT_LE(frame.energy.kinetic + frame.energy.potential, energyConstantOf(run.frames[0]) * (1 + 1e-9))
        << frame.time;
  }
}

// A ball slides onto one that lies still: it wakes and is pushed on. Elastic and of equal mass: it takes the velocity.
// Within its step the sliding ball sinks by up to g h^2 / 2 before the contact lifts it again, which tilts the line of
// impact by g h^2 / 4 R = 2.5e-5 and mixes the fall's g h = 0.0098 m/s in: 2.4e-7 m/s.
TEST(RestingBall, WakesWhenItIsHit) {
  const Trajectory run = simulate(sceneOf(R"({"schema": "cradle-scene/1", "name": "Billiards", "duration": 1,
    "output": {"framesPerSecond": 10}, )" +
                                          methodText("rk4", 0.001) + R"(,
    "materials": {"m": {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}},
    "bodies": [{"name": "table", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static", "material": "m"},
      {"name": "a", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "m", "position": [0, 0.1, 0],
       "linearVelocity": [1, 0, 0]},
      {"name": "b", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "m", "position": [0.7, 0.1, 0]}]})"));
  EXPECT_EQ(countOf(run, EventKind::wake), 1);
  const Frame& end = run.frames.back();
  EXPECT_NEAR(end.states[0].position.x(), 0.5, 3e-7);
  EXPECT_NEAR(end.states[1].position.x(), 0.7 + 0.5, 3e-7);
  EXPECT_NEAR(end.states[1].linearVelocity.x(), 1, 3e-7);
}

}  // namespace
}  // namespace cradle
