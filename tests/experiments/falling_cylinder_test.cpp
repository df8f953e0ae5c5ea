// A cylinder that is let go on its rim falls flat on its end or its side. Its lowest point then runs around the rim at
// once.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/experiment.h"

namespace cradle {
namespace {

struct FallingCylinder {
  double radius, length;  // m
  double degrees;         // of the axis from the vertical
  double restitution;
};

Scene fallOf(const FallingCylinder& fall, double accuracy) {
  const double angle = fall.degrees * std::atan(1.0) / 45;
  const double height = fall.length / 2 * std::cos(angle) + fall.radius * std::sin(angle);
  return sceneWith(fmt::format(R"("duration": 0.4, "accuracy": {}, "output": {{"framesPerSecond": 240}},
    "materials": {{"m": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
    {{"name": "cylinder", "material": "m", "mass": 1, "shape": {{"cylinder": {{"radius": {}, "length": {}}}}},
      "position": [0, {}, 0], "orientation": {{"w": {}, "x": {}, "y": 0, "z": 0}}}}])",
                               accuracy, fall.restitution, fall.radius, fall.length, height + 0.001,
                               std::cos(angle / 2), std::sin(angle / 2)));
}

// Coarse steps went through the flat position, where the lowest point changes sides, and lost all of the energy, or had
// more than can be. Errors of some steps at 1e-2, and of the time stepping that follows, are 1.2e-2 of it at most.
TEST(FallingCylinder, LosesNoEnergyBetweenImpactsAtAnyAccuracy) {
  for (const auto& [radius, length] : {std::pair{0.03, 0.01}, {0.03, 0.12}, {0.1, 0.05}, {0.1, 0.12}})
    for (const double degrees : {10, 20, 40, 60})
      for (const double restitution : {0.0, 0.5})
        for (const double accuracy : {1e-2, 1e-3}) {
          const Trajectory run = simulate(fallOf({radius, length, degrees, restitution}, accuracy));
          double largest = 0, numerical = 0;
          for (const Frame& frame : run.frames) {
            largest = std::max(largest, frame.energy.kinetic);
            numerical = std::max(numerical, std::abs(frame.energy.numerical));
          }
          EXPECT_LT(numerical, 2e-2 * largest)
              << radius << " " << length << " " << degrees << " " << restitution << " " << accuracy;
        }
}

}  // namespace
}  // namespace cradle
