// What a scene needs, and no more: islands, contact that may come about, and what each costs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/ridged_ground.h"
#include "simulate/plan/plan.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

std::string ball(const std::string& name, const Vec3& position, const std::string& more = "") {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": {}{}}})", name,
                     vectorText(position), more.empty() ? "" : ", " + more);
}
const std::string kTouchesNothing = R"("collision": "none")";
const std::string kFloor = R"({"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static"})";

Plan planWith(const std::string& bodies, const std::string& more = "") {
  return planOf(sceneWith(R"("duration": 1, "bodies": [)" + bodies + "]" + more));
}

std::vector<std::vector<int>> islandsOf(const Plan& plan) {
  std::vector<std::vector<int>> islands;
  for (const IslandPlan& island : plan.islands) islands.push_back(island.bodies);
  return islands;
}

TEST(DisjointSets, AreBodiesThatSpringsRodsRopesAndJointsTie) {
  std::string bodies;
  for (int i = 0; i < 10; ++i) bodies += ball(fmt::format("b{}", i), Vec3(100 * i, 0, 0), kTouchesNothing) + ", ";
  const auto ends = [](int a, int b) {
    return fmt::format(R"("bodyA": "b{}", "anchorA": [0, 0, 0], "bodyB": "b{}", "anchorB": [{}, 0, 0])", a, b,
                       100 * (a - b));
  };
  const Plan plan =
      planWith(bodies + kFloor,
               fmt::format(R"(, "springs": [{{{}, "stiffness": 1}}], "rods": [{{{}}}],
      "ropes": [{{{}}}], "ballJoints": [{{{}}}], "hinges": [{{{}}}], "sliders": [{{{}}}], "welds": [{{{}}}])",
                           ends(0, 2), R"("bodyA": "b1", "anchorA": [0, 0, 0], "bodyB": "b3", "anchorB": [0, 1, 0])",
                           R"("bodyA": "b3", "anchorA": [0, 0, 0], "bodyB": "b4", "anchorB": [0, 1, 0])", ends(4, 5),
                           ends(5, 1), ends(7, 8), ends(8, 9)));
  EXPECT_THAT(islandsOf(plan),
              ElementsAre(ElementsAre(0, 2), ElementsAre(1, 3, 4, 5), ElementsAre(6), ElementsAre(7, 8, 9)));
}

// All are tied to the world, and the floor lies under them: neither joins them.
TEST(DisjointSets, AreNotJoinedByTheWorldOrByFixedBodies) {
  const Plan plan = planWith(ball("a", Vec3(0, 5, 0)) + ", " + ball("b", Vec3(3, 5, 0)) + ", " + kFloor,
                             R"(, "rods": [{"bodyA": "a", "anchorA": [0, 0, 0], "anchorB": [0, 6, 0]},
        {"bodyA": "b", "anchorA": [0, 0, 0], "bodyB": "floor", "anchorB": [3, 6, 0]}])");
  EXPECT_THAT(islandsOf(plan), ElementsAre(ElementsAre(0), ElementsAre(1)));
}

TEST(DisjointSets, AreAHundredForAHundredSuspendedModels) {
  std::string bodies, springs;
  for (int i = 0; i < 100; ++i) {
    bodies += (i ? ", " : "") + ball(fmt::format("b{}", i), Vec3(10 * (i % 10), 10 * (i / 10), 0));
    springs += fmt::format(R"({}{{"bodyA": "b{}", "anchorA": [0, 0.1, 0], "anchorB": [{}, {}, 0], "stiffness": 50}})",
                           i ? ", " : "", i, 10 * (i % 10), 10 * (i / 10) + 1);
  }
  const Plan plan = planWith(bodies, R"(, "springs": [)" + springs + "]");
  EXPECT_EQ(plan.islands.size(), 100u);
  for (const IslandPlan& island : plan.islands) {
    EXPECT_THAT(island.touching, IsEmpty());
    EXPECT_TRUE(island.method.isAdaptive());
  }
}

TEST(Plan, TakesTheClosedFormWhereNothingButGravityActs) {
  const Plan plan =
      planWith(ball("a", Vec3(0, 0, 0), kTouchesNothing) + ", " + ball("b", Vec3(3, 0, 0), kTouchesNothing) + ", " +
                   ball("c", Vec3(6, 0, 0), kTouchesNothing),
               R"(, "springs": [{"bodyA": "b", "anchorA": [0, 0, 0], "anchorB": [3, 1, 0], "stiffness": 1}],
      "pushes": [{"body": "c", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0.5, "duration": 0.1}])");
  ASSERT_THAT(islandsOf(plan), ElementsAre(ElementsAre(0), ElementsAre(1), ElementsAre(2)));
  EXPECT_TRUE(plan.islands[0].method.isClosedForm());
  EXPECT_TRUE(plan.islands[1].method.isAdaptive());
  EXPECT_TRUE(plan.islands[2].method.isAdaptive());
}

