#include "simulate/plan/plan_text.h"

#include <gmock/gmock.h>

#include "experiments/ridged_ground.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

ChosenMethod methodOfKind(MotionKind kind, std::string_view name, double timeStep, double tolerance) {
  ChosenMethod method;
  method.kind = kind, method.name = name, method.timeStep = timeStep, method.tolerance = tolerance;
  return method;
}

IslandPlan islandOf(const std::vector<int>& bodies, const ChosenMethod& method, const Promise& promise = {}) {
  IslandPlan island;
  island.bodies = bodies, island.method = method, island.reason = "so it is", island.promise = promise;
  return island;
}

Plan planOfKinds(const std::vector<Promise::Kind>& kinds) {
  Plan plan;
  plan.accuracy = 1e-6;
  for (const Promise::Kind kind : kinds) plan.islands.push_back(islandOf({0}, {}, {kind, {}, "it is coarse"}));
  return plan;
}

const ChosenMethod kFlight = methodOfKind(MotionKind::freeFlight, "closed form", 0, 0),
                   kTenths = methodOfKind(MotionKind::fixedSteps, "RK4", 0.1, 1e-5),
                   kAdaptive = methodOfKind(MotionKind::errorSteps, "DOP853", 0, 2.5e-8);

/// Four moving bodies and a fixed one.
Scene fourAndAFloor() {
  std::string bodies = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static"})";
  for (const char* name : {"a", "b", "c", "d"})
    bodies += fmt::format(R"(, {{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}}})", name);
  return sceneWith("\"duration\": 1, \"bodies\": [" + bodies + "]");
}

TEST(PlanText, NamesAMethodWithItsStepOrItsError) {
  EXPECT_EQ(describe(kFlight), "closed form");
  EXPECT_EQ(describe(methodOfKind(MotionKind::elasticFlight, "closed form", 0, 0)), "closed form");
  EXPECT_EQ(describe(kTenths), "RK4, step 0.1 s");
  EXPECT_EQ(describe(methodOfKind(MotionKind::pile, "fast", 0.0625, 0)), "fast, step 0.0625 s");
  EXPECT_EQ(describe(kAdaptive), "DOP853, local error below 2.5e-08 (1 + |x|)");
}

TEST(PlanText, NamesEachMethodOnceInTheOrderOfTheIslands) {
  Plan plan;
  for (const ChosenMethod& method : {kTenths, kFlight, kTenths, kAdaptive})
    plan.islands.push_back(islandOf({1}, method));
  EXPECT_EQ(methodNames(plan), "RK4, step 0.1 s; closed form; DOP853, local error below 2.5e-08 (1 + |x|)");
}

// One island without a promise makes that of all: none of the accuracy, and of some bodies only.
TEST(PlanText, PromisesOfAllWhatTheWeakestIslandDoes) {
  using enum Promise::Kind;
  const auto promiseOf = [](const std::vector<Promise::Kind>& kinds) { return promiseOfAll(planOfKinds(kinds)); };
  EXPECT_EQ(promiseOf({kept, kept}), "promised");
  EXPECT_EQ(promiseOf({kept, conditional, kept}), "promised while conditions hold");
  EXPECT_EQ(promiseOf({none, none}), "not promised");
  EXPECT_EQ(promiseOf({kept, none}), "promised of some bodies only");
  EXPECT_EQ(promiseOf({none, conditional}), "promised of some bodies only");
  EXPECT_EQ(accuracyPromised(planOfKinds({kept, conditional})), "1e-06");
  EXPECT_EQ(accuracyPromised(planOfKinds({kept, none})), "not promised, because it is coarse");
}

TEST(PlanText, TellsIslandsAlikeTogether) {
  const Scene scene = fourAndAFloor();
  Plan plan;
  plan.islands = {islandOf({1}, kFlight), islandOf({2}, kTenths), islandOf({3}, kFlight), islandOf({4}, kFlight)};
  plan.islands[1].notNeeded = {"no one thing", "no other"};
  EXPECT_EQ(describe(plan, scene), R"(5 bodies in 4 islands, 1 fixed
a; 2 more islands alike
  method    closed form
  why       so it is
  accuracy  promised
b
  method    RK4, step 0.1 s
  why       so it is
  accuracy  promised
  left out  no one thing
  left out  no other)");
}

