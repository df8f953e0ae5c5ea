#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/experiment.h"

namespace cradle {
namespace {

/// A free box of 0.4 x 0.2 x 0.6 m and 2 kg with a push.
Trajectory pushBox(const std::string& push, const std::string& method = methodText("rk4", 0.001)) {
  return simulate(sceneOf(R"({"schema": "cradle-scene/1", "name": "Push", "duration": 1, "gravity": [0, 0, 0],
    "output": {"framesPerSecond": 10}, )" +
                          method + R"(,
    "bodies": [{"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 2, "collision": "none"}],
    "pushes": [)" + push + "]}"));
}

// 3 N for 0.25 s through the centre: v = F t / m, and the way is F t^2 / 2 m during and v t after the push. The step of
// 0.7 ms does not fit the push: a method that stepped across its end would be off by up to F h / m = 1e-3 m/s.
TEST(Push, ThroughTheCentreGivesForceTimesTimeForAnyMethod) {
  for (const char* method : {"explicitEuler", "semiImplicitEuler", "rk4"}) {
    const Trajectory run = pushBox(R"({"body": "box", "point": [0, 0, 0], "force": [0, 0, -3], "start": 0.1,
      "duration": 0.25})",
                                   methodText(method, 0.0007));
    EXPECT_NEAR(endOf(run).linearVelocity.z(), -0.375, 1e-13) << method;
    EXPECT_EQ(endOf(run).angularVelocity, Vec3::Zero()) << method;
    const double way = 0.5 * 1.5 * 0.25 * 0.25 + 0.375 * 0.65;
    EXPECT_NEAR(endOf(run).position.z(), -way, method == std::string("rk4") ? 1e-13 : 1.5 * 0.25 * 0.0007) << method;
  }
}

// The ray meets the face x = 0.2 at (0.2, 0.05, 0.1). A short push is an impulse: J = F t, w = I^-1 (r x J), with I =
// m/12 (0.2^2 + 0.6^2, 0.4^2 + 0.6^2, 0.4^2 + 0.2^2). Within 1e-5 s the point moves by less than 1e-7 m.
TEST(Push, ByARayOffCentreSpinsTheBody) {
  const Trajectory run = pushBox(R"({"body": "box", "ray": {"origin": [3, 0.05, 0.1], "direction": [-2, 0, 0]},
    "force": [-3e4, 0, 0], "start": 0.5, "duration": 1e-5})");
  const std::vector<Event> starts = eventsOf(run, EventKind::pushStart);
  ASSERT_EQ(starts.size(), 1u);
  EXPECT_EQ(starts[0].time, 0.5);
  EXPECT_LT((starts[0].point - Vec3(0.2, 0.05, 0.1)).norm(), 1e-15);
  const Vec3 impulse(-0.3, 0, 0), lever = Vec3(0.2, 0.05, 0.1).cross(impulse);
  const Vec3 inertia = 2.0 / 12 * Vec3(0.40, 0.52, 0.20);
  const BodyState& after = run.frames[5].states[0];  // at 0.5 s, before the push acts
  EXPECT_EQ(after.angularVelocity, Vec3::Zero());
  // Torque-free afterwards: the angular momentum R I R^T w stays.
  const BodyState end = endOf(run);
  const Mat3 turn = end.orientation.toRotationMatrix();
  EXPECT_LT((turn * inertia.asDiagonal() * turn.transpose() * end.angularVelocity - lever).norm(), 1e-6);
  EXPECT_LT((end.linearVelocity - impulse / 2).norm(), 1e-12);
  EXPECT_EQ(eventsOf(run, EventKind::pushEnd).size(), 1u);
}

TEST(Push, WhoseRayMissesSaysSoAndDoesNothing) {
  const Trajectory run = pushBox(R"({"body": "box", "ray": {"origin": [3, 2, 0], "direction": [-1, 0, 0]},
    "force": [-1, 0, 0], "start": 0.5, "duration": 0.1})");
  EXPECT_EQ(eventsOf(run, EventKind::pushMissed).size(), 1u);
  EXPECT_TRUE(eventsOf(run, EventKind::pushStart).empty());
  EXPECT_EQ(endOf(run).linearVelocity, Vec3::Zero());
}

// The box falls past the ray before the push begins: at 0.5 s it is g t^2 / 2 = 1.226 m lower.
TEST(Push, WhoseRayMissesIsWarnedAboutWithPlaceTimeAndAim) {
  const Scene scene =
      sceneOf(R"({"schema": "cradle-scene/1", "name": "Push", "duration": 1, )" + methodText("rk4", 0.001) + R"(,
    "bodies": [{"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 2}],
    "pushes": [
{"body": "box", "ray": {"origin": [3, 0, 0], "direction": [-1, 0, 0]}, "force": [-1, 0, 0], "start": 0.5,
     "duration": 0.1}]})");
  std::vector<std::string> warnings;
  simulate(scene, {[](const Frame&) {}, [](const Event&) {}, [&](const std::string& w) { warnings.push_back(w); }});
  ASSERT_EQ(warnings.size(), 1u);
  for (const char* words : {"experiment.json:4:1 /pushes/0: ", "misses \"box\" at 0.5 s", "[0, -1.226, 0]"})
    EXPECT_NE(warnings[0].find(words), std::string::npos) << words << " in " << warnings[0];
}

TEST(Push, PutsItsWorkIntoTheEnergyBalance) {
  const Trajectory run = pushBox(R"({"body": "box", "point": [0.2, 0.1, -0.3], "force": [4, -2, 5], "start": 0.2,
    "duration": 0.5})");
  EXPECT_GT(run.frames.back().energy.work, 0.5);
  for (const Frame& frame : run.frames) EXPECT_NEAR(energyConstantOf(frame), 0, 1e-9) << frame.time;
}

