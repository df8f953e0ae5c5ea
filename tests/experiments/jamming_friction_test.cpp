// Friction that presses a sliding contact together (P. Painleve, "Sur les lois du frottement de glissement", 1895): no
// finite forces are found, and velocities jump without an impact.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "experiments/experiment.h"

namespace cradle {
namespace {

// A tilted cylinder that slides fast on its rim, with friction 3: it digs in after 22 ms.
Scene cylinderThatDigsIn(double accuracy) {
  return sceneWith(fmt::format(R"("duration": 0.025, "accuracy": {}, "output": {{"framesPerSecond": 1000}},
    "materials": {{"rough": {{"restitution": 1, "staticFriction": 3, "dynamicFriction": 3}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "rough"}},
    {{"name": "cylinder", "material": "rough", "mass": 0.17378797856444841,
      "shape": {{"cylinder": {{"radius": 0.097995611802747, "length": 0.039052138480202905}}}},
      "position": [0, 0.057687362185702806, 0], "linearVelocity": [-0.19299299439448525, 0, 0.8682322027741953],
      "orientation": {{"w": 0.9554908320234557, "x": 0.08653618496242976, "y": 0.2093619358399587,
                      "z": -0.18898766740879555}}}}],
    "ropes": [{{"bodyA": "cylinder", "anchorA": [0, 0, 0], "maxLength": 0.24700392869987756, "restitution": 1,
               "anchorB": [0.1897358765431903, 0.1416537590251807, -0.08586155410023939]}}])",
                               accuracy));
}

TEST(JammingFriction, IsSaidAndLeftToContactSteps) {
  std::vector<BodyState> ends;
  for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8}) {
    std::vector<std::string> warnings;
    std::vector<Frame> frames;
    simulate(cylinderThatDigsIn(accuracy), {[&](const Frame& frame) { frames.push_back(frame); }, [](const Event&) {},
                                            [&](const std::string& text) { warnings.push_back(text); }});
    EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("friction jams where contacts slide (floor, cylinder)")))
        << accuracy;
    // Contact takes energy, and friction this strong soon nearly all of it that is sliding's.
    for (std::size_t i = 1; i < frames.size(); ++i)
      EXPECT_LT(mechanicalEnergy(frames[i]), mechanicalEnergy(frames[i - 1]) + 1e-5 * frames[0].energy.kinetic)
          << accuracy << " " << frames[i].time;
    ends.push_back(frames.back().states[0]);
  }
  // Steps of 0.34 ms, and of 1 ms at the coarsest, lead on for 3 ms at less than 1 m/s: 3e-4 m between orders of them.
  for (const BodyState& end : ends) EXPECT_LT((end.position - ends.back().position).norm(), 3e-4);
}

/// A box of 50 g that stands on an edge, its upper face tilted by `degrees`, and on that a ball `ratio` times as heavy:
/// the ball wedges the box away until friction jams. The two corners on the floor stick, and are indeterminate.
Scene ballOnTiltedBox(double degrees, double ratio, double friction, double accuracy) {
  const double angle = degrees * std::atan(1.0) / 45, width = 0.03, radius = 0.04;
  const double height = width / 2 * (std::cos(angle) + std::sin(angle));
  const Vec3 up(0, std::cos(angle), std::sin(angle)), along(0, -std::sin(angle), std::cos(angle));
  const Vec3 ball = Vec3(0, height, 0) + (width / 2 + radius) * up - width / 4 * along;
  return sceneWith(fmt::format(R"("duration": 0.15, "accuracy": {}, "output": {{"framesPerSecond": 240}},
    "materials": {{"rough": {{"restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "rough"}},
    {{"name": "box", "material": "rough", "mass": 0.05, "shape": {{"box": {{"size": [0.08, {}, {}]}}}},
      "position": [0, {}, 0], "orientation": {{"w": {}, "x": {}, "y": 0, "z": 0}}}},
    {{"name": "ball", "material": "rough", "mass": {}, "shape": {{"sphere": {{"radius": {}}}}}, "position": {}}}])",
                               accuracy, friction, friction, width, width, height, std::cos(angle / 2),
                               std::sin(angle / 2), 0.05 * ratio, radius, vectorText(ball)));
}

// With indeterminate contacts beside it, the normal force of the ball grew without bound, and went on from minus
// infinity: it pulled, and friction drove the box to 1e5 m/s. Nothing here may gain energy. Contact steps may lose
// 5e-3.
TEST(JammingFriction, BesideIndeterminateContactsGainsNoEnergy) {
  struct Jam {
    double degrees, ratio, friction;
  };
  for (const Jam& jam : {Jam{35, 300, 0.3}, Jam{25, 100, 0.5}, Jam{30, 100, 0.4}})
    for (const double accuracy : {1e-3, 1e-5, 1e-7}) {
      const Trajectory run = simulate(ballOnTiltedBox(jam.degrees, jam.ratio, jam.friction, accuracy));
      double largest = 0, numerical = 0, fall = 0, most = 0;
      for (const Frame& frame : run.frames) {
        largest = std::max(largest, frame.energy.kinetic);
        numerical = std::max(numerical, std::abs(frame.energy.numerical));
        most = std::max(most, frame.energy.dissipated);
        fall = std::max(fall, most - frame.energy.dissipated);
      }
      EXPECT_LT(numerical, 5e-3 * largest) << jam.degrees << " " << accuracy;
      EXPECT_LT(fall, 1e-3 * largest) << jam.degrees << " " << accuracy;
    }
}

// A heavy ball slides on a light one, which it wedges away over the floor: friction drags it back at both contacts.
// Events without end were the way there. No ball gains energy; contact steps lose 5e-3.
TEST(JammingFriction, OfABallWedgedBetweenTheFloorAndAHeavyBallEndsThePromise) {
  for (const double accuracy : {1e-4, 1e-6, 1e-9}) {
    const Trajectory run = simulate(sceneWith(fmt::format(
        R"("duration": 0.05, "accuracy": {}, "output": {{"framesPerSecond": 240}},
      "materials": {{"rough": {{"restitution": 0.5, "staticFriction": 0.5, "dynamicFriction": 0.5}}}}, "bodies": [
      {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "rough"}},
      {{"name": "light", "material": "rough", "mass": 0.1, "shape": {{"sphere": {{"radius": 0.05}}}},
        "position": [0, 0.05, 0]}},
      {{"name": "heavy", "material": "rough", "mass": 10, "shape": {{"sphere": {{"radius": 0.05}}}},
        "position": {}, "linearVelocity": [0.3, -0.3, 0]}}])",
        accuracy, vectorText(Vec3(0.1 * std::sqrt(0.5), 0.05 + 0.1 * std::sqrt(0.5), 0)))));
    EXPECT_THAT(run.cost.promise, testing::StartsWith("light, heavy: promised while no contact of light, heavy jams, "
                                                      "or slides so slowly that its friction has no sure direction; "
                                                      "given up at "));
    EXPECT_THAT(run.cost.promise, testing::HasSubstr("friction jams where contacts slide (floor, light, heavy)"));
    const double start = mechanicalEnergy(run.frames.front());
    for (const Frame& frame : run.frames) EXPECT_LT(mechanicalEnergy(frame), start * (1 + 5e-3)) << frame.time;
  }
}

}  // namespace
}  // namespace cradle
