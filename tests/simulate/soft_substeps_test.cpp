#include "simulate/soft_substeps.h"

#include <gmock/gmock.h>

#include "experiments/experiment.h"
#include "simulate/plan/plan.h"
#include "simulate/plan/plan_text.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

std::string heap(int layers, const std::string& accuracy, const std::string& more = "") {
  return fmt::format(R"("duration": 2.5, "accuracy": {}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{"normal": [0, 1, 0]}}}}, "motion": "static"}},
    {{"name": "wall", "shape": {{"box": {{"size": [0.1, 2, 2]}}}}, "motion": "static", "position": [-0.4, 1, 0]}},
    {{"name": "box", "shape": {{"box": {{"size": [0.2, 0.1, 0.2]}}}}, "position": [-0.22, 0.1, -0.3],
      "copies": {{"count": [2, {}, 2], "spacing": [0.23, 0.14, 0.23]}}}}]{})",
                     accuracy, layers, more);
}

std::string methodOf(const std::string& members) {
  return std::string(planOf(sceneWith(members)).islands.at(0).method.name);
}

TEST(PlanOfPiles, TakesTheFastStepForManyBodiesAndCoarseAccuracyOnly) {
  EXPECT_EQ(methodOf(heap(13, "\"visual\"")), "fast contact step");
  EXPECT_NE(methodOf(heap(12, "\"visual\"")), "fast contact step");
  EXPECT_NE(methodOf(heap(13, "1e-4")), "fast contact step");
  EXPECT_NE(methodOf(heap(13, "\"visual\"", R"(, "springs": [{"bodyA": "box_0", "anchorA": [0, 0, 0],
      "anchorB": [0, 1, 0], "stiffness": 10}])")),
            "fast contact step");
  EXPECT_THAT(describe(planOf(sceneWith(heap(13, "\"visual\""))), sceneWith(heap(13, "\"visual\""))),
              testing::HasSubstr("not promised"));
}

// Steel among wood of the same size is more than the fast step's sweeps carry: it made energy from nowhere.
TEST(PlanOfPiles, LeavesDenseBodiesAmongLightOnesToOtherSteps) {
  const auto with = [](double size, double mass) {
    std::string members = heap(13, "\"visual\"");
    members.insert(members.rfind(']'), fmt::format(R"(, {{"name": "other", "mass": {}, "position": [0, 9, 0],
      "shape": {{"box": {{"size": [{}, {}, {}]}}}}}})",
                                                   mass, size, size / 2, size));
    return methodOf(members);
  };
  const double boxMass = 1000 * 0.2 * 0.1 * 0.2;  // kg, at the density of no material
  EXPECT_EQ(with(0.2, 9 * boxMass), "fast contact step");
  EXPECT_NE(with(0.2, 11 * boxMass), "fast contact step");
  EXPECT_EQ(with(0.6, 27 * boxMass), "fast contact step");        // as dense, but larger
  EXPECT_EQ(with(0.05, 20 * boxMass / 64), "fast contact step");  // denser, but not as heavy
}

// Contacts take what the heap loses; overlaps and their removal change the energy by far less, one way or the other: by
// 5e-3 of all that there was, measured.
TEST(SoftSubsteps, DissipatesAndComesToRestWithEvents) {
  const Trajectory trajectory = simulate(sceneWith(heap(13, "\"visual\"")));
  const double start = energyConstantOf(trajectory.frames[0]);
  for (const Frame& frame : trajectory.frames) {
    EXPECT_NEAR(energyConstantOf(frame) + frame.energy.numerical, start, 1e-12 * start);
    EXPECT_NEAR(energyConstantOf(frame), start, 1e-2 * start);
    EXPECT_GE(frame.energy.impact, 0);
    EXPECT_GE(frame.energy.friction, 0);
  }
  int impacts = 0;
  for (const Event& event : trajectory.events) {
    if (event.kind != EventKind::impact) continue;
    ++impacts;
    EXPECT_NEAR(event.normal.norm(), 1, 1e-12);
    EXPECT_GT(event.impulse, 0);
  }
  EXPECT_GT(impacts, 40);  // nearly each of 52 boxes: a landing that is over within a look has none
  EXPECT_GT(trajectory.frames.back().energy.dissipated, 0.1 * start);
}

TEST(SoftSubsteps, HasTheSameStateHashForOneAndTwoThreads) {
  const Scene scene = sceneWith(heap(13, "\"visual\""));
  std::vector<std::string> hashes;
  for (const int threads : {1, 2}) {
    SoftSubsteps pile(assemble(scene, planOf(scene).islands.at(0)), 1.0 / 60, threads);
    Hash hash;
    for (long number = 0; number <= 30; ++number) {
      const double time = frameTime(scene, number);
      const VectorX& state = pile.stateAt(time);
      Frame frame{number, time, {}, {}};
      for (Eigen::Index body = 0; body < bodyCount(state); ++body)
        frame.states.push_back({centerOfMass(state, body), orientation(state, body), linearVelocity(state, body),
                                angularVelocity(state, body)});
      addFrame(frame, hash);
    }
    hashes.push_back(hash.hex());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_NE(hashes[0], Hash().hex());
}

// Steps end at frames: a frame rate of 30 asks for two steps between frames.
TEST(SoftSubsteps, GivesTheSameStatesAtHalfTheFrameRate) {
  const Trajectory often = simulate(sceneWith(heap(13, "\"visual\""))),
                   seldom = simulate(sceneWith(heap(13, "\"visual\"", R"(, "output": {"framesPerSecond": 30})")));
  ASSERT_EQ(often.frames.size(), 2 * seldom.frames.size() - 1);
  const auto& a = often.frames.back().states;
  const auto& b = seldom.frames.back().states;
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i].position - b[i].position).norm(), 0.05) << i;
}

}  // namespace
}  // namespace cradle
