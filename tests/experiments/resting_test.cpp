#include <gtest/gtest.h>

#include "experiments/experiment.h"

// What lies still stays where it is, for ever and with every method.

namespace cradle {
namespace {

constexpr double kMaxDrift = 1e-6;  // m, and rad times the size of about 1 m

/// An L of 3 x 2 squares without its upper right 2 x 1, one deep, scaled; a corner is the origin.
LoadedModel lPrism(const MeshReference& reference) {
  DrawnMesh drawn;
  for (const double z : {0, 1})
    for (const auto& [x, y] : {std::pair{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}})
      drawn.vertices.emplace_back(reference.scale * Vec3(x, y, z));
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    drawn.triangles.insert(drawn.triangles.end(), {{i, j, 6 + j}, {i, 6 + j, 6 + i}});
  }
  for (std::uint32_t i = 1; i < 5; ++i)
    drawn.triangles.insert(drawn.triangles.end(), {{0, i + 1, i}, {6, 6 + i, 7 + i}});
  drawn.normals.assign(drawn.vertices.size(), Vec3f::UnitY());
  return {{"l", weld(drawn.vertices, drawn.triangles), drawn}, {}};
}

Trajectory layDown(const std::string& bodies, const std::string& method, double duration = 10) {
  const std::string text = fmt::format(R"({{"schema": "cradle-scene/1", "name": "Resting", "duration": {},
    "output": {{"framesPerSecond": 60}}, {},
    "bodies": [{{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static"}}, {}]}})",
                                       duration, methodText(method, 1.0 / 960), bodies);
  return simulate(parseScene(text, "resting.json", lPrism).scene);
}

const std::vector<std::string> kLying = {
    R"({"name": "box", "shape": {"box": {"size": [0.3, 0.2, 0.5]}}, "position": [0, 0.1, 0]})",
    R"({"name": "lower", "shape": {"box": {"size": [1, 0.4, 1]}}, "position": [0, 0.2, 0]},
       {"name": "upper", "shape": {"box": {"size": [0.5, 0.3, 0.5]}}, "position": [0.2, 0.55, 0.1],
        "orientation": {"axis": [0, 1, 0], "angleDegrees": 20}})",
    R"({"name": "l", "shape": {"mesh": "l.obj", "scale": 0.2}})",
    // On the ends of its two legs.
    R"({"name": "l", "shape": {"mesh": "l.obj", "scale": 0.2}, "position": [0, 0.6, 0],
        "orientation": {"axis": [0, 0, 1], "angleDegrees": -90}})"};

void expectStill(const Trajectory& run, std::size_t from, const std::string& what) {
  const Frame& first = run.frames.at(from);
  for (std::size_t i = from; i < run.frames.size(); ++i)
    for (std::size_t body = 0; body < first.states.size(); ++body) {
      const BodyState &state = run.frames[i].states[body], &start = first.states[body];
      ASSERT_LT((state.position - start.position).norm(), kMaxDrift) << what << " at " << run.frames[i].time;
      ASSERT_LT(orientationError(state.orientation, start.orientation), kMaxDrift) << what;
      ASSERT_LT(state.linearVelocity.norm() + state.angularVelocity.norm(), kMaxDrift) << what;
    }
}

TEST(WhatLies, StaysInEveryFrameOfTenSecondsWithEveryMethod) {
  for (const char* method : {"explicitEuler", "semiImplicitEuler", "rk4"})
    for (const std::string& bodies : kLying) expectStill(layDown(bodies, method), 0, method + bodies);
}

// Let go 1 mm above the ground they fall, knock and lie: still from the second second on, and about as high as before.
TEST(WhatLies, StaysWhereItFell) {
  for (const std::string& bodies : kLying) {
    Scene scene = parseScene(R"({"schema": "cradle-scene/1", "name": "Resting", "duration": 10,
      "output": {"framesPerSecond": 60}, )" +
                                 methodText("rk4", 1.0 / 960) +
                                 R"(, "materials": {"m": {"restitution": 0.3}}, "bodies": [
      {"name": "ground", "shape": {"plane": {}}, "motion": "static", "position": [0, -0.001, 0]}, )" +
                                 bodies + "]}",
                             "resting.json", lPrism)
                      .scene;
    const Trajectory run = simulate(scene);
    expectStill(run, 120, bodies);
    for (std::size_t body = 0; body < run.frames[0].states.size(); ++body)
      EXPECT_NEAR(run.frames.back().states[body].position.y(), run.frames[0].states[body].position.y() - 0.001, 1e-4)
          << bodies;
  }
}

/// A cylinder, over an L that does not move: a mesh, or the two boxes that it is made of.
BodyState cylinderOnL(bool isMesh, const std::string& motion) {
  const std::string l =
      isMesh ? R"({"name": "l", "shape": {"mesh": "l.obj"}, "motion": "static", "material": "m"})"
             : R"({"name": "foot", "shape": {"box": {"size": [3, 1, 1]}}, "motion": "static", "material": "m",
                   "position": [1.5, 0.5, 0.5]},
                  {"name": "back", "shape": {"box": {"size": [1, 2, 1]}}, "motion": "static", "material": "m",
                   "position": [0.5, 1, 0.5]})";
  return endOf(simulate(parseScene(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Cylinder", "duration": 0.1,
    "accuracy": 1e-8, "materials": {{"m": {{"staticFriction": 0.4, "dynamicFriction": 0.4}}}},
    "bodies": [{{"name": "cylinder", "shape": {{"cylinder": {{"radius": 0.2, "length": 0.6}}}}, "material": "m", {}}},
               {}]}})",
                                               motion, l),
                                   "cylinder.json", lPrism)
                            .scene));
}

// It lands on its end, on its side, and rolls over the triangles until the L's back stops it.
TEST(CylinderOnAMesh, MovesAsOnTheBoxesThatTheMeshIsMadeOf) {
  const std::string lying = R"("orientation": {"axis": [1, 0, 0], "angleDegrees": 90}, )";
  const std::vector<std::pair<std::string, Vec3>> motions = {
      {R"("position": [2, 1.301, 0.5])", Vec3(2, 1.3, 0.5)},
      {lying + R"("position": [2.2, 1.201, 0.5])", Vec3(2.2, 1.2, 0.5)},
      {lying + R"("position": [1.22, 1.2, 0.5], "linearVelocity": [-0.8, 0, 0], "angularVelocity": [0, 0, 4])",
       Vec3(1.2, 1.2, 0.5)}};
  for (const auto& [motion, end] : motions) {
    const BodyState onMesh = cylinderOnL(true, motion), onBoxes = cylinderOnL(false, motion);
    EXPECT_LT((onMesh.position - onBoxes.position).norm(), 1e-7) << motion;  // ten times the accuracy
    EXPECT_LT(orientationError(onMesh.orientation, onBoxes.orientation), 1e-7) << motion;
    EXPECT_LT((onMesh.position - end).norm(), 1e-7) << motion;
    EXPECT_LT(onMesh.linearVelocity.norm() + onMesh.angularVelocity.norm(), 1e-7) << motion;
  }
}

}  // namespace
}  // namespace cradle
