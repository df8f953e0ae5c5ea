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

/// 64 boxes of 1 kg and 0.14 m, apart, on a driven board whose upper side is at 0.05 m at the start.
Trajectory boxesOn(const std::string& motion, double duration, const std::string& more = "") {
  const std::string members = fmt::format(
      R"("duration": {}, "accuracy": 1e-2, "materials": {{"m": {{"restitution": 0, "staticFriction": 0.5,
      "dynamicFriction": 0.5}}}}, "bodies": [
      {{"name": "board", "shape": {{"box": {{"size": [20, 0.1, 2]}}}}, "motion": "driven", {}, "material": "m"}}{},
      {{"name": "box", "shape": {{"box": {{"size": [0.14, 0.14, 0.14]}}}}, "mass": 1, "material": "m",
        "position": [-0.7, 0.12, -0.7], "copies": {{"count": [8, 1, 8], "spacing": [0.2, 1, 0.2]}}}}])",
      duration, motion, more);
  EXPECT_EQ(methodOf(members), "fast contact step");
  return simulate(sceneWith(members));
}

/// A belt of v gives each box its velocity by friction mu g, in v / (mu g) on the way v^2 / (2 mu g); its work is twice
/// the kinetic energy that they get, and the rest is friction's. Soft contacts are off by some parts in a hundred.
TEST(SoftSubsteps, BeltCarriesBoxes) {
  const double speed = 1.5, mass = 64;
  const Trajectory carried = boxesOn(R"("linearVelocity": [1.5, 0, 0])", 1);
  const Frame& end = carried.frames.back();
  const double slid = speed * speed / (2 * 0.5 * kGravity);
  for (std::size_t i = 1; i < end.states.size(); ++i) {
    EXPECT_NEAR(end.states[i].linearVelocity.x(), speed, 0.01 * speed);
    EXPECT_NEAR(end.states[i].position.x() - carried.frames[0].states[i].position.x(), speed - slid, 0.03 * slid);
  }
  EXPECT_EQ(end.states[0].position.x(), speed);
  EXPECT_NEAR(end.energy.work, mass * speed * speed, 0.03 * mass * speed * speed);
  EXPECT_NEAR(end.energy.friction, mass * speed * speed / 2, 0.05 * mass * speed * speed / 2);
}

/// A lift's work is the potential energy of what it lifts, from rest to rest.
TEST(SoftSubsteps, LiftLiftsBoxes) {
  const Trajectory lifted = boxesOn(R"("keyFrames": [{"time": 0.2, "position": [0, 0, 0]}, {"time": 1.2,
      "position": [0, 0.5, 0]}])",
                                    2);
  const double work = 64 * kGravity * 0.5;
  EXPECT_NEAR(lifted.frames.back().energy.work, work, 0.01 * work);
  for (std::size_t i = 1; i < lifted.frames.back().states.size(); ++i)
    EXPECT_NEAR(lifted.frames.back().states[i].position.y(), 0.62, 1e-3);
}

/// Friction holds boxes on a turntable that turns slowly enough, w^2 r < mu g: they go round with it, each of them, and
/// the work is their kinetic energy and as much again, which the slip at the start takes.
TEST(SoftSubsteps, TurntableTakesBoxesAlong) {
  const double rate = 1;
  const Trajectory turned = boxesOn(R"("angularVelocity": [0, 1, 0])", 1.5);
  double kinetic = 0;
  for (std::size_t i = 1; i < turned.frames.back().states.size(); ++i) {
    const BodyState& state = turned.frames.back().states[i];
    const Vec3 along = rate * Vec3::UnitY().cross(Vec3(state.position.x(), 0, state.position.z()));
    EXPECT_LT((state.linearVelocity - along).norm(), 0.02) << i;
    EXPECT_NEAR(state.angularVelocity.y(), rate, 0.02);
    kinetic += (along.squaredNorm() + rate * rate * 0.14 * 0.14 / 6) / 2;
  }
  EXPECT_NEAR(turned.frames.back().energy.work, 2 * kinetic, 0.05 * 2 * kinetic);
}

/// What rests on a board that stands still wakes when that begins to move, and the board has no rest of its own.
TEST(SoftSubsteps, BoardThatBeginsToMoveWakesItsBoxes) {
  const Trajectory moved =
      boxesOn(R"("keyFrames": [{"time": 1, "position": [0, 0, 0]}, {"time": 2, "position": [0.3, 0, 0]}])", 2.2);
  int rests = 0, wakes = 0;
  for (const Event& event : moved.events) {
    rests += event.kind == EventKind::rest && event.time < 1, wakes += event.kind == EventKind::wake;
    EXPECT_NE(event.bodyA, 0);
  }
  EXPECT_EQ(rests, 64);
  EXPECT_EQ(wakes, 64);
  for (std::size_t i = 1; i < moved.frames.back().states.size(); ++i)
    EXPECT_NEAR(moved.frames.back().states[i].position.x() - moved.frames[0].states[i].position.x(), 0.3, 0.01);
}

/// Boxes between a floor and a board that comes down on them: there is no motion.
TEST(SoftSubsteps, BoardThatLeavesNoRoomEndsTheRun) {
  try {
    boxesOn(
        R"("position": [0, 0.5, 0], "linearVelocity": [0, -0.5, 0])", 2,
        R"(, {"name": "floor", "shape": {"plane": {}}, "motion": "static", "position": [0, 0.05, 0], "material": "m"})");
    FAIL() << "the board went through the boxes";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    EXPECT_THAT(error.what(), testing::HasSubstr("\"board\": what is driven leaves no room"));
  }
}

}  // namespace
}  // namespace cradle