// Thrown at each other they meet after 0.4 s; thrown past each other at a distance of 30 m, or away from each other,
// they never do. In 1 s a ball sags from its chord by g/8.
TEST(FlyingBodies, ShareAnIslandOnlyIfTheirPathsMayCross) {
  const auto pairOf = [](const Vec3& position, const Vec3& velocity) {
    return planWith(ball("a", Vec3::Zero(), R"("linearVelocity": [5, 0, 0])") + ", " +
                    ball("b", position, R"("linearVelocity": )" + vectorText(velocity)));
  };
  EXPECT_EQ(pairOf(Vec3(4, 0, 0), Vec3(-5, 0, 0)).islands.size(), 1u);
  EXPECT_EQ(pairOf(Vec3(4, 0, 30), Vec3(-5, 0, 0)).islands.size(), 2u);
  EXPECT_EQ(pairOf(Vec3(-10, 0, 0), Vec3(-5, 0, 0)).islands.size(), 2u);
}

// The flying ball may hit the hanging one, which then flies no more where its spring alone would let it: the third,
// which a swing of the second would never reach, may be hit too.
TEST(BodiesThatMayBeThrown, LoseTheirBounds) {
  const std::string hung = ball("hung", Vec3(0, 0, 0)), far = ball("far", Vec3(0, 0, 3), R"("motion": "static")");
  const std::string spring =
      R"(, "gravity": [0, 0, 0], "springs": [{"bodyA": "hung", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0], "stiffness": 50}])";
  EXPECT_THAT(planWith(hung + ", " + far, spring).islands.at(0).touching, IsEmpty());
  const Plan plan =
      planWith(hung + ", " + far + ", " + ball("thrown", Vec3(5, 0, 0), R"("linearVelocity": [-9, 0, 0])"), spring);
  ASSERT_EQ(plan.islands.size(), 1u);
  EXPECT_THAT(plan.islands[0].touching, ElementsAre(0, 1, 2));
}

TEST(Joints, ExcludeContactOfTheBodiesThatTheyJoin) {
  const std::string boxes = R"({"name": "a", "shape": {"box": {"size": [1, 1, 1]}}},
    {"name": "b", "shape": {"box": {"size": [1, 1, 1]}}, "position": [0.9, 0, 0]},
    {"name": "c", "shape": {"box": {"size": [1, 1, 1]}}, "position": [0, 2, 0]})";
  for (const std::string kind : {"ballJoints", "hinges", "sliders", "welds"}) {
    const Plan plan =
        planWith(boxes, R"(, ")" + kind +
                            R"(": [{"bodyA": "b", "anchorA": [-0.4, 0, 0], "bodyB": "a", "anchorB": [0.5, 0, 0]}])");
    ASSERT_EQ(plan.islands.size(), 1u) << kind;
    EXPECT_THAT(plan.islands[0].touching, ElementsAre(0, 1, 2)) << kind;
  }
}

// A tray of three boxes, of which b is welded to both others: they are one, and nothing else is there to be touched.
TEST(Welds, ExcludeContactWithinTheBodyThatTheyMake) {
  const Plan plan =
      planWith(R"({"name": "a", "shape": {"box": {"size": [1, 1, 1]}}},
    {"name": "b", "shape": {"box": {"size": [1, 1, 1]}}, "position": [1, 0, 0]},
    {"name": "c", "shape": {"box": {"size": [1, 1, 1]}}, "position": [0.5, 0.75, 0]})",
               R"(, "welds": [{"bodyA": "b", "anchorA": [-0.5, 0, 0], "bodyB": "a", "anchorB": [0.5, 0, 0]},
    {"bodyA": "b", "anchorA": [0, 0.5, 0], "bodyB": "c", "anchorB": [0.5, -0.25, 0]}])");
  ASSERT_EQ(plan.islands.size(), 1u);
  EXPECT_THAT(plan.islands[0].touching, IsEmpty());
  EXPECT_EQ(plan.islands[0].promise.kind, Promise::Kind::kept);
}

/// A prism with a hollow, an L, over the floor.
MotionKind methodOfPrism(double accuracy, const std::string& collision) {
  const std::string text = fmt::format(R"({{"schema": "cradle-scene/1", "name": "prism", "duration": 1, "accuracy": {},
    "bodies": [{}, {{"name": "prism", "shape": {{"mesh": "{}/assets/l_prism.3ds"}}, "collision": "{}",
      "position": [0, 1, 0]}}]}})",
                                       accuracy, kFloor, CRADLE_SOURCE_DIR, collision);
  return planOf(parseScene(text, "prism.json", modelFilesBeside("prism.json")).scene).islands.at(0).method.kind;
}

