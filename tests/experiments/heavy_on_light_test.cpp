#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/experiment.h"

// A ball that lies on a light body, which lies on the floor: what closes is slow, and the masses differ by up to a
// million.

namespace cradle {
namespace {

struct Case {
  double ratio, restitution, friction;  // of the densities
};

/// A ball of 50 mm off the middle of a cylinder that lies, turning slowly. Densities from 8000 kg/m^3.
Scene ballOnCylinder(const Case& given) {
  const std::string material = fmt::format(R"("restitution": {}, "staticFriction": {}, "dynamicFriction": {})",
                                           given.restitution, given.friction, given.friction);
  return sceneWith(fmt::format(R"("duration": 0.02, "materials": {{"light": {{"density": 8000, {0}}},
    "heavy": {{"density": {1}, {0}}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "light"}},
    {{"name": "cylinder", "shape": {{"cylinder": {{"radius": 0.0336, "length": 0.0336}}}}, "material": "light",
      "position": [0, 0.033600000004, 0], "orientation": {{"axis": [0, 0, 1], "angleDegrees": 90}}}},
    {{"name": "ball", "shape": {{"sphere": {{"radius": 0.05}}}}, "material": "heavy",
      "position": [-0.0125, 0.117200000006, 0], "angularVelocity": [0.0069, 0.00007, -0.0036]}}])",
                               material, 8000 * given.ratio));
}

TEST(DenseBallOnALyingCylinder, ComesToTheEndOfItsImpactsAndGainsNoEnergy) {
  for (const double ratio : {1.0, 100.0, 1e4, 1e6})
    for (const double restitution : {0.0, 0.3, 1.0})
      for (const double friction : {0.0, 0.5, 1.5}) {
        const std::string what = fmt::format("{} {} {}", ratio, restitution, friction);
        Trajectory run;
        ASSERT_NO_THROW(run = simulate(ballOnCylinder({ratio, restitution, friction}))) << what;
        // What falls by the whole 20 ms has m g (g t^2 / 2): nothing may have more than that beside its start.
        const double fall = 0.5 * kGravity * 0.02 * 0.02, mass = 8000 * ratio * 5.24e-4;
        const double start = mechanicalEnergy(run.frames.front());
        for (const Frame& frame : run.frames)
          EXPECT_LE(mechanicalEnergy(frame), start + 1e-6 * mass * kGravity * fall) << what;
        EXPECT_GT(run.frames.back().states[1].position.y(), 0.1172 - 1.1 * fall) << what;
      }
}

/// The x of a capsule that another one, on top of it, pushes aside after 0.3 s, in parts of the scale; in a scene of
/// lengths times `scale`, and times times its root.
double pushedAside(double scale) {
  const double root = std::sqrt(scale);
  const Trajectory run = simulate(sceneWith(fmt::format(
      R"("duration": {0}, "output": {{"framesPerSecond": {1}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
    {{"name": "lower", "shape": {{"capsule": {{"radius": {2}, "length": {2}}}}}, "material": "m",
      "position": [0, {2}, {3}], "orientation": {{"axis": [1, 0, 0], "angleDegrees": 90}}}},
    {{"name": "upper", "shape": {{"capsule": {{"radius": {4}, "length": {4}}}}}, "material": "m",
      "position": [{5}, {6}, {7}], "orientation": {{"axis": [-0.598708, 0.120354, 0.791816], "angleDegrees": 196.671}}}}],
    "materials": {{"m": {{"staticFriction": 0, "dynamicFriction": 0}}}})",
      0.3 * root, 10 / root, 0.025 * scale, -0.0043 * scale, 0.05 * scale, -0.00215 * scale, 0.12324 * scale,
      -0.013265 * scale)));
  return run.frames.back().states[0].position.x() / scale;
}

// Lengths by a factor, times by its root: gravity is the same, and so is what happens (W. Froude's law), but for the
// instants at which contact steps try whether events serve again: 1e-3 of the way.
TEST(CapsuleOnACapsule, MovesAlikeAtEveryScale) {
  const double aside = pushedAside(1);
  EXPECT_GT(std::abs(aside), 0.1);
  for (const double scale : {0.01, 0.1, 4.0}) EXPECT_NEAR(pushedAside(scale), aside, 1e-3 * std::abs(aside)) << scale;
}

/// A box of 1 kg that a ball `ratio` times as heavy slides over, with a friction that just holds the box, or not.
Scene boxUnderASlidingBall(double ratio, double friction, double accuracy) {
  return sceneWith(fmt::format(R"("duration": 0.05, "accuracy": {0}, "materials": {{"m": {{
    "restitution": 0, "staticFriction": {1}, "dynamicFriction": {1}}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
    {{"name": "box", "shape": {{"box": {{"size": [0.36, 0.19, 0.55]}}}}, "material": "m", "mass": 1,
      "position": [0, 0.095, 0], "linearVelocity": [0, 0, -0.95]}},
    {{"name": "ball", "shape": {{"sphere": {{"radius": 0.12}}}}, "material": "m", "mass": {2},
      "position": [-0.06, 0.31, -0.04], "linearVelocity": [-0.55, 0, 0.7]}}])",
                               accuracy, friction, ratio));
}

