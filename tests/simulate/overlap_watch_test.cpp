#include "simulate/overlap_watch.h"

#include <gtest/gtest.h>

#include "experiments/ridged_ground.h"

namespace cradle {
namespace {

constexpr double kDepthRounding = 1e-15;  // m: of places below 4 m, and of overlaps that are their differences

/// Two balls of radius 0.1 m that move, over a floor and beside a post, which stands before them in the list.
const char* const kWatchedBalls = R"("duration": 1, "accuracy": 1e-5, "bodies": [
  {"name": "post", "shape": {"box": {"size": [2, 2, 2]}}, "motion": "static", "position": [-1, 1, 0]},
  {"name": "floor", "shape": {"plane": {}}, "motion": "static"},
  {"name": "one", "shape": {"sphere": {"radius": 0.1}}, "position": [3, 0.3, 0]},
  {"name": "other", "shape": {"sphere": {"radius": 0.1}}, "position": [0.3, 1, 0]}])";

struct Watched {
  /// Promises of the bodies in that order.
  explicit Watched(Scene source, const std::vector<Promise::Kind>& kinds = {}) : scene(std::move(source)) {
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      IslandPlan island;
      island.bodies = {static_cast<int>(i)};
      island.promise.kind = kinds[i];
      plan.islands.push_back(island);
    }
  }
  std::optional<Overlap> worstAt(const std::vector<Vec3>& places) {
    Frame frame;
    frame.time = 0.25;
    for (const Vec3& place : places) frame.states.push_back({place, Quat::Identity(), Vec3::Zero(), Vec3::Zero()});
    return watch().worstOf(frame);
  }
  OverlapWatch& watch() {
    if (!watch_) watch_.emplace(scene, plan);
    return *watch_;
  }

  Scene scene;
  Plan plan;

 private:
  std::optional<OverlapWatch> watch_;
};

constexpr Promise::Kind kPromised = Promise::Kind::kept, kUnpromised = Promise::Kind::none;

// The accuracy is scaled by 1 + |x|, as errors are; a billionth of the radius counts as touching.
TEST(OverlapWatch, AllowsTheAccuracyWhereItIsPromised) {
  for (const Promise::Kind kind : {kPromised, Promise::Kind::conditional}) {
    Watched at(sceneWith(kWatchedBalls), {kPromised, kPromised, kind, kUnpromised});
    const std::optional<Overlap> worst = at.worstAt({{3, 0.1 - 2e-5, 0}, {0.3, 1, 0}});
    ASSERT_TRUE(worst);
    EXPECT_EQ(worst->time, 0.25);
    EXPECT_EQ(std::minmax(worst->bodyA, worst->bodyB), std::minmax(1, 2));
    EXPECT_NEAR(worst->depth, 2e-5, kDepthRounding);
    EXPECT_NEAR(worst->allowed, 1e-5 * (1 + Vec3(3, -1e-5, 0).norm()) + 1e-9 * 0.1, 1e-18);
  }
}

// The body that moves decides, though what it is in comes first.
TEST(OverlapWatch, AllowsATenthOfTheRadiusWhereNothingIsPromised) {
  Watched at(sceneWith(kWatchedBalls), {kPromised, kPromised, kPromised, kUnpromised});
  const std::optional<Overlap> worst = at.worstAt({{3, 0.3, 0}, {0.1 - 2e-5, 1, 0}});
  ASSERT_TRUE(worst);
  EXPECT_EQ(std::minmax(worst->bodyA, worst->bodyB), std::minmax(0, 3));
  EXPECT_NEAR(worst->depth, 2e-5, kDepthRounding);
  EXPECT_NEAR(worst->allowed, 0.01, 1e-16);
}

TEST(OverlapWatch, PromisesNothingOnceItHasEnded) {
  Watched at(sceneWith(kWatchedBalls), {kPromised, kPromised, kPromised, kPromised});
  at.watch().endPromises();
  EXPECT_NEAR(at.worstAt({{3, 0.1 - 2e-5, 0}, {0.3, 1, 0}})->allowed, 0.01, 1e-16);
}

// 2e-5 m of 4e-5 m are more than 4.9e-3 m of 1e-2 m, and less than 5.1e-3 m.
TEST(OverlapWatch, TellsWhatIsDeepestAsPartOfWhatIsAllowed) {
  for (const double depth : {4.9e-3, 5.1e-3}) {
    Watched at(sceneWith(kWatchedBalls), {kPromised, kPromised, kPromised, kUnpromised});
    const std::optional<Overlap> worst = at.worstAt({{3, 0.1 - 2e-5, 0}, {0.1 - depth, 1, 0}});
    ASSERT_TRUE(worst);
    EXPECT_NEAR(worst->depth, depth < 5e-3 ? 2e-5 : depth, kDepthRounding);
  }
}

TEST(OverlapWatch, TellsOfNothingApart) {
  Watched at(sceneWith(kWatchedBalls), {kPromised, kPromised, kPromised, kPromised});
  EXPECT_FALSE(at.worstAt({{3, 0.1 + 1e-12, 0}, {0.3, 1, 0}}));
}

// Vertices of models have single precision: 1.2e-7 of the ball's radius are touching, whichever body is listed first.
TEST(OverlapWatch, AllowsTheRoundingOfModels) {
  const LoadedModel ground = ridgedGround({{-3, 0}, {3, 0}}, false);
  const std::string model =
                        R"({"name": "ground", "shape": {"mesh": "g.obj"}, "collision": "mesh", "motion": "static"})",
                    sphere = R"({"name": "ball", "shape": {"sphere": {"radius": 0.5}}, "position": [0.25, 0.6, 0]})";
  for (const std::string& bodies : {model + ", " + sphere, sphere + ", " + model}) {
    Watched at(parseScene(R"({"schema": "cradle-scene/1", "name": "watched", "duration": 1, "accuracy": 1e-9,
                          "bodies": [)" +
                              bodies + "]}",
                          "watched.json", [&](const MeshReference&) { return ground; })
                   .scene,
               {kPromised, kPromised});
    const std::optional<Overlap> worst = at.worstAt({{0.25, 0.5 - 1e-7, 0}});
    ASSERT_TRUE(worst);
    EXPECT_NEAR(worst->depth, 1e-7, kDepthRounding);
    EXPECT_NEAR(worst->allowed, 1e-9 * (1 + 0.25) + 1.2e-7 * 0.5, 1e-15);
  }
}

TEST(OverlapWatch, IsDescribedInASentence) {
  const Scene scene = sceneWith(kWatchedBalls);
  EXPECT_EQ(describe(Overlap{0.5, 3, 0, 0.01234, 1e-6}, scene),
            R"(at 0.5 s "other" is 0.0123 m deep in "post"; 1e-06 m is allowed)");
}

}  // namespace
}  // namespace cradle