TEST(Plan, TakesContactStepsForMeshesThatMayTouchWhereALookIsEnough) {
  EXPECT_EQ(methodOfPrism(1e-3, "auto"), MotionKind::fixedSteps);
  EXPECT_EQ(methodOfPrism(1e-4, "auto"), MotionKind::errorSteps);
  EXPECT_EQ(methodOfPrism(1e-3, "hull"), MotionKind::errorSteps);
  EXPECT_EQ(methodOfPrism(1e-3, "none"), MotionKind::freeFlight);
}

// Sixty balls over the same ground, closed and as a sheet.
TEST(Plan, TakesNoSoftContactsWithAMeshThatIsNotClosed) {
  for (const bool isSheet : {false, true}) {
    const std::string text = fmt::format(
        R"({{"schema": "cradle-scene/1", "name": "ground", "duration": 1, "accuracy": 1e-3,
      "bodies": [{{"name": "ground", "shape": {{"mesh": "ground.obj"}}, "collision": "mesh", "motion": "static"}},
        {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [-1, 0.2, 0],
         "copies": {{"count": [6, 10, 1], "spacing": [0.3, 0.3, 1]}}}}]}})");
    const LoadedModel ground = ridgedGround({{-3, 0.1}, {0, 0}, {3, 0.1}}, isSheet);
    const Plan plan = planOf(parseScene(text, "ground.json", [&](const MeshReference&) { return ground; }).scene);
    ASSERT_EQ(plan.islands.size(), 1u);
    EXPECT_EQ(plan.islands[0].method.kind, isSheet ? MotionKind::fixedSteps : MotionKind::pile);
    EXPECT_EQ(std::any_of(plan.islands[0].notNeeded.begin(), plan.islands[0].notNeeded.end(),
                          [](std::string_view line) { return line.find("not closed") != std::string_view::npos; }),
              isSheet);
  }
}

long evaluationsOf(const std::string& members) {
  return simulate(sceneWith(members)).cost.evaluations;
}

// 0.5 s at 60 frames a second are 31 frames.
TEST(Evaluations, OfABodyInFreeFlightAreOneAFrame) {
  EXPECT_EQ(evaluationsOf(R"("duration": 0.5, "bodies": [)" + ball("a", Vec3::Zero()) + "]"), 31);
  EXPECT_EQ(evaluationsOf(R"("duration": 0.5, "bodies": [)" + ball("a", Vec3::Zero()) + ", " +
                          ball("b", Vec3(9, 0, 0)) + "]"),
            62);
}

std::string lyingBox(double duration, const std::string& more = "") {
  return fmt::format(R"("duration": {}, "bodies": [{}, {{"name": "box", "shape": {{"box": {{"size": [1, 1, 1]}}}},
    "position": [0, 0.5, 0]}}]{})",
                     duration, kFloor, more);
}

TEST(Evaluations, OfABodyAtRestAreThoseOfItsFirstInstant) {
  const long atOnce = evaluationsOf(lyingBox(0.02)), later = evaluationsOf(lyingBox(20));
  EXPECT_EQ(later, atOnce);
  EXPECT_LT(later, 20);
}

// Pushed for 0.05 s from 10 s on; it slides at most a few steps beyond. Nothing is computed before or after.
TEST(Evaluations, OfABodyAtRestGoOnOnlyWhileItIsPushed) {
  const auto pushed = [](double start) {
    return fmt::format(
        R"(, "pushes": [{{"body": "box", "point": [0, 0, 0], "force": [7000, 0, 0], "start": {}, "duration": 0.05}}])",
        start);
  };
  const long soon = evaluationsOf(lyingBox(2, pushed(0.5))), late = evaluationsOf(lyingBox(20, pushed(10)));
  EXPECT_GT(late, evaluationsOf(lyingBox(20)) + 20);
  EXPECT_NEAR(static_cast<double>(late), static_cast<double>(soon), 0.05 * static_cast<double>(soon));
}

// The same pendulum, alone and beside ninety-nine others: no island costs another one more.
TEST(Evaluations, OfAHundredIslandsAreAHundredTimesThoseOfOne) {
  const auto pendulums = [](int count) {
    std::string bodies, rods;
    for (int i = 0; i < count; ++i) {
      bodies += (i ? ", " : "") + ball(fmt::format("b{}", i), Vec3(1, 0, 3 * i));
      rods +=
          fmt::format(R"({}{{"bodyA": "b{}", "anchorA": [0, 0, 0], "anchorB": [0, 0, {}]}})", i ? ", " : "", i, 3 * i);
    }
    return fmt::format(R"("duration": 1, "bodies": [{}], "rods": [{}])", bodies, rods);
  };
  const double one = static_cast<double>(evaluationsOf(pendulums(1)));
  // Errors are scaled 1 + |x|: far from the origin along z nothing of it changes, for what moves is x and y.
  EXPECT_NEAR(static_cast<double>(evaluationsOf(pendulums(100))), 100 * one, 0.01 * 100 * one);
}

}  // namespace
}  // namespace cradle
