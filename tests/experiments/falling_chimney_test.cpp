// A slender box that stands on a floor, hinged there along an edge of its foot, and falls over.

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/experiment.h"

namespace cradle {
namespace {

constexpr double kChimneyHeight = 2, kChimneyWidth = 0.02;  // m

/// Falls towards +x about the edge of its foot on the origin, `gap` (m) above the floor there.
Trajectory fallOf(double accuracy, double gap, double duration) {
  return simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 1000}},
      "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static"}},
        {{"name": "chimney", "shape": {{"box": {{"size": [{}, {}, {}]}}}}, "position": [{}, {}, 0],
          "angularVelocity": [0, 0, -0.5]}}],
      "hinges": [{{"bodyA": "chimney", "anchorA": [{}, {}, 0], "anchorB": [0, {}, 0], "axis": [0, 0, 1]}}])",
      duration, accuracy, kChimneyWidth, kChimneyHeight, kChimneyWidth, -kChimneyWidth / 2, kChimneyHeight / 2 + gap,
      kChimneyWidth / 2, -kChimneyHeight / 2, gap)));
}

/// Angle (rad) of the centre of mass from straight above the edge, towards +x.
double leanOf(const BodyState& state, double gap) {
  return std::atan2(state.position.x(), state.position.y() - gap);
}

class FallingChimney : public testing::TestWithParam<double> {};

// About the edge the moment of inertia is m ((L^2 + w^2) / 12 + d^2) = 4/3 m d^2, d the distance of the centre of mass:
// w^2 = w0^2 + 2 g d / (4/3 d^2) (cos a0 - cos a), w' = 3/4 g sin(a) / d. The tip, 2 d from the edge but for the width,
// is accelerated by 3/2 g sin(a): faster than what falls freely as soon as sin(a) > 2/3.
TEST_P(FallingChimney, FollowsTheClosedFormOfAPhysicalPendulum) {
  const double accuracy = 1e-8, gap = GetParam();
  const double distance = std::hypot(kChimneyHeight, kChimneyWidth) / 2;
  const Trajectory run = fallOf(accuracy, gap, 0.9);
  const double start = leanOf(run.frames[0].states[0], gap);
  for (std::size_t i = 1; i + 1 < run.frames.size(); ++i) {
    const BodyState &before = run.frames[i - 1].states[0], &state = run.frames[i].states[0],
                    &after = run.frames[i + 1].states[0];
    const double lean = leanOf(state, gap);
    const double squared = 0.25 + 1.5 * kGravity / distance * (std::cos(start) - std::cos(lean));
    ASSERT_NEAR(-state.angularVelocity.z(), std::sqrt(squared), 100 * accuracy) << run.frames[i].time;
    ASSERT_NEAR(state.position.z(), 0, 1e-12);
    ASSERT_NEAR(std::hypot(state.position.x(), state.position.y() - gap), distance, 1e-9);
    // Differences over 2 ms: w''' (1 ms)^2 / 6 < 100 x 1e-6 / 6.
    const double acceleration = (before.angularVelocity - after.angularVelocity).z() / 0.002;
    ASSERT_NEAR(2 * distance * acceleration, 1.5 * kGravity * std::sin(lean), 1e-4) << run.frames[i].time;
  }
  EXPECT_GT(leanOf(run.frames.back().states[0], gap), std::asin(2. / 3));
}

// It strikes the floor flat, by its side, and lies there: with a gap at the hinge, tilted by as little; within the
// accuracy, and steps of one length leave it 1e-5 of its width high.
TEST_P(FallingChimney, LiesFlatAtLast) {
  for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
    const BodyState end = endOf(fallOf(accuracy, GetParam(), 1.5));
    EXPECT_NEAR(end.position.x(), kChimneyHeight / 2, 2e-4) << accuracy;
    EXPECT_NEAR(end.position.y(), kChimneyWidth / 2, GetParam() + (accuracy + 1e-5) * kChimneyWidth) << accuracy;
    EXPECT_LT(end.linearVelocity.norm(), 1e-9) << accuracy;
  }
}

INSTANTIATE_TEST_SUITE_P(Gaps, FallingChimney, testing::Values(0, 1e-3),
                         [](const auto& info) { return "Index" + std::to_string(info.index); });

}  // namespace
}  // namespace cradle
