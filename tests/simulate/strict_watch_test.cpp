#include "simulate/strict_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/experiment.h"
#include "simulate/world.h"

namespace cradle {
namespace {

using testing::HasSubstr;

/// A sphere of 0.1 m on the ground, for an accuracy of 1e-6.
Scene sphereOnGround(const std::string& more = "") {
  return sceneWith(R"("duration": 1, "bodies": [{"name": "ground", "shape": {"plane": {}}, "motion": "static"},
    {"name": "sphere", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.1, 0]}])" +
                   more);
}

/// What a watch says of a frame in which that sphere is `depth` (m) in the ground; empty if it is content.
std::string saidOf(double depth, StrictWatch& watch, double time = 0.5) {
  Frame frame{30, time, {BodyState{}}, {}};
  frame.states[0].position = Vec3(0, 0.1 - depth, 0);
  try {
    watch.check(frame);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    return error.what();
  }
  return "";
}

std::string saidOf(double depth, const Scene& scene) {
  StrictWatch watch(scene, planOf(scene));
  return saidOf(depth, watch);
}

// Relative to 1 + |x|, as accuracies are, at a point on the ground at the origin.
TEST(StrictWatch, AllowsOverlapsOfWhatIsPromisedUpToTheAccuracy) {
  const Scene scene = sphereOnGround();
  EXPECT_EQ(saidOf(-1e-3, scene), "");
  EXPECT_EQ(saidOf(0.99e-6, scene), "");
  EXPECT_THAT(saidOf(1.01e-6, scene),
              HasSubstr("strict: at 0.5 s \"sphere\" is 1.01e-06 m deep in \"ground\"; 1e-06 m is allowed"));
}

TEST(StrictWatch, AllowsOverlapsOfWhatIsNotPromisedUpToATenthOfTheRadius) {
  const Scene scene = sphereOnGround(R"(, "method": {"name": "rk4", "timeStep": 0.001})");
  EXPECT_EQ(saidOf(0.0099, scene), "");
  EXPECT_THAT(saidOf(0.0101, scene), HasSubstr("\"sphere\" is 0.0101 m deep in \"ground\"; 0.01 m is allowed"));
}

TEST(StrictWatch, TellsTheFirstFaultInTheOrderOfTimeOnceAFrameShowsIt) {
  const Scene scene = sphereOnGround();
  StrictWatch watch(scene, planOf(scene));
  watch.note(PromiseEnd{0.4, "edges touch and press", {0, 1}, {}});
  watch.note(Correction{CorrectionKind::clampedEnergy, 0.3, {1}, 2});
  EXPECT_EQ(saidOf(0, watch, 0.29), "");
  EXPECT_THAT(saidOf(0, watch, 0.5),
              HasSubstr("strict: experiment.json: at 0.3 s contact would have given \"sphere\""));
  StrictWatch other(scene, planOf(scene));
  other.note(PromiseEnd{0.4, "edges touch and press", {0, 1}, {}});
  EXPECT_THAT(saidOf(0, other, 0.4),
              HasSubstr("strict: at 0.4 s the accuracy asked was given up: edges touch and press (ground, sphere)"));
}

TEST(StrictWatch, TellsInTheEndWhatOnlyTheEndShows) {
  const Scene scene = sphereOnGround();
  StrictWatch watch(scene, planOf(scene));
  EXPECT_NO_THROW(watch.finish());
  watch.note(PromiseEnd{0.4, "numerical energy is beyond 10 times the accuracy", {1}, {}});
  EXPECT_THROW(watch.finish(), Error);
}

}  // namespace
}  // namespace cradle
