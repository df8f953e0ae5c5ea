// Two rings like links of a chain, without gravity: concave surfaces that can never come apart.

#include <gtest/gtest.h>

#include "experiments/experiment.h"
#include "experiments/scene_sketch.h"

namespace cradle {
namespace {

constexpr double kRing = 0.12, kTube = 0.045;  // m: of assets/torus.3ds, about y

// The middle of each ring's tube passes through the other's hole: two circles of radius R that stay 2 r apart, linked,
// have their centres at most 2 R - 2 r apart.
TEST(LinkedTori, StayLinkedAndKeepTheirMomentum) {
  SceneSketch sketch;
  sketch.name = "Linked tori";
  sketch.duration = 0.3, sketch.framesPerSecond = 100, sketch.accuracy = 1e-3, sketch.gravity = Vec3::Zero();
  sketch.materials.push_back({0.5, 0.3, 0.3});
  SketchBody left;
  left.shape = SketchShape::torus, left.mass = 1;
  left.worldFromBody = {Quat::Identity(), Vec3(-kRing / 2, 0, 0)};
  left.linearVelocity = Vec3(-1, 0.1, 0.2), left.angularVelocity = Vec3(3, 1, 0);
  SketchBody right = left;
  right.mass = 2, right.worldFromBody = {Quat::FromTwoVectors(Vec3::UnitY(), Vec3::UnitZ()), Vec3(kRing / 2, 0, 0)};
  right.linearVelocity = Vec3(1, 0, -0.1), right.angularVelocity = Vec3(0, -2, 1);
  sketch.bodies = {left, right};
  const Trajectory run = simulate(parseScene(textOf(sketch), "tori.json", modelFilesBeside("tori.json")).scene);

  const EnergyBalance& start = run.frames.front().energy;
  for (const Frame& frame : run.frames) {
    const double distance = (frame.states[0].position - frame.states[1].position).norm();
    EXPECT_LT(distance, 2 * (kRing - kTube) + 2e-3) << frame.time;  // facets of the tubes, and what steps overlap
    EXPECT_LT((frame.energy.momentum - start.momentum).norm(), 1e-9) << frame.time;
    EXPECT_LT((frame.energy.angularMomentum - start.angularMomentum).norm(), 1e-3 * start.angularMomentum.norm())
        << frame.time;
    EXPECT_LT(frame.energy.kinetic, (1 + 1e-3) * start.kinetic) << frame.time;
  }
  EXPECT_FALSE(eventsOf(run, EventKind::impact).empty());
}

}  // namespace
}  // namespace cradle
