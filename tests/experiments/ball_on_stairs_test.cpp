// A ball that hops down stairs, one step at a time.

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/experiment.h"

namespace cradle {
namespace {

constexpr double kHoppingRadius = 0.02, kRise = 0.17, kTread = 0.29;  // m
constexpr int kSteps = 8;

// A ball that lands with v and leaves with e v, and lands on the next step as it did on this one, has
// v^2 = (e v)^2 + 2 g h; between is T = (1 + e) v / g, in which it goes on by one tread. Friction of the treads finds
// nothing to do on a ball that rolls: w r = u.
TEST(BallOnStairs, LandsAtTheSamePlaceOfEachStep) {
  const double restitution = 0.75, tread = 0.3 * kTread;  // m: where it lands, from the edge above
  const double landing = std::sqrt(2 * kGravity * kRise / (1 - restitution * restitution));
  const double period = (1 + restitution) * landing / kGravity, speed = kTread / period;
  for (const double friction : {0.0, 0.6}) {
    const double spin = friction > 0 ? -speed / kHoppingRadius : 0;
    std::string stairs;
    for (int i = 0; i < kSteps; ++i)
      stairs += fmt::format(R"({{"name": "step{}", "material": "m", "motion": "static",
        "shape": {{"box": {{"size": [{}, 0.2, 1]}}}}, "position": [{}, {}, 0]}}, )",
                            i, kTread, (i + 0.5) * kTread, -i * kRise - 0.1);
    // Frames at the middle of each flight: the impacts are at (i + 1/2) T.
    const Scene scene = sceneWith(fmt::format(
        R"("duration": {}, "accuracy": 1e-9, "output": {{"framesPerSecond": {}}},
        "materials": {{"m": {{"restitution": {}, "staticFriction": {}, "dynamicFriction": {}}}}},
        "bodies": [{} {{"name": "ball", "material": "m", "shape": {{"sphere": {{"radius": {}}}}},
          "position": {}, "linearVelocity": {}, "angularVelocity": [0, 0, {}]}}])",
        (kSteps - 1.4) * period, 1 / period, restitution, friction, friction, stairs, kHoppingRadius,
        vectorText(Vec3(tread, kHoppingRadius, 0) +
                   period / 2 * Vec3(speed, restitution * landing - kGravity * period / 4, 0)),
        vectorText(Vec3(speed, restitution * landing - kGravity * period / 2, 0)), spin));
    const Trajectory run = simulate(scene);
    const BodyState& first = run.frames[0].states[0];
    EXPECT_EQ(eventsOf(run, EventKind::impact).size(), static_cast<std::size_t>(kSteps) - 2);
    for (const Frame& frame : run.frames) {
      const BodyState& state = frame.states[0];
      const double steps = static_cast<double>(frame.number);
      // An error of the speed after an impact is e times as large after the next: sums of accuracies.
      EXPECT_LT((state.position - first.position - steps * Vec3(kTread, -kRise, 0)).norm(), 1e-8) << steps;
      EXPECT_LT((state.linearVelocity - first.linearVelocity).norm(), 1e-8) << steps;
      EXPECT_LT((state.angularVelocity - first.angularVelocity).norm(), 1e-6) << steps;
    }
  }
}

}  // namespace
}  // namespace cradle