// An island whose promise ended, and one that kept the same one, are not alike.
TEST(PlanText, TellsTheOutcomeOfEachKindOfIsland) {
  using enum Promise::Kind;
  const Scene scene = fourAndAFloor();
  const Promise conditional_{conditional, {{"nothing jams", {1}}}, {}}, none_{none, {}, "it is coarse"};
  Plan plan;
  plan.islands = {islandOf({1}, kAdaptive, conditional_), islandOf({2}, kAdaptive, conditional_),
                  islandOf({3}, kTenths, none_), islandOf({4}, kAdaptive, conditional_)};
  const std::vector<std::optional<PromiseEnd>> ends = {{}, PromiseEnd{0.25, "it jams", {2}, {}}, {}, {}};
  EXPECT_EQ(describeOutcome(plan, ends, scene),
            "a; 1 more islands alike: promised while nothing jams; kept\n"
            "b: promised while nothing jams; given up at 0.25 s, because it jams (b)\n"
            "c: not promised, because it is coarse");
}

TEST(PlanText, CountsOneBodyInOneIsland) {
  const Scene scene = sceneWith(R"("duration": 1, "bodies": [{"name": "a", "shape": {"sphere": {"radius": 0.1}}}])");
  EXPECT_THAT(describe(planOf(scene), scene), testing::StartsWith("1 body in 1 island\na\n"));
}

TEST(PlanText, CountsWhatIsDriven) {
  const Scene scene = sceneWith(R"("duration": 1, "bodies": [{"name": "a", "shape": {"sphere": {"radius": 0.1}}},
      {"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven", "linearVelocity": [1, 0, 0],
       "collision": "none"},
      {"name": "floor", "shape": {"plane": {}}, "motion": "static", "position": [0, -9, 0]}])");
  EXPECT_THAT(describe(planOf(scene), scene), testing::StartsWith("3 bodies in 1 island, 1 fixed, 1 driven\na\n"));
}

// A ball that a driven one may strike has no closed form; a wheel with a motor has steps that end at the motor's
// changes, one with limits meets them as events.
TEST(PlanText, TellsWhatDrivesLeave) {
  const auto textOf = [](const std::string& members) {
    const Scene scene = sceneWith(R"("duration": 1, "gravity": [0, 0, 0], "materials": {"m": {"staticFriction": 0,
        "dynamicFriction": 0, "restitution": 1}}, )" +
                                  members);
    return describe(planOf(scene), scene);
  };
  const std::string ball = R"({"name": "a", "shape": {"sphere": {"radius": 0.1}}, "material": "m"})";
  const std::string drivenText =
      textOf(R"("bodies": [)" + ball + R"(, {"name": "bat", "shape": {"sphere": {"radius": 0.1}},
      "motion": "driven", "position": [1, 0, 0], "linearVelocity": [-1, 0, 0], "material": "m"}])");
  EXPECT_THAT(drivenText, testing::HasSubstr("exactly, and leave no closed form to what they move"));
  for (const std::string part : {"", R"(, "motor": {"torque": 1})", R"(, "limits": {"upper": 1})"}) {
    const std::string text =
        textOf(R"("bodies": [)" + ball + R"(], "hinges": [{"bodyA": "a", "anchorB": [0, 0, 0])" + part + "}]");
    EXPECT_EQ(text.find("motor comes to its velocity") != std::string::npos, part.find("motor") != std::string::npos);
    EXPECT_EQ(text.find("comes to a limit") != std::string::npos, part.find("limits") != std::string::npos);
  }
}

// A ground with a valley is a mesh; flat, it is a box. What touches nothing has no collision.
TEST(PlanText, TellsOnceAsWhatModelsTouch) {
  const auto modelsText = [](bool isFlat, const std::vector<std::string>& collisions) {
    const LoadedModel ground =
        isFlat ? ridgedGround({{-3, 0}, {3, 0}}, false) : ridgedGround({{-3, 0.1}, {0, 0}, {3, 0.1}}, false);
    std::string bodies;
    for (const std::string& collision : collisions)
      bodies += fmt::format(R"({}{{"name": "g{}", "shape": {{"mesh": "ground.obj"}}, "collision": "{}",
          "motion": "static"}})",
                            bodies.empty() ? "" : ", ", bodies.size(), collision);
    return collisionOfModels(
        parseScene(R"({"schema": "cradle-scene/1", "name": "models", "duration": 1, "bodies": [)" + bodies + "]}",
                   "models.json", [&](const MeshReference&) { return ground; })
            .scene);
  };
  EXPECT_THAT(modelsText(false, {"auto", "auto", "none"}), ElementsAre(EndsWith(" as mesh")));
  EXPECT_THAT(modelsText(false, {"auto", "hull"}), ElementsAre(EndsWith(" as mesh"), EndsWith(" as its hull")));
  EXPECT_THAT(modelsText(true, {"auto"}), ElementsAre(EndsWith(" as box")));
  EXPECT_THAT(modelsText(true, {"mesh", "none"}), ElementsAre(EndsWith(" as convex")));
  EXPECT_THAT(modelsText(true, {"none"}), testing::IsEmpty());
}

}  // namespace
}  // namespace cradle
