// Two equal cylinders side by side on a floor, a third on top of them.

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/experiment.h"

namespace cradle {
namespace {

constexpr double kCylinderRadius = 0.1;   // m
const double kSide = 2 - std::sqrt(3.0);  // tan 15 degrees
const double kFloor = kSide / 3;          // see below

/// Of cylinders apart by `gap` (m) below; frictions between them, and between them and the floor.
Trajectory runOf(double side, double floor, double accuracy, double duration) {
  const auto cylinder = [](const char* name, double x, double y) {
    return fmt::format(R"({{"name": "{}", "material": "wood", "shape": {{"cylinder": {{"radius": {}, "length": 0.3}}}},
      "position": [{}, {}, 0], "orientation": {{"axis": [1, 0, 0], "angleDegrees": 90}}}})",
                       name, kCylinderRadius, x, y);
  };
  return simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": {},
      "materials": {{"wood": {{"staticFriction": {}, "dynamicFriction": {}}},
                     "earth": {{"staticFriction": {}, "dynamicFriction": {}}}}},
      "pairs": [{{"materials": ["wood", "earth"], "staticFriction": {}, "dynamicFriction": {}}}],
      "bodies": [{{"name": "floor", "material": "earth", "shape": {{"plane": {{}}}}, "motion": "static"}}, {}, {}, {}])",
      duration, accuracy, side, side, floor, floor, floor, floor, cylinder("left", -kCylinderRadius, kCylinderRadius),
      cylinder("right", kCylinderRadius, kCylinderRadius),
      cylinder("top", 0, (1 + std::sqrt(3.0)) * kCylinderRadius))));
}

double fallOfTop(const Trajectory& run) {
  return run.frames.front().states[2].position.y() - run.frames.back().states[2].position.y();
}

// A lower cylinder is touched by the upper one 30 degrees off the vertical, and by the floor. The torques about its
// axis vanish if both friction forces F are equal, those about its point on the floor if the upper contact's force goes
// through that point: F / N = tan 15 degrees there. Above, 2 (N cos 30 + F sin 30) = m g, so F = m g (2 - sqrt 3) / 2 =
// N_floor (2 - sqrt 3) / 3 with N_floor = 3/2 m g.
TEST(ThreeCylinders, StandWhileBothFrictionsSuffice) {
  for (const double accuracy : {1e-3, 1e-6})
    for (const double beyond : {1.0, 0.02, 1e-3}) {
      const Trajectory run = runOf((1 + beyond) * kSide, (1 + beyond) * kFloor, accuracy, 0.5);
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_LT((run.frames.back().states[i].position - run.frames.front().states[i].position).norm(), 1e-9)
            << beyond << " beyond, accuracy " << accuracy;
    }
}

TEST(ThreeCylinders, FallIfEitherFrictionIsTooSmall) {
  for (const double accuracy : {1e-3, 1e-6}) {
    EXPECT_GT(fallOfTop(runOf(0.98 * kSide, 2 * kFloor, accuracy, 0.5)), 1e-3) << accuracy;
    EXPECT_GT(fallOfTop(runOf(2 * kSide, 0.98 * kFloor, accuracy, 0.5)), 1e-3) << accuracy;
  }
}

}  // namespace
}  // namespace cradle
