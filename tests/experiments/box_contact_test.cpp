#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/experiment.h"

namespace cradle {
namespace {

Trajectory runScene(const std::string& bodies, double duration, const std::string& more = "") {
  return simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Boxes", "duration": {},
    "output": {{"framesPerSecond": 10}}, {}, {}
    "materials": {{"bouncy": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}},
      "rough": {{"restitution": 0, "staticFriction": 0.7, "dynamicFriction": 0.7}},
      "smooth": {{"restitution": 0, "staticFriction": 0.2, "dynamicFriction": 0.2}}}},
    "bodies": [{}]}})",
                                      duration, methodText("rk4", 1.0 / 960), more, bodies)));
}

// A ball that falls onto a face, an edge and a corner of a fixed box, each exactly below its centre, comes straight
// back.
TEST(BallOnBox, ReboundsFromFaceEdgeAndCorner) {
  const std::vector<std::pair<std::string, double>> poses = {
      {R"("orientation": {"w": 1, "x": 0, "y": 0, "z": 0})", 0.5},
      {R"("orientation": {"axis": [0, 0, 1], "angleDegrees": 45})", std::sqrt(0.5)},
      {R"("orientation": {"axis": [1, 0, -1], "angleDegrees": 54.735610317245346})", std::sqrt(0.75)}};
  for (const auto& [orientation, top] : poses) {
    const Trajectory run = runScene(fmt::format(R"(
      {{"name": "box", "shape": {{"box": {{"size": [1, 1, 1]}}}}, "motion": "static", "material": "bouncy", {}}},
      {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "bouncy", "position": [0, {}, 0]}})",
                                                orientation, top + 0.1 + 1),
                                    0.9);
    ASSERT_GE(run.events.size(), 1u) << orientation;
    EXPECT_NEAR(run.events[0].time, std::sqrt(2 / 9.81), 1e-9) << orientation;
    // Back at its height at twice the time of the fall, 0.903 s; at 0.9 s it misses g (3 ms)^2 / 2.
    const double early = 2 * std::sqrt(2 / 9.81) - 0.9;
    EXPECT_NEAR(endOf(run).position.y(), top + 1.1 - 9.81 * early * early / 2, 1e-6) << orientation;
  }
}

// One box dropped flat onto another that lies: both come to rest, one on the other, without sinking.
TEST(BoxOnBox, ComesToRestOnTop) {
  const Trajectory run = runScene(R"(
    {"name": "ground", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static", "material": "rough"},
    {"name": "lower", "shape": {"box": {"size": [1, 0.4, 1]}}, "mass": 2, "material": "rough", "position": [0, 0.2, 0]},
    {"name": "upper", "shape": {"box": {"size": [0.5, 0.5, 0.5]}}, "mass": 1, "material": "rough",
     "position": [0.1, 0.8, 0.05]})",
                                  1);
  const Frame& end = run.frames.back();
  EXPECT_LT((end.states[0].position - Vec3(0, 0.2, 0)).norm(), 1e-6);
  // An impact pair by pair shifts the boxes by what a step falls: g h^2 = 1.1e-5 m, a few times.
  EXPECT_LT((end.states[1].position - Vec3(0.1, 0.65, 0.05)).norm(), 3e-5);
  EXPECT_EQ(end.states[1].linearVelocity, Vec3::Zero());
  EXPECT_EQ(run.events.back().kind, EventKind::rest);
}

// A 2 cm ball at 300 m/s at a wall of 1 cm: it needs 1/30 of a step to pass the wall.
TEST(FastBall, DoesNotTunnelThroughAThinWall) {
  const Trajectory run = runScene(R"(
    {"name": "wall", "shape": {"box": {"size": [0.01, 2, 2]}}, "motion": "static", "material": "bouncy"},
    {"name": "ball", "shape": {"sphere": {"radius": 0.01}}, "material": "bouncy", "position": [-10.13, 0, 0],
     "linearVelocity": [300, 0, 0]})",
                                  0.1, R"("gravity": [0, 0, 0],)");
  ASSERT_EQ(run.events.size(), 1u);
  EXPECT_NEAR(run.events[0].time, (10.13 - 0.015) / 300, 1e-12);
  EXPECT_NEAR(endOf(run).linearVelocity.x(), -300, 1e-9);
}

// Edge on edge, elastic, head on through both centres: equal boxes exchange their velocities.
TEST(BoxOnBox, CrossedEdgesExchangeTheirMotion) {
  const Trajectory run = runScene(R"(
    {"name": "a", "shape": {"box": {"size": [1, 1, 1]}}, "mass": 1, "material": "bouncy", "position": [0, 0, 0],
     "orientation": {"axis": [1, 0, 0], "angleDegrees": 45}, "linearVelocity": [0, 2, 0]},
    {"name": "b", "shape": {"box": {"size": [1, 1, 1]}}, "mass": 1, "material": "bouncy", "position": [0, 2, 0],
     "orientation": {"axis": [0, 0, 1], "angleDegrees": 45}})",
                                  1, R"("gravity": [0, 0, 0],)");
  ASSERT_EQ(run.events.size(), 1u);
  EXPECT_NEAR(run.events[0].time, (2 - std::sqrt(2)) / 2, 1e-9);
  const Frame& end = run.frames.back();
  EXPECT_LT(end.states[0].linearVelocity.norm(), 1e-9);
  EXPECT_NEAR(end.states[1].linearVelocity.y(), 2, 1e-9);
  EXPECT_LT(end.states[1].angularVelocity.norm(), 1e-9);
}

}  // namespace
}  // namespace cradle
