#include <gmock/gmock.h>

#include <cmath>

#include "study/motion_error.h"
#include "study/peer_frames.h"
#include "study/sample_scenes.h"
#include "study/study_table.h"

namespace cradle {
namespace {

class Bullet : public PeerTest {};

/// A block of 0.5 x 0.2 x 0.5 m that lies on a slope of 30 degrees.
Scene blockOnSlope(double friction) {
  return sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "slope", "duration": 1,
    "materials": {{"slab": {{"staticFriction": 0.9, "dynamicFriction": 0.9}}, "wood": {{}}}},
    "pairs": [{{"materials": ["slab", "wood"], "staticFriction": {0}, "dynamicFriction": {0}}}],
    "bodies": [{{"name": "slab", "shape": {{"box": {{"size": [40, 1, 4]}}}}, "motion": "static", "material": "slab",
                 "position": [0.25, -0.43301270189221935, 0], "orientation": {{"axis": [0, 0, 1], "angleDegrees": 30}}}},
               {{"name": "block", "shape": {{"box": {{"size": [0.5, 0.2, 0.5]}}}}, "mass": 1, "material": "wood",
                 "position": [-0.05, 0.08660254037844387, 0], "orientation": {{"axis": [0, 0, 1], "angleDegrees": 30}}}}
              ]}})",
                             friction));
}

TEST_F(Bullet, FreeFallErrorIsHalfGravityTimesStepTimesTime) {
  // Semi-implicit Euler: y = -g h^2 (1 + 2 + ... + n) = -g (t^2 + h t) / 2, up to the rounding of 128 steps.
  const double timeStep = 1.0 / 64, time = 2;
  const Frame end = framesOf(freeFall(time), "bullet", timeStep, 0.5).back();
  EXPECT_NEAR(end.states[0].position.y(), -9.81 * (time * time + timeStep * time) / 2, 1e-12);
}

TEST_F(Bullet, SpringForcesActOnceAStep) {
  // x(n+1) - 2 x(n) + x(n-1) = -(omega h)^2 x(n), and x(0) = x(-1) at rest: x(n) ~ cos((n + 1/2) a), cos a = 1 - (omega
  // h)^2 / 2. The spring's energy is reported with the state that it belongs to.
  const double omega = 20, timeStep = 0.005, duration = 2;
  const Frame end = framesOf(oscillator(omega, duration), "bullet", timeStep, 1 / duration).back();
  const double angle = std::acos(1 - omega * omega * timeStep * timeStep / 2);
  const double away = 0.25 * std::cos((duration / timeStep + 0.5) * angle) / std::cos(angle / 2);
  EXPECT_NEAR(end.states[0].position.x(), 1 + away, 1e-11);
  EXPECT_NEAR(end.energy.potential, omega * omega * away * away / 2, 1e-8);
}

TEST_F(Bullet, BodiesStartWhereTheSceneHasThem) {
  const Scene scene = sceneOf(R"({"schema": "cradle-scene/1", "name": "start", "duration": 1,
    "bodies": [{"name": "a", "shape": {"box": {"size": [1, 0.6, 0.2]}}, "mass": 2, "centerOfMass": [0.2, -0.1, 0.05],
                "inertiaTensor": [[0.4, 0.05, 0.02], [0.05, 0.5, -0.03], [0.02, -0.03, 0.6]], "position": [1, 2, 3],
                "orientation": {"axis": [1, 2, -1], "angleDegrees": 70}, "linearVelocity": [1, -2, 0.5],
                "angularVelocity": [0.3, 4, -1]}]})");
  expectStartIsTheScenes(scene, "bullet");
}

TEST_F(Bullet, TiedBodiesThatAreNotSymmetricAreRightToFirstOrder) {
  // Rod, ball joint and hinge off the centres of mass, an inertia tensor off the axes, and gyroscopic torque: any of
  // them wrong leaves an error that does not go with the step.
  const Scene scene = sceneOf(R"({"schema": "cradle-scene/1", "name": "tied", "duration": 0.5,
    "bodies": [{"name": "a", "shape": {"box": {"size": [1, 0.6, 0.2]}}, "collision": "none", "mass": 2,
                "centerOfMass": [0.2, -0.1, 0.05], "inertiaTensor": [[0.4, 0.05, 0.02], [0.05, 0.5, -0.03], [0.02, -0.03, 0.6]],
                "angularVelocity": [0, 0, 2], "linearVelocity": [0.2, 1, 0]},
               {"name": "b", "shape": {"box": {"size": [0.3, 0.5, 0.4]}}, "collision": "none", "mass": 1, "position": [1, 0, 0]},
               {"name": "c", "shape": {"box": {"size": [0.3, 0.2, 0.4]}}, "collision": "none", "mass": 1, "position": [2, 0, 0]}],
    "hinges": [{"bodyA": "a", "anchorA": [-0.5, 0, 0], "anchorB": [-0.5, 0, 0], "axis": [0, 1, 1]}],
    "ballJoints": [{"bodyA": "b", "anchorA": [-0.5, 0, 0], "bodyB": "a", "anchorB": [0.5, 0, 0]}],
    "rods": [{"bodyA": "c", "anchorA": [-0.1, 0.1, 0.2], "bodyB": "b", "anchorB": [0.1, 0, 0.1]}]})");
  const std::vector<BodyState> exact = StudyScene(scene).run(methodOf("dop853"), 1e-10, 10).end;
  const double coarse = motionError(framesOf(scene, "bullet100", 1.0 / 512, 2).back().states, exact);
  const double fine = motionError(framesOf(scene, "bullet100", 1.0 / 1024, 2).back().states, exact);
  EXPECT_LT(coarse, 0.02);
  EXPECT_NEAR(coarse / fine, 2, 0.3);
}

