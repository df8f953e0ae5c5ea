// What a plan promises of its groups of bodies, and what the run makes of it.

#include "simulate/plan/promise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/experiment.h"
#include "simulate/world.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::string kLevelGround = R"({"name": "ground", "shape": {"plane": {}}, "motion": "static"})";

std::string bodyOf(const std::string& name, const std::string& shape, const Vec3& position,
                   const std::string& more = "") {
  return fmt::format(R"(, {{"name": "{}", "shape": {{{}}}, "position": {}{}}})", name, shape, vectorText(position),
                     more.empty() ? "" : ", " + more);
}
const std::string kSphere = R"("sphere": {"radius": 0.1})", kCube = R"("box": {"size": [0.2, 0.2, 0.2]})",
                  kStatic = R"("motion": "static")";

std::string spheres(int count, const std::string& more = "") {
  std::string text;
  for (int i = 0; i < count; ++i) text += bodyOf(fmt::format("s{}", i), kSphere, Vec3(0.3 * i, 1, 0), more);
  return text;
}

Scene sceneOfBodies(const std::string& bodies, const std::string& more = "") {
  return sceneWith(R"("duration": 1, "bodies": [)" + kLevelGround + bodies + "]" + more);
}

/// Of the only group.
Promise promiseOfOnly(const std::string& bodies, const std::string& more = "") {
  const Scene scene = sceneOfBodies(bodies, more);
  const cradle::World run(scene);
  EXPECT_EQ(run.plan().islands.size(), 1u);
  return run.plan().islands.at(0).promise;
}

std::vector<std::string> conditionsOf(const std::string& bodies, const std::string& more = "") {
  const Promise promise = promiseOfOnly(bodies, more);
  EXPECT_EQ(promise.kind, Promise::Kind::conditional);
  std::vector<std::string> conditions;
  for (const PromiseCondition& condition : promise.conditions) conditions.push_back(condition.what);
  return conditions;
}

const std::string kSmooth = R"(, "materials": {"smooth": {"staticFriction": 0, "dynamicFriction": 0}})";

const auto kRate = StartsWith("contacts change at most 500 times in 1/60 s");
const auto kSlow = HasSubstr("slides so slowly");

TEST(Promise, OfBodiesThatNothingCanTouchHasNoConditions) {
  const std::string free = R"("collision": "none")";
  EXPECT_EQ(describe(promiseOfOnly(bodyOf("a", kCube, Vec3(0, 1, 0), free))), "promised");
  EXPECT_EQ(describe(promiseOfOnly(bodyOf("a", kCube, Vec3(0, 1, 0), free),
                                   R"(, "springs": [{"bodyA": "a", "anchorA": [0, 0.1, 0], "anchorB": [0, 2, 0],
                                    "stiffness": 50}])")),
            "promised");
  EXPECT_EQ(describe(promiseOfOnly(bodyOf("a", kCube, Vec3(0, 1, 0), free),
                                   R"(, "ropes": [{"bodyA": "a", "anchorA": [0, 0.1, 0], "anchorB": [0, 2, 0]}])")),
            "promised");
}

TEST(Promise, OfFewSpheresOnPlanesHasNoConditions) {
  EXPECT_EQ(describe(promiseOfOnly(spheres(1))), "promised");
  EXPECT_EQ(describe(promiseOfOnly(spheres(6, R"("material": "smooth")"), kSmooth)), "promised");
  EXPECT_THAT(conditionsOf(spheres(12)), ElementsAre(HasSubstr("redundant"), kRate));
}

// A ball that slides between others, or under one on the ground, may be wedged in.
TEST(Promise, OfFewSpheresWithFrictionBetweenThemIsWhileNoneJams) {
  EXPECT_EQ(describe(promiseOfOnly(spheres(2))),
            "promised while no contact of s0, s1 jams, or slides so slowly that its friction has no sure direction");
}

// Forces of the heavier one, rounded, move the lighter one.
TEST(Promise, OfFarHeavierBodiesIsWhileTheySqueezeNone) {
  const auto pairOf = [](double mass) {
    return bodyOf("a", kSphere, Vec3(0, 1, 0), R"("mass": 1, "material": "smooth")") +
           bodyOf("b", kSphere, Vec3(0, 2, 0), fmt::format(R"("mass": {}, "material": "smooth")", mass));
  };
  EXPECT_EQ(describe(promiseOfOnly(pairOf(9e5), kSmooth)), "promised");
  EXPECT_EQ(describe(promiseOfOnly(pairOf(1.1e6), kSmooth)),
            "promised while none of a, b squeezes another of less than a millionth of its mass");
}

