#include "simulate/world.h"

#include <gmock/gmock.h>

#include <cmath>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kWorldRounding = 1e-12;  // of sums of numbers below 100

/// A body in free flight, a fixed one, one on a spring, and a ball that bounces: three islands, three ways to move.
const std::string kThreeWays = R"("duration": 1, "accuracy": 1e-7, "materials": {"stuff": {"restitution": 0.5,
    "staticFriction": 0, "dynamicFriction": 0}}, "bodies": [
  {"name": "flying", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 3, "position": [100, 50, 0], "collision": "none",
   "linearVelocity": [1, 2, 3], "angularVelocity": [0, 2, 0]},
  {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "stuff"},
  {"name": "swinging", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [-50, 20, 0.5], "collision": "none"},
  {"name": "bouncing", "shape": {"sphere": {"radius": 0.1}}, "mass": 2, "position": [0, 0.6, 0], "material": "stuff",
   "linearVelocity": [0.3, 0, 0]}],
  "springs": [{"bodyA": "swinging", "anchorA": [0, 0, 0], "anchorB": [-50, 20, 0], "stiffness": 100, "restLength": 0}])";

// States are those of the moving bodies in the order of the scene, whatever island they are in. On the spring
// r = r0 cos(10 t) about the place where it carries the weight.
TEST(World, PutsTheStatesOfAllIslandsInTheOrderOfTheScene) {
  const Scene scene = sceneWith(kThreeWays);
  World world(scene);
  ASSERT_THAT(world.plan().islands, SizeIs(3));
  for (const double time : {0.0, 0.1, 0.25}) {
    const Frame frame = world.frameAt(7, time);
    EXPECT_EQ(frame.number, 7);
    EXPECT_EQ(frame.time, time);
    ASSERT_THAT(frame.states, SizeIs(3));
    const double fall = kGravity * time * time / 2, sag = kGravity / 100;
    EXPECT_LT((frame.states[0].position - Vec3(100 + time, 50 + 2 * time - fall, 3 * time)).norm(), kWorldRounding);
    EXPECT_LT(
        (frame.states[1].position - Vec3(-50, 20 - sag * (1 - std::cos(10 * time)), 0.5 * std::cos(10 * time))).norm(),
        51 * 1e-7);
    EXPECT_LT((frame.states[2].position - Vec3(0.3 * time, 0.6 - fall, 0)).norm(), kWorldRounding);
    EXPECT_LT((frame.states[0].angularVelocity - Vec3(0, 2, 0)).norm(), kWorldRounding);
  }
}

// Sums over islands: energies and momenta of all bodies, about the world's origin.
TEST(World, SumsEnergiesAndMomentaOfAllIslands) {
  const Scene scene = sceneWith(kThreeWays);
  World world(scene);
  const EnergyBalance energy = world.frameAt(0, 0).energy;
  const double spinInertia = 3 * (0.4 * 0.4 + 0.6 * 0.6) / 12;
  EXPECT_NEAR(energy.kinetic, 3 * 14 / 2.0 + spinInertia * 4 / 2 + 2 * 0.09 / 2, kWorldRounding);
  EXPECT_NEAR(energy.potential, kGravity * (3 * 50 + 20 + 2 * 0.6) + 100 * 0.25 / 2, 1e-9);
  EXPECT_LT((energy.momentum - Vec3(3.6, 6, 9)).norm(), kWorldRounding);
  const Vec3 angular = 3 * Vec3(100, 50, 0).cross(Vec3(1, 2, 3)) + Vec3(0, 2 * spinInertia, 0) +
                       2 * Vec3(0, 0.6, 0).cross(Vec3(0.3, 0, 0));
  EXPECT_LT((energy.angularMomentum - angular).norm(), 1e-9);
  EXPECT_EQ(energy.dissipated, 0);

  const double fall = std::sqrt(2 * 0.5 / kGravity);
  const EnergyBalance later = world.frameAt(1, 0.4).energy;  // after one impact at sqrt(2 h / g) = 0.32 s
  ASSERT_LT(fall, 0.4);
  EXPECT_NEAR(later.impact, 0.75 * 2 * kGravity * 0.5, 1e-9);
  EXPECT_EQ(later.dissipated, later.impact);
  EXPECT_NEAR(later.kinetic + later.potential + later.dissipated + later.numerical, energy.kinetic + energy.potential,
              1e-9);
}

// Steps go beyond frames, and what happens there is told with the frame after it, in the order of time.
TEST(World, TellsEventsWithTheFrameThatFollowsThem) {
  std::string bodies = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static"})";
  for (const double height : {0.9, 0.3, 0.6})
    bodies +=
        fmt::format(R"(, {{"name": "b{0}", "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [{1}, {0}, 0]}})",
                    height, 10 * height);
  const Scene scene = sceneWith("\"duration\": 1, \"bodies\": [" + bodies + "]");
  World world(scene);
  std::vector<int> struck;
  const double times[] = {0, 0.25, 0.45};
  for (const double time : times) {
    world.frameAt(0, time);
    double last = 0;
    for (const Event& event : world.takeEvents(time)) {
      EXPECT_LE(event.time, time + 1e-12);
      EXPECT_GE(event.time, last);
      last = event.time;
      if (event.kind == EventKind::impact) struck.push_back(std::max(event.bodyA, event.bodyB));
    }
    // From 0.2, 0.5 and 0.8 m: after 0.20, 0.32 and 0.40 s.
    EXPECT_THAT(struck, SizeIs(time == 0 ? 0 : time == 0.25 ? 1 : 3));
  }
  EXPECT_THAT(struck, ElementsAre(2, 3, 1));
  EXPECT_THAT(world.takeEvents(1), IsEmpty());
}