TEST_F(Bullet, TheRestitutionOfAPairGivesTheHeightOfTheBounce) {
  // Apex e^2 h. The impact is seen up to a step late, and that deep the ball starts again: some v h = 1e-3 m.
  const double restitution = 0.7;
  const Scene scene = sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "bounce", "duration": 1,
    "materials": {{"rubber": {{"restitution": {}}}, "stone": {{"restitution": 0.95}}}},
    "bodies": [{{"name": "ground", "shape": {{"plane": {{"normal": [0, 1, 0]}}}}, "motion": "static", "material": "stone"}},
               {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "rubber", "position": [0, 1.1, 0]}}]}})",
                                          restitution));
  double apex = 0;
  for (const Frame& frame : framesOf(scene, "bulletTuned100", 1.0 / 4096, 256))
    if (frame.time > 0.6) apex = std::max(apex, frame.states[0].position.y() - 0.1);
  EXPECT_NEAR(apex, restitution * restitution, 4e-3);
}

TEST_F(Bullet, ABlockSlidesWithTheFrictionOfItsPair) {
  // g (sin - mu cos) t^2 / 2 down the slope; 1 % is five times the error of a step of 1/1000 s (h / t, and the
  // solver's).
  const std::vector<Frame> frames = framesOf(blockOnSlope(0.5), "bulletTuned100", 1e-3, 1);
  const double way = (frames.back().states[0].position - frames.front().states[0].position).norm();
  EXPECT_NEAR(way, 9.81 * (0.5 - 0.5 * std::sqrt(0.75)) / 2, 0.01 * way);
}

TEST_F(Bullet, WhatItDoesNotHaveIsNamed) {
  const auto missing = [](const char* name) {
    return missingIn("bullet", loadScene(std::string(CRADLE_SOURCE_DIR "/scenes/") + name).scene);
  };
  EXPECT_EQ(missing("slack_rope.json"), "ropes");
  EXPECT_EQ(missing("struck_model.json"), "pushes");
  EXPECT_THAT(missing("gears_fall.json"), ::testing::HasSubstr("concave mesh"));
  EXPECT_EQ(missing("newtons_cradle.json"), "");
}

TEST_F(Bullet, RowsNameTheEngine) {
  StudyScene scene(oscillator(5, 0.5));
  const Reference reference{scene.run(methodOf("dop853"), 1e-12, 10).end, 1e-2, "", ""};
  std::vector<StudyRow> rows;
  sweep(scene, "spring", methodOf("bulletTuned"), reference, [&](const StudyRow& row) { rows.push_back(row); });
  ASSERT_FALSE(rows.empty());
  EXPECT_THAT(tableLine(rows.back()), ::testing::StartsWith("spring,bullet,bulletTuned,"));
  EXPECT_EQ(rows.back().evaluations * rows.back().setting, 0.5);  // steps
}

TEST_F(Bullet, EnergyIsNotJudgedWhereContactMayTakeIt) {
  StudyScene sliding(blockOnSlope(0.5)), swinging(oscillator(5, 0.5));
  EXPECT_TRUE(std::isnan(sliding.run(methodOf("bullet"), 0.01, 10).energyDrift));
  EXPECT_GT(swinging.run(methodOf("bullet"), 0.01, 10).energyDrift, 0);
}

TEST_F(Bullet, AScenePartThatIsMissingLeavesNoRows) {
  StudyScene scene(loadScene(CRADLE_SOURCE_DIR "/scenes/rope_slack_taut.json").scene);
  sweep(scene, "ropes", methodOf("bullet"), {}, [](const StudyRow&) { FAIL(); });
  EXPECT_EQ(scene.missingIn(methodOf("bullet")), "ropes");
  EXPECT_EQ(scene.missingIn(methodOf("rk4")), "");
}

}  // namespace
}  // namespace cradle