// On level ground a ball soon rolls; on a slope it may slide slowly for long.
TEST(Promise, OfASphereOnARoughSlopeIsWhileItDoesNotSlideSlowly) {
  const std::string slope = bodyOf("slope", R"("plane": {"normal": [0.1, 1, 0]})", Vec3::Zero(), kStatic);
  EXPECT_THAT(conditionsOf(slope + spheres(1)), ElementsAre(kSlow, kRate));
}

TEST(Promise, OfBodiesOnJointsIsWhileTheyTouchNothingBesideThem) {
  EXPECT_THAT(conditionsOf(spheres(1), R"(, "ballJoints": [{"bodyA": "s0", "anchorA": [0, -0.9, 0],
                                           "anchorB": [0, 0.1, 0]}])"),
              ElementsAre(StartsWith("nothing touches s0 within a thousandth of its size of a joint"), kRate));
}

/// A sphere on the ground that leaves it with `speed` (m/s).
Scene bouncingSphere(double restitution, double speed) {
  return sceneWith(fmt::format(R"("duration": 1, "materials": {{"hard": {{"restitution": {}}}}}, "bodies": [
    {{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static", "material": "hard"}},
    {{"name": "s", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "hard", "position": [0, 0.1, 0],
      "linearVelocity": [0, {}, 0]}}])",
                               restitution, speed));
}

// A sphere of restitution e bounces about 16 / (1 - e) times before it rests.
TEST(Promise, OfASphereThatBouncesTooOftenIsForAtMostFiveHundredChanges) {
  const auto promise = [](double restitution) {
    return describe(planOf(bouncingSphere(restitution, 1)).islands.at(0).promise);
  };
  EXPECT_EQ(promise(0.99), "promised");
  EXPECT_THAT(promise(0.9999), StartsWith("promised while contacts change at most 500 times"));
}

// Spheres and capsules have rows on edges and corners; cylinders have none for their rims.
TEST(Promise, OfRoundBodiesOnABoxIsOfRimsAlone) {
  const std::string table = bodyOf("table", R"("box": {"size": [1, 0.1, 1]})", Vec3(0, 0.5, 0), kStatic);
  EXPECT_THAT(conditionsOf(table + spheres(1)), ElementsAre(kSlow, kRate));
  EXPECT_THAT(conditionsOf(table + bodyOf("c", R"("capsule": {"radius": 0.1, "length": 0.3})", Vec3(0, 1, 0))),
              ElementsAre(kSlow, kRate));
  EXPECT_THAT(conditionsOf(table + bodyOf("c", R"("cylinder": {"radius": 0.1, "length": 0.3})", Vec3(0, 1, 0))),
              testing::Contains("no rim of c presses on an edge or a round side"));
}

// A cube has four corners on a plane: twelve rows, of which any three are independent.
TEST(Promise, OfACubeOnAPlaneIsOfItsSlidingAndOfTheRateOfChanges) {
  EXPECT_THAT(conditionsOf(bodyOf("a", kCube, Vec3(0, 1, 0))), ElementsAre(kSlow, kRate));
}

TEST(Promise, OfCubesNamesThoseWhoseEdgesMayPress) {
  const Promise promise = promiseOfOnly(bodyOf("a", kCube, Vec3(0, 1, 0)) + bodyOf("b", kCube, Vec3(0, 2, 0)) +
                                        bodyOf("s", kSphere, Vec3(0, 3, 0)));
  ASSERT_EQ(promise.conditions.size(), 4u);
  EXPECT_THAT(promise.conditions[0].what, StartsWith("no edges of a, b press along each other"));
  EXPECT_THAT(promise.conditions[0].bodies, ElementsAre(1, 2));
  EXPECT_THAT(promise.conditions[1].what, HasSubstr("redundant"));
  EXPECT_THAT(promise.conditions[1].bodies, ElementsAre(1, 2, 3));
}

TEST(Promise, OfACylinderIsWhileItDoesNotTip) {
  EXPECT_THAT(conditionsOf(bodyOf("can", R"("cylinder": {"radius": 0.1, "length": 0.3})", Vec3(0, 1, 0))),
              testing::Contains("no cylinder of can tips over its rim"));
}

TEST(Promise, IsNotMadeWhereTimeStepsDecide) {
  EXPECT_THAT(describe(promiseOfOnly(spheres(1), R"(, "method": {"name": "rk4", "timeStep": 0.001})")),
              "not promised, because the scene names the method: its time step of 0.001 s decides");
  EXPECT_THAT(describe(promiseOfOnly(spheres(60), R"(, "accuracy": "visual")")),
              StartsWith("not promised, because many bodies may touch"));
}