// In closed form each body costs one evaluation a frame.
TEST(World, CountsAnEvaluationABodyAndFrameOfFreeFlight) {
  const Scene scene = sceneWith("\"duration\": 1, \"bodies\": [" + cradle::ball("a", Vec3::Zero()) + ", " +
                                cradle::ball("b", Vec3(5, 0, 0)) + "]");
  World world(scene);
  for (int i = 0; i < 5; ++i) world.frameAt(i, 0.1 * i);
  EXPECT_EQ(world.evaluations(), 10);
}

// The balls of one island bounce 1e5 times a second, those of the other never: one promise ends, once. The ball's
// contacts have friction, so that it is none of the elastic ones.
TEST(World, TellsOnceWhosePromiseHasEnded) {
  const Scene scene = sceneWith(fmt::format(R"("duration": 1, "accuracy": 1e-6, "gravity": [0, 0, 0], "materials": {{
    "stuff": {{"restitution": 1, "staticFriction": 0.1, "dynamicFriction": 0.1}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "stuff"}},
    {{"name": "ceiling", "shape": {{"plane": {{"normal": [0, -1, 0]}}}}, "motion": "static", "position": [0, {}, 0],
      "material": "stuff"}},
    {{"name": "free", "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none", "position": [50, 9, 0]}},
    {{"name": "box", "shape": {{"box": {{"size": [0.2, 0.2, 0.2]}}}}, "material": "stuff", "position": [0, {}, 0],
      "linearVelocity": [0, 2, 0]}}])",
                                            0.2 + 2e-5, 0.1 + 1e-5));
  World world(scene);
  ASSERT_THAT(world.plan().islands, SizeIs(2));
  EXPECT_THAT(world.takePromiseEnds(), IsEmpty());
  world.frameAt(0, 0.02);
  const std::vector<PromiseEnd> ends = world.takePromiseEnds();
  ASSERT_THAT(ends, SizeIs(1));
  world.frameAt(1, 0.021);
  EXPECT_THAT(world.takePromiseEnds(), IsEmpty());
  EXPECT_GT(ends[0].time, 0);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(world.promiseEnds()[i].has_value(), world.plan().islands[i].bodies[0] == 3) << i;
  EXPECT_THAT(world.takeWarnings(), ElementsAre(HasSubstr("is not promised from")));
  EXPECT_THAT(world.takeWarnings(), IsEmpty());
}

// Steps of 1/60 s give a box that tumbles with much friction energy, which is taken out. The same box far away, out of
// reach on a rope that stays slack, has as many of these corrections: the first of both is told, and all are counted.
TEST(World, TellsOnceOfCorrectionsOfAKind) {
  std::vector<long> counts;
  for (const int boxes : {1, 2}) {
    std::string bodies = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "stuff"})", ropes;
    for (int i = 0; i < boxes; ++i) {
      ropes += fmt::format(R"({}{{"bodyA": "b{}", "anchorA": [0, 0, 0], "anchorB": [{}, 0.6, 0], "maxLength": 20}})",
                           i > 0 ? ", " : "", i, 100 * i);
      bodies += fmt::format(R"(, {{"name": "b{}", "shape": {{"box": {{"size": [0.4, 0.1, 0.7]}}}}, "mass": 1,
        "material": "stuff", "position": [{}, 0.6, 0], "linearVelocity": [1, -3, 0.5], "angularVelocity": [0, 0, 15]}})",
                            i, 100 * i);
    }
    const Scene scene = sceneWith(R"("duration": 1, "method": {"name": "rk4", "timeStep": 0.0166666666666667},
        "materials": {"stuff": {"restitution": 0.5, "staticFriction": 1.5, "dynamicFriction": 1.5}}, "bodies": [)" +
                                  bodies + "], \"ropes\": [" + ropes + "]");
    World world(scene);
    ASSERT_THAT(world.plan().islands, SizeIs(boxes));
    std::vector<Correction> told;
    for (int i = 1; i <= 10; ++i) {
      world.frameAt(i, 0.1 * i);
      for (const Correction& correction : world.takeCorrections()) told.push_back(correction);
    }
    ASSERT_THAT(told, SizeIs(1));
    EXPECT_THAT(told[0].kind, CorrectionKind::clampedEnergy);
    counts.push_back(world.correctionCounts().at(correctionName(CorrectionKind::clampedEnergy)));
  }
  EXPECT_GT(counts[0], 0);
  EXPECT_EQ(counts[1], 2 * counts[0]);
}

// A scene whose velocities stretch a rod is told of at the start; a spring too fast for the method as well.
TEST(World, WarnsOfItsStart) {
  const auto scene = [](const std::string& more) {
    return sceneWith(R"("duration": 1, "gravity": [0, 0, 0], "bodies": [)" +
                     cradle::ball("ball", Vec3(1, 0, 0), Vec3(0.5, 0, 0)) + "], " + more);
  };
  const Scene stretched = scene(R"("rods": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}])");
  const Scene fast = scene(R"("method": {"name": "rk4", "timeStep": 0.1}, "springs": [{"bodyA": "ball",
      "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": 400, "restLength": 1}])");
  World first(stretched), second(fast);
  EXPECT_THAT(first.startWarnings(), ElementsAre(HasSubstr("would stretch")));
  EXPECT_FALSE(first.hasLongSteps());
  EXPECT_THAT(second.startWarnings(), ElementsAre(HasSubstr("spring")));
  EXPECT_TRUE(second.hasLongSteps());
}

}  // namespace
}  // namespace cradle
