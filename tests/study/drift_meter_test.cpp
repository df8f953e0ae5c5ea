#include "study/drift_meter.h"

#include <gtest/gtest.h>

#include "study/sample_scenes.h"

namespace cradle {
namespace {

Frame frameWith(const Vec3& position, const EnergyBalance& energy = {}) {
  Frame frame;
  frame.states.resize(1);
  frame.states[0].position = position;
  frame.energy = energy;
  return frame;
}

TEST(DriftMeter, EnergyIsThatOfTheConstantAsPartOfTheLargestKinetic) {
  const Scene scene = freeFall(1);
  const Assembly assembly = assemble(scene, wholeScene(scene));
  DriftMeter meter(assembly);
  // The constants are 5, 7 and 4 J.
  meter.add(frameWith(Vec3::Zero(), {.kinetic = 2, .potential = 3}));
  meter.add(frameWith(Vec3::Zero(), {.kinetic = 10, .potential = -4, .dissipated = 2, .work = 1}));
  meter.add(frameWith(Vec3::Zero(), {.kinetic = 8, .potential = -4}));
  EXPECT_DOUBLE_EQ(meter.energyDrift(), 2.0 / 10);
}

TEST(DriftMeter, ConstraintIsTheErrorOfARodInMetres) {
  const Scene scene = sceneOf(R"({"schema": "cradle-scene/1", "name": "rod", "duration": 1,
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [2, 0, 0]}],
    "rods": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}]})");
  const Assembly assembly = assemble(scene, wholeScene(scene));
  DriftMeter meter(assembly);
  meter.add(frameWith({0, 2, 0}));
  EXPECT_EQ(meter.constraintDrift(), 0);
  // (d^2 - l^2) / 2l differs from d - l by (d - l)^2 / 2l, 2.5e-9 here.
  meter.add(frameWith({0, 2 - 1e-4, 0}));
  EXPECT_NEAR(meter.constraintDrift(), 1e-4, 3e-9);
  meter.add(frameWith({0, 2, 0}));
  EXPECT_NEAR(meter.constraintDrift(), 1e-4, 3e-9);
}

TEST(DriftMeter, PenetrationIsTheDeepestOverlap) {
  const Scene scene = sceneOf(R"({"schema": "cradle-scene/1", "name": "ground", "duration": 1,
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.5}}, "position": [0, 2, 0]},
               {"name": "ground", "shape": {"plane": {}}, "motion": "static"}]})");
  const Assembly assembly = assemble(scene, wholeScene(scene));
  DriftMeter meter(assembly);
  meter.add(frameWith({0, 0.75, 0}));
  EXPECT_EQ(meter.penetration(), 0);
  meter.add(frameWith({0, 0.375, 0}));
  EXPECT_DOUBLE_EQ(meter.penetration(), 0.125);
}

}  // namespace
}  // namespace cradle
