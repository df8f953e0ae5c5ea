// Islands and what they touch, against all pairs of bodies.

#include "simulate/plan/plan_islands.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <random>

#include "constraints/disjoint_sets.h"
#include "experiments/experiment.h"

namespace cradle {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double number(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random_); }
  int index(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  bool isTrue(double probability) { return number(0, 1) < probability; }
  Vec3 place() { return {number(-8, 8), number(-8, 8), number(-8, 8)}; }

 private:
  std::mt19937 random_;
};

/// Spheres at rest without gravity, some fixed, some that touch nothing; pendulums on rods, whose reach ends; joints
/// between bodies, of which some let these touch. `isThrown`: some are on no rod, and have no bounds once they may
/// touch.
std::string randomScene(unsigned seed, bool isThrown) {
  constexpr int kBodies = 25;
  Draw draw(seed);
  std::string bodies, rods, joints;
  std::vector<Vec3> places;
  for (int i = 0; i < kBodies; ++i) {
    const bool isFixed = draw.isTrue(0.2);
    places.push_back(draw.place());
    bodies += fmt::format(R"({}{{"name": "b{}", "shape": {{"sphere": {{"radius": {:.3f}}}}}, "position": {}, {}{}}})",
                          i > 0 ? ", " : "", i, draw.number(0.05, 0.4), vectorText(places.back()),
                          isFixed ? R"("motion": "static")" : R"("mass": 1)",
                          draw.isTrue(0.1)                           ? R"(, "collision": "none")"
                          : isThrown && !isFixed && draw.isTrue(0.2) ? R"(, "linearVelocity": [1, 2, 3])"
                                                                     : "");
    if (!isFixed && (draw.isTrue(0.5) || !isThrown))
      rods +=
          fmt::format(R"({}{{"bodyA": "b{}", "anchorB": {}}})", rods.empty() ? "" : ", ", i, vectorText(draw.place()));
    if (isFixed || i == 0 || !draw.isTrue(0.2)) continue;
    const int other = draw.index(i);
    joints += fmt::format(R"({}{{"bodyA": "b{}", "bodyB": "b{}", "anchorA": [0, 0, 0], "anchorB": {}, "collide": {}}})",
                          joints.empty() ? "" : ", ", i, other,
                          vectorText(places.back() - places[static_cast<std::size_t>(other)]), draw.isTrue(0.3));
  }
  if (draw.isTrue(0.5))
    bodies +=
        fmt::format(R"(, {{"name": "p", "shape": {{"plane": {{}}}}, "motion": "static", "position": [0, {:.2f}, 0]}})",
                    draw.number(-12, -8));
  return fmt::format(R"({{"schema": "cradle-scene/1", "name": "random", "duration": 1, "gravity": [0, 0, 0],
    "bodies": [{}], "rods": [{}], "ballJoints": [{}]}})",
                     bodies, rods, joints);
}

struct Islands {
  std::vector<std::vector<int>> bodies, touching;
};

bool isMoving(const Scene& scene, int body) {
  return body >= 0 && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic;
}

/// By looking at each pair.
Islands islandsOfAllPairs(const Scene& scene, const ReachablePairs& reachable) {
  const int count = static_cast<int>(scene.bodies.size());
  DisjointSets joined(scene.bodies.size());
  const auto join = [&](int a, int b) {
    if (isMoving(scene, a) && isMoving(scene, b)) joined.join(a, b);
  };
  forEachLink(scene, [&](const LinkIndex&, const Anchor& a, const Anchor& b) { join(a.body, b.body); });
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j)
      if (reachable.mayCollide(i, j)) join(i, j);
  Islands islands;
  for (int first = 0; first < count; ++first) {
    if (!isMoving(scene, first) || joined.islandOf(first) != first) continue;
    const auto isMember = [&](int body) { return isMoving(scene, body) && joined.islandOf(body) == first; };
    std::vector<int> bodies, touching;
    for (int i = 0; i < count; ++i) {
      if (isMember(i)) bodies.push_back(i);
      bool touches = false;
      for (int j = 0; j < count; ++j)
        touches = touches || (i != j && (isMember(i) || isMember(j)) && reachable.mayCollide(i, j));
      if (touches) touching.push_back(i);
    }
    islands.bodies.push_back(bodies), islands.touching.push_back(touching);
  }
  return islands;
}

// Scenes in which something has no bounds, and in which nothing has.
TEST(PlanIslands, AreThoseOfAllPairs) {
  int boundless = 0, bounded = 0, islandsOfSome = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Scene scene = sceneOf(randomScene(seed, seed % 2 == 0));
    const ReachablePairs reachable(scene);
    ++(reachable.boundless() ? boundless : bounded);
    const Islands expected = islandsOfAllPairs(scene, reachable);
    const std::vector<IslandPlan> found = findIslands(scene, reachable);
    ASSERT_EQ(found.size(), expected.bodies.size()) << seed;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].bodies, expected.bodies[i]) << seed;
      EXPECT_EQ(found[i].touching, expected.touching[i]) << seed;
      islandsOfSome += found[i].bodies.size() > 1;
    }
  }
  EXPECT_GT(boundless, 50);
  EXPECT_GT(bounded, 50);
  EXPECT_GT(islandsOfSome, 100);
}

/// Two balls 6 m apart on short rods, which a table may touch, and one that hangs from its middle.
Scene aroundATable(const std::string& motion) {
  std::string bodies = R"({"name": "table", "shape": {"box": {"size": [8, 0.2, 2]}}, )" + motion + "}";
  for (const auto& [name, place] :
       {std::pair("left", Vec3(-3, 0.3, 0)), {"right", {3, 0.3, 0}}, {"hung", {0, -0.6, 0}}})
    bodies += fmt::format(R"(, {{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "position": {}}})", name,
                          vectorText(place));
  return sceneWith(
      R"("duration": 0.1, "bodies": [)" + bodies +
      R"(], "rods": [{"bodyA": "left", "anchorB": [-3, 0.6, 0]}, {"bodyA": "right", "anchorB": [3, 0.6, 0]},
                                  {"bodyA": "hung", "bodyB": "table", "anchorB": [0, 0, 0]}])");
}

// As what is fixed: bodies that touch it or hang on it do not depend on each other by that. Unlike that, it is one of
// the bodies of each of their islands.
TEST(PlanIslands, AreNotJoinedByWhatIsDriven) {
  const Scene scene = aroundATable(R"("motion": "driven", "oscillation": {"amplitude": 0.1, "frequency": 1})");
  const std::vector<IslandPlan> islands = findIslands(scene, ReachablePairs(scene));
  ASSERT_EQ(islands.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(islands[i].bodies, std::vector<int>{static_cast<int>(i) + 1});
    EXPECT_EQ(islands[i].driven, std::vector<int>{0});
  }
  const Scene dynamic = aroundATable(R"("motion": "dynamic")");
  EXPECT_EQ(findIslands(dynamic, ReachablePairs(dynamic)).size(), 1u);
}

}  // namespace
}  // namespace cradle
