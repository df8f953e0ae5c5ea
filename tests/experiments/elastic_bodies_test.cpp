// Bodies of all shapes that fly about in a box, without gravity, friction, or loss.

#include <gtest/gtest.h>

#include "collision/random_poses.h"
#include "experiments/experiment.h"
#include "experiments/scene_sketch.h"
#include "study/drift_meter.h"

namespace cradle {
namespace {

/// Eight bodies in the corners of a box of 2 m.
Scene crowdIn(double accuracy, unsigned seed) {
  RandomPoses random(seed);
  SceneSketch sketch;
  sketch.name = "Elastic bodies in a box";
  sketch.duration = 1, sketch.framesPerSecond = 60, sketch.accuracy = accuracy, sketch.gravity = Vec3::Zero();
  sketch.materials.push_back({1, 0, 0});
  for (const int axis : {0, 1, 2})
    for (const double side : {1.0, -1.0}) {
      SketchBody wall;
      wall.shape = SketchShape::plane, wall.isStatic = true;
      wall.worldFromBody = {Quat::FromTwoVectors(Vec3::UnitY(), -side * Vec3::Unit(axis)), side * Vec3::Unit(axis)};
      sketch.bodies.push_back(wall);
    }
  const std::pair<SketchShape, Vec3> shapes[] = {
      {SketchShape::sphere, Vec3::Constant(0.25)},   {SketchShape::box, Vec3(0.3, 0.4, 0.2)},
      {SketchShape::cylinder, Vec3(0.2, 0.3, 0)},    {SketchShape::capsule, Vec3(0.15, 0.3, 0)},
      {SketchShape::prismHull, Vec3::Constant(1.2)}, {SketchShape::prism, Vec3::Constant(1.2)},
      {SketchShape::box, Vec3(0.1, 0.5, 0.3)},       {SketchShape::capsule, Vec3(0.2, 0.1, 0)}};
  for (int i = 0; i < 8; ++i) {
    SketchBody body;
    body.shape = shapes[i].first, body.size = shapes[i].second;
    body.mass = std::pow(10, random.number(-1, 1));
    body.worldFromBody = {random.turn(), Vec3(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5)};
    body.linearVelocity = random.vector(3), body.angularVelocity = random.vector(5);
    sketch.bodies.push_back(body);
  }
  return parseScene(textOf(sketch), "elastic.json", modelFilesBeside("elastic.json")).scene;
}

// Impacts without friction and loss keep the energy to rounding; between them a body turns with an error of a tenth of
// the accuracy a step, of energy as of all else: some hundred steps.
TEST(ElasticBodies, OfAllShapesKeepTheirEnergyInABox) {
  for (const unsigned seed : {1U, 2U}) {
    const double accuracy = 1e-8;
    const Scene scene = crowdIn(accuracy, seed);
    const Trajectory run = simulate(scene);
    EXPECT_GT(eventsOf(run, EventKind::impact).size(), 20U);
    const double start = run.frames[0].energy.kinetic;
    const Assembly assembly = assemble(scene, wholeScene(scene));
    DriftMeter meter(assembly);
    for (const Frame& frame : run.frames) {
      ASSERT_NEAR(frame.energy.kinetic / start, 1, 10 * accuracy) << "at " << frame.time << " s, seed " << seed;
      meter.add(frame);
    }
    EXPECT_LT(meter.penetration(), accuracy);
  }
}

}  // namespace
}  // namespace cradle
