#include "simulate/welded_bodies.h"

#include <gtest/gtest.h>

#include "experiments/experiment.h"

namespace cradle {
namespace {

/// Balls b0 .. b5 a metre apart, a wall and a floor (bodies 6 and 7); `welds`: pairs of bodies, -1 for the world.
Scene weldedBalls(const std::vector<std::pair<int, int>>& welds) {
  std::string bodies, joints;
  for (int i = 0; i < 6; ++i) bodies += ball(fmt::format("b{}", i), Vec3(i, 0, 0)) + ", ";
  for (const auto& [a, b] : welds)
    joints += fmt::format(R"({}{{"bodyA": "b{}", "anchorA": [0, 0, 0], "anchorB": [{}, 0, 0]{}}})",
                          joints.empty() ? "" : ", ", a, b < 0 || b == 6 ? a : a - b,
                          b < 0 ? "" : fmt::format(R"(, "bodyB": "b{}")", b));
  return sceneWith(R"("duration": 1, "bodies": [)" + bodies +
                   R"({"name": "b6", "shape": {"box": {}}, "motion": "static"},
      {"name": "b7", "shape": {"plane": {}}, "motion": "static"}], "welds": [)" +
                   joints + "]");
}

TEST(WeldedBodies, AreOneFromWeldToWeld) {
  const Scene scene = weldedBalls({{3, 1}, {1, 0}, {4, 5}});
  const WeldedBodies welded(scene);
  EXPECT_TRUE(welded.areOne(0, 3) && welded.areOne(3, 1) && welded.areOne(5, 4));
  EXPECT_FALSE(welded.areOne(0, 2) || welded.areOne(3, 4) || welded.areOne(0, 6));
}

TEST(WeldedBodies, AreOneWithAllThatIsFixed) {
  const Scene scene = weldedBalls({{3, -1}, {1, 6}, {4, 3}});
  const WeldedBodies welded(scene);
  EXPECT_TRUE(welded.areOne(4, 6) && welded.areOne(4, 7) && welded.areOne(4, 1));
  EXPECT_FALSE(welded.areOne(0, 6) || welded.areOne(0, 4));
}

TEST(WeldedBodies, AreNoneWithoutWelds) {
  const Scene scene = weldedBalls({});
  const WeldedBodies welded(scene);
  EXPECT_FALSE(welded.areOne(0, 1) || welded.areOne(0, 6));
}

}  // namespace
}  // namespace cradle