// The floor's friction is that of the ball and the box's weight: under a ball of a hundred times its mass the box all
// but slides. Its corners creep, and friction turns their sliding at mu N / (m v), up to 1e7 times in a second. Where
// steps cannot follow that, the promise ends: after ten thousand steps at most, of twelve evaluations and more. No
// contact is named by nobody.
TEST(LightBoxUnderAHeavySlidingBall, EndsThePromiseWhereItsCornersCreep) {
  int crept = 0;
  for (const double ratio : {30.0, 105.0, 300.0})
    for (const double friction : {0.3, 0.616, 0.95})
      for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
        const std::string what = fmt::format("{} {} {}", ratio, friction, accuracy);
        std::vector<std::string> warnings;
        const RunCost cost = simulate(
            boxUnderASlidingBall(ratio, friction, accuracy),
            {[](const Frame&) {}, [](const Event&) {}, [&](const std::string& text) { warnings.push_back(text); }});
        EXPECT_LT(cost.evaluations, 200'000) << what;
        for (const std::string& warning : warnings) {
          EXPECT_EQ(warning.find("()"), std::string::npos) << what << warning;
          crept += warning.find("slide so slowly") != std::string::npos;
        }
      }
  EXPECT_GT(crept, 0);
}

/// A ball on the floor, and one of `ratio` times its mass that bounces on it: bounces of 1e-6 m/s and less are as high
/// as rounding, and gravity brings their gaps together, not their speeds.
TEST(HeavyBall, ThatBouncesOnALightOneComesToRest) {
  for (const double ratio : {10.0, 1e3, 1e5, 1e7})
    for (const double restitution : {0.1, 0.3, 0.5})
      for (const double height : {0.3 + 1e-6, 0.31, 0.5})
        for (const double accuracy : {1e-3, 1e-6, 1e-8}) {
          const std::string what = fmt::format("{} {} {} {}", ratio, restitution, height, accuracy);
          const Trajectory run = simulate(sceneWith(fmt::format(
              R"("duration": 1, "accuracy": {}, "materials": {{"m": {{"restitution": {}}}}}, "bodies": [
      {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
      {{"name": "light", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "m", "mass": 4.2, "position": [0, 0.1, 0]}},
      {{"name": "heavy", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "m", "mass": {}, "position": [0, {}, 0]}}])",
              accuracy, restitution, 4.2 * ratio, height)));
          EXPECT_NEAR(run.frames.back().states[0].position.y(), 0.1, 1e-9) << what;
          EXPECT_NEAR(run.frames.back().states[1].position.y(), 0.3, 1e-9) << what;
          EXPECT_LT(run.frames.back().energy.kinetic, 1e-20 * ratio) << what;  // J: of some 1e-10 m/s
          EXPECT_LT(run.cost.evaluations, 100'000) << what;
        }
}

/// A ball or a box of 0.1 m half size on the floor, on which a ball of `ratio` times its mass falls.
Scene heavyBallOn(const std::string& shape, double ratio, const std::string& method) {
  return sceneWith(fmt::format(R"("duration": 0.5, {}, "materials": {{"m": {{"restitution": 0.3}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
    {{"name": "light", "shape": {{{}}}, "material": "m", "mass": 4.2, "position": [0, 0.1, 0]}},
    {{"name": "heavy", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "m", "mass": {}, "position": [0, 0.35, 0]}}])",
                               method, shape, 4.2 * ratio));
}

// The heavy body's weight, rounded, moves the light one by 1e-16 g times the ratio: 1e-8 g at the limit.
TEST(HeavyBall, IsCarriedByWhatHasAHundredMillionthOfItsMassAndElseEndsTheRun) {
  for (const std::string shape : {R"("sphere": {"radius": 0.1})", R"("box": {"size": [0.2, 0.2, 0.2]})"})
    for (const std::string& method :
         {std::string(R"("accuracy": 1e-3)"), std::string(R"("accuracy": 1e-6)"), methodText("rk4", 1.0 / 960)}) {
      SCOPED_TRACE(shape + " " + method);
      const Trajectory carried = simulate(heavyBallOn(shape, 0.9e8, method));
      EXPECT_NEAR(carried.frames.back().states[1].position.y(), 0.3, 1e-5);
      for (const double ratio : {1.1e8, 1e12, 1e15, 1e20, 1e35}) try {
          simulate(heavyBallOn(shape, ratio, method));
          ADD_FAILURE() << ratio;
        } catch (const Error& error) {
          EXPECT_EQ(error.kind(), ErrorKind::unstable) << ratio;
          EXPECT_THAT(error.what(), testing::HasSubstr("\"heavy\"")) << ratio;
          EXPECT_THAT(error.what(), testing::HasSubstr("squeezes \"light\"")) << ratio;
        }
    }
}

// An impact whose impulses were not found to the tolerance is counted, and its motion is not promised.
TEST(HeavyBall, LeavesNoPromiseWhereAnImpactWasNotSolved) {
  int unsolved = 0;
  for (const double ratio : {1e4, 1e7, 3e7, 0.9e8})
    for (const char* accuracy : {R"("accuracy": 1e-6)", R"("accuracy": 1e-8)"}) {
      const RunCost cost = simulate(heavyBallOn(R"("box": {"size": [0.2, 0.2, 0.2]})", ratio, accuracy)).cost;
      unsolved += !cost.corrections.empty();
      EXPECT_THAT(cost.promise,
                  cost.corrections.empty() ? testing::HasSubstr("; kept") : testing::HasSubstr("given up"))
          << ratio << " " << accuracy;
    }
  EXPECT_GT(unsolved, 0);
}

}  // namespace
}  // namespace cradle