// L = T t for a body that turns about no axis of its own for long; the centre of mass stays.
TEST(Push, TorqueGivesAngularMomentumAndWork) {
  const Trajectory run = pushBox(R"({"body": "box", "torque": [0.3, -0.2, 0.5], "start": 0.2, "duration": 0.5})",
                                 methodText("dop853", 0.001));
  const BodyState end = endOf(run);
  const Mat3 turn = end.orientation.toRotationMatrix();
  const Vec3 inertia = 2.0 / 12 * Vec3(0.40, 0.52, 0.20);
  const Vec3 angularMomentum = turn * inertia.asDiagonal() * turn.transpose() * end.angularVelocity;
  EXPECT_LT((angularMomentum - 0.5 * Vec3(0.3, -0.2, 0.5)).norm(), 1e-11);
  EXPECT_EQ(end.linearVelocity, Vec3::Zero());
  EXPECT_GT(run.frames.back().energy.work, 0.1);
  for (const Frame& frame : run.frames) EXPECT_NEAR(energyConstantOf(frame), 0, 1e-11) << frame.time;
}

// A ball of 2 kg and 0.1 m on the ground rolls with a = (T / r) / (7/5 m), one on ice turns with 5/2 T / (m r^2), and
// so does one that hangs from its centre.
TEST(Push, TorqueRollsBalls) {
  for (const double friction : {0.5, 0.0}) {
    const Trajectory run = simulate(sceneOf(fmt::format(
        R"({{"schema": "cradle-scene/1", "name": "Push", "duration": 1, "accuracy": 1e-8, "output": {{"framesPerSecond": 10}},
      "materials": {{"m": {{"staticFriction": {}, "dynamicFriction": {}}}}},
      "bodies": [{{"name": "ground", "shape": {{"plane": {{"normal": [0, 1, 0]}}}}, "motion": "static", "material": "m"}},
        {{"name": "rolls", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "position": [0, 0.1, 0], "material": "m"}},
        {{"name": "hangs", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "position": [9, 3, 0]}}],
      "rods": [{{"bodyA": "hangs", "anchorB": [9, 4, 0]}}],
      "pushes": [{{"body": "rolls", "torque": [0, 0, -0.05], "start": 0.25, "duration": 0.5}},
        {{"body": "hangs", "torque": [0, 0, -0.05], "start": 0.25, "duration": 0.5}}]}})",
        friction, friction)));
    const double acceleration = friction > 0 ? 0.05 / 0.1 / (1.4 * 2) : 0, spin = 2.5 * 0.05 / (2 * 0.01) * 0.5;
    const BodyState &rolls = run.frames.back().states[0], &hangs = run.frames.back().states[1];
    EXPECT_NEAR(rolls.position.x(), acceleration * (0.125 + 0.5 * 0.25), 1e-8);
    EXPECT_NEAR(rolls.angularVelocity.z(), friction > 0 ? -acceleration * 0.5 / 0.1 : -spin, 1e-8);
    EXPECT_NEAR(hangs.angularVelocity.z(), -spin, 1e-8);
    for (const Frame& frame : run.frames) EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(run.frames[0]), 1e-8);
  }
}

TEST(Push, WakesABodyThatLies) {
  const Trajectory run = simulate(sceneOf(R"({"schema": "cradle-scene/1", "name": "Push", "duration": 1,
    "output": {"framesPerSecond": 10}, )" +
                                          methodText("rk4", 0.001) + R"(,
    "bodies": [{"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static"},
      {"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 2, "position": [0, 0.1, 0]}],
    "pushes": [{"body": "box", "point": [0, 0, 0], "force": [0, 100, 0], "start": 0.5, "duration": 0.1}]})"));
  EXPECT_EQ(eventsOf(run, EventKind::wake).size(), 1u);
  // Up with F/m - g for 0.1 s, then free.
  const double up = (50 - 9.81) * 0.1, height = up * 0.05 + up * 0.4 - 9.81 * 0.16 / 2;
  EXPECT_NEAR(endOf(run).position.y() - 0.1, height, 1e-9);
}

// Two balls, one of them beyond all that could come near it: whether it goes by ten or by 1e17 m in a frame, and by how
// many of its radii, is no matter to the other one, nor to how long the run takes.
TEST(Push, OfAnyForceEnds) {
  for (const double radius : {1e-7, 0.1})
    for (const double force : {1e3, 1e10, 1e20}) {
      const Trajectory run = simulate(sceneWith(fmt::format(
          R"("duration": 1, "output": {{"framesPerSecond": 10}}, "bodies": [
            {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static"}},
            {{"name": "pushed", "mass": 1, "shape": {{"sphere": {{"radius": {0}}}}}, "position": [0, 2, 0]}},
            {{"name": "other", "mass": 1, "shape": {{"sphere": {{"radius": {0}}}}}, "position": [3, 20, 0]}}],
          "pushes": [{{"body": "pushed", "point": [0, 0, 0], "force": [0, {1}, 0], "start": 0.1, "duration": 0.1}}])",
          radius, force)));
      const std::vector<BodyState>& end = run.frames.back().states;
      EXPECT_NEAR(end[0].linearVelocity.y(), 0.1 * force - 9.81, 1e-12 * force) << radius << " " << force;
      EXPECT_NEAR(end[1].position.y(), 20 - 9.81 / 2, 1e-9) << radius << " " << force;
    }
}

}  // namespace
}  // namespace cradle