/// Cubes on each other, sliding on the ground together: four corners slide, four of each other cube stick.
std::string slidingStack(int count, double height = 0.1) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += bodyOf(fmt::format("cube{}", i), kCube, Vec3(0, height + 0.2 * i, 0), R"("linearVelocity": [1, 0, 0])");
  return text;
}

// Six cubes: 4 + 60 rows, of which at most 36 are independent. Two: 4 + 12 rows and 12.
TEST(Promise, IsDecidedAtTheFirstInstantWhereMoreTouchThanEventsServe) {
  EXPECT_THAT(describe(promiseOfOnly(slidingStack(6))),
              "not promised, because too many contacts press at once (ground, cube0, cube1, cube2 and 3 more) at the "
              "start");
  EXPECT_EQ(promiseOfOnly(slidingStack(2)).kind, Promise::Kind::conditional);
}

// The stack falls by 5 mm before it slides; only the run can tell.
TEST(Promise, IsGivenUpInTheRunWithTimeReasonAndBodies) {
  const Scene scene = sceneOfBodies(slidingStack(6, 0.105));
  cradle::World run(scene);
  ASSERT_EQ(run.plan().islands.at(0).promise.kind, Promise::Kind::conditional);
  run.frameAt(0, 0);
  EXPECT_THAT(run.takePromiseEnds(), IsEmpty());
  run.frameAt(1, 0.1);
  const std::vector<PromiseEnd> ends = run.takePromiseEnds();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_NEAR(ends[0].time, std::sqrt(2 * 0.005 / kGravity), 1e-6);
  EXPECT_EQ(ends[0].reason, "too many contacts press at once");
  EXPECT_THAT(ends[0].bodies, ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_THAT(run.takeWarnings(), ElementsAre(HasSubstr("not promised from 0.0319275 s on: too many contacts press")));
  EXPECT_THAT(outcomeOf(run.plan().islands[0].promise, run.promiseEnds()[0], scene),
              "given up at 0.0319275 s, because too many contacts press at once (ground, cube0, cube1, cube2 and 3 "
              "more)");
  EXPECT_THAT(run.takePromiseEnds(), IsEmpty());
}

// A loop of two moving bodies or more is a linkage, whatever closes it; two rods of one body, and trees, are none.
TEST(Promise, ExceptsDeadPointsOfLinkages) {
  const auto promiseOfRods = [](const std::string& rods) {
    return describe(promiseOfOnly(bodyOf("a", kSphere, Vec3(0, 1, 0), R"("collision": "none")") +
                                      bodyOf("b", kSphere, Vec3(1, 1, 0), R"("collision": "none")"),
                                  R"(, "rods": [{"bodyA": "a", "anchorA": [0, 0, 0], "bodyB": "b",
                                  "anchorB": [0, 0, 0]}, )" +
                                      rods + "]"));
  };
  const auto rodTo = [](const char* body, double x) {
    return fmt::format(R"({{"bodyA": "{}", "anchorA": [0, 0, 0], "anchorB": [{}, 2, 0]}})", body, x);
  };
  EXPECT_EQ(promiseOfRods(rodTo("a", 0) + ", " + rodTo("b", 1)), "promised while a, b come slowly to no dead point");
  EXPECT_EQ(promiseOfRods(rodTo("a", 0)), "promised");
  EXPECT_EQ(promiseOfRods(rodTo("a", 0) + ", " + rodTo("a", 1)), "promised");
}

TEST(Promise, ThatIsKeptSaysSoInTheTrajectory) {
  EXPECT_EQ(simulate(sceneOfBodies(spheres(2))).cost.promise,
            "s0, s1: promised while no contact of s0, s1 jams, or slides so slowly that its friction has no sure "
            "direction; kept");
}

// A sphere of restitution 1 that leaves the ground with v = 3e-6 m/s hops g / 2v = 1.6e6 times in a second: its promise
// cannot be given up.
TEST(Promise, WithoutConditionsIsKeptOrTheRunEnds) {
  const Scene scene = bouncingSphere(1, 3e-6);
  ASSERT_EQ(describe(planOf(scene).islands.at(0).promise), "promised");
  try {
    simulate(scene);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::limit);
    EXPECT_THAT(error.what(), HasSubstr("more than 20000 impacts"));
  }
}

}  // namespace
}  // namespace cradle
