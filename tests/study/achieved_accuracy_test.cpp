#include "study/achieved_accuracy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "simulate/simulate.h"
#include "study/sample_scenes.h"

namespace cradle {
namespace {

/// Writes a run into a file, and checks it.
AchievedAccuracy checkRun(const Scene& scene, const Trajectory& run) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = std::filesystem::path(testing::TempDir()) / (std::string(test->name()) + ".sqlite");
  {
    TrajectoryWriter writer(path, headerOf(scene, planOf(scene)));
    for (const Event& event : run.events) writer.append(event);
    for (const Frame& frame : run.frames) writer.append(frame);
    writer.finish(run.cost);
  }
  const TrajectoryReader reader(path);
  const AchievedAccuracy accuracy = achievedAccuracy(scene, reader, [](long) {});
  std::filesystem::remove(path);
  return accuracy;
}

AchievedAccuracy check(const Scene& scene, std::vector<Frame>* frames = nullptr) {
  const Trajectory run = simulate(scene);
  if (frames != nullptr) *frames = run.frames;
  return checkRun(scene, run);
}

/// Two spheres of 0.1 m fall side by side onto the ground, and bounce.
Scene fallingSpheres() {
  return sceneOf(R"({"schema": "cradle-scene/1", "name": "spheres", "duration": 1,
    "materials": {"rubber": {"restitution": 0.5}}, "bodies": [
    {"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "rubber"},
    {"name": "a", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.6, 0], "material": "rubber"},
    {"name": "b", "shape": {"sphere": {"radius": 0.1}}, "position": [1, 0.6, 0], "material": "rubber"}]})");
}

/// A rod pendulum of 1 m, upside down but for a small angle.
Scene invertedPendulum() {
  Scene scene = sceneOf(R"({"schema": "cradle-scene/1", "name": "inverted", "duration": 6,
    "bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.01}}, "mass": 1, "position": [1e-9, 1, 0],
                "collision": "none"}],
    "rods": [{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}]})");
  scene.accuracy = 1e-8;
  return scene;
}

TEST(AchievedAccuracy, ErrorOfAnOscillatorIsThatAgainstTheClosedForm) {
  constexpr double kOmega = 10, kStep = 0.01;
  Scene scene = oscillator(kOmega, 3);
  scene.method = Method{MethodName::rk4, kStep, "test"};
  std::vector<Frame> frames;
  const AchievedAccuracy accuracy = check(scene, &frames);
  double error = 0;
  for (const Frame& frame : frames) {
    const double x = 1 + std::cos(kOmega * frame.time) / 4;
    error = std::max(error, std::abs(frame.states[0].position.x() - x) / (1 + std::abs(x)));
  }
  ASSERT_EQ(accuracy.bodies.size(), 1u);
  EXPECT_EQ(accuracy.bodies[0].body, "ball");
  EXPECT_GT(error, 1e-6);
  // The finer run has 4^-4 of the error.
  EXPECT_NEAR(accuracy.bodies[0].error, error, error / 200);
  EXPECT_EQ(accuracy.finerRun, "time step 0.0025 s");
}

// Explicit Euler falls too little, by g h t / 2 for the step h: a hundredth of the step differs by 0.99 of that, which
// is 1 % of the ball's 0.2 m after 0.4119 s.
TEST(AchievedAccuracy, TheHorizonIsWhereTwoRunsDifferByAHundredthOfTheSize) {
  Scene scene = sceneOf(R"({"schema": "cradle-scene/1", "name": "fall", "duration": 1,
    "output": {"framesPerSecond": 50},
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}]})");
  scene.method = Method{MethodName::explicitEuler, 0.001, "test"};
  const AchievedAccuracy accuracy = check(scene);
  ASSERT_TRUE(accuracy.horizon.has_value());
  EXPECT_EQ(accuracy.horizon->frame, 21);
  EXPECT_DOUBLE_EQ(accuracy.horizon->time, 0.42);
  EXPECT_EQ(accuracy.horizon->body, "ball");
}

TEST(AchievedAccuracy, AMotionThatIsTheScenesHasNoHorizon) {
  EXPECT_FALSE(check(fallingSpheres()).horizon.has_value());
}

TEST(AchievedAccuracy, AnOscillatorIsNotChaotic) {
  const AchievedAccuracy accuracy = check(oscillator(10, 3));
  EXPECT_FALSE(accuracy.divergence);
  EXPECT_EQ(accuracy.finerRun, "accuracy 1e-08");
  // Without gravity, nothing ties the ball across the spring on average: at most it flies off with v, v t in 3 s.
  EXPECT_LE(accuracy.largestDifference, 3 * accuracy.disturbance);
  EXPECT_GT(accuracy.largestDifference, accuracy.disturbance / 100);
}

TEST(AchievedAccuracy, AnInvertedPendulumDivergesAtItsRate) {
  const AchievedAccuracy accuracy = check(invertedPendulum());
  ASSERT_TRUE(accuracy.divergence);
  // theta'' = g / L theta: a difference grows by e in sqrt(L / g); from ten times the disturbance on, the part that
  // decays is below 1 / (omega 10)^2 of it. Frames are 1/60 s apart, and sin(theta) < theta ends the growth at 1e-2.
  const double rate = std::sqrt(9.81);
  EXPECT_NEAR(accuracy.divergence->rate, rate, 0.01 * rate);
  // 1e-8 m/s of 1e-8, of which the part across the rod in each of two directions counts by (1 + |x|), grows to 1e-2
  // / 1.
  ASSERT_TRUE(accuracy.divergence->meaninglessFrom);
  const double across = 1e-8 * 0.64;  // m/s along z, the larger of the two
  EXPECT_NEAR(*accuracy.divergence->meaninglessFrom, std::asinh(1e-2 * rate / across) / rate, 0.03);
}

TEST(AchievedAccuracy, ErrorsAreGivenUpToWhereTheyMeanSomething) {
  const AchievedAccuracy accuracy = check(invertedPendulum());
  ASSERT_TRUE(accuracy.divergence && accuracy.divergence->meaninglessFrom);
  EXPECT_LT(accuracy.bodies[0].time, *accuracy.divergence->meaninglessFrom);
  EXPECT_LT(accuracy.bodies[0].error, 1e-2);
  EXPECT_NE(describe(accuracy).find("Chaotic"), std::string::npos);
}

TEST(AchievedAccuracy, OfBouncingSpheresIsConfirmedByAnotherMethod) {
  const AchievedAccuracy accuracy = check(fallingSpheres());
  EXPECT_EQ(accuracy.fault, "");
  EXPECT_EQ(accuracy.touchDifference, "");
  ASSERT_TRUE(accuracy.other);
  EXPECT_EQ(accuracy.other->failure, "");
  EXPECT_LT(accuracy.other->difference, 1e-9);  // parabolas are exact, and impacts are located
  EXPECT_LT(accuracy.numericalEnergy, 1e-9);
  EXPECT_FALSE(check(oscillator(10, 3)).other);
}

// A ball meets one ball of a row with gaps of 1e-9 m, one a nanosecond after the other: steps make one impact of all,
// by which the first ones have other velocities. Without gaps there is one impact, to which both methods come.
TEST(AchievedAccuracy, OfARowWithGapsIsNotDeniedByStepsThatCannotTellItsImpactsApart) {
  for (const double gap : {1e-9, 0.0}) {
    std::string balls;
    for (int i = 0; i < 4; ++i)
      balls += fmt::format(R"({}{{"name": "b{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "m", "mass": 1,
        "position": [{:.17g}, 0, 0], "linearVelocity": [{}, 0, 0]}})",
                           i > 0 ? ", " : "", i, i == 0 ? -0.3 : (0.2 + gap) * i, i == 0 ? 1 : 0);
    const AchievedAccuracy accuracy =
        check(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "row", "duration": 0.5, "gravity": [0, 0, 0],
      "materials": {{"m": {{"restitution": 0.8}}}}, "bodies": [{}]}})",
                                  balls)));
    EXPECT_EQ(accuracy.fault, "") << gap;
    ASSERT_TRUE(accuracy.other);
    EXPECT_EQ(accuracy.other->closeImpacts.has_value(), gap > 0);
    const std::string text = describe(accuracy);
    EXPECT_EQ(text.find("tells nothing from there on: \"b1\" meets \"b0\" and \"b2\"") != std::string::npos, gap > 0)
        << text;
    EXPECT_NE(text.find("not chaotic"), std::string::npos) << text;
  }
}

// Towards the end one sphere is put 5 mm into the ground.
TEST(AchievedAccuracy, ThatAFaultSpoilsIsNotCalledChaos) {
  const Scene scene = fallingSpheres();
  Trajectory run = simulate(scene);
  for (Frame& frame : run.frames)
    if (frame.time > 0.9) frame.states[1].position.y() = 0.095;
  const AchievedAccuracy accuracy = checkRun(scene, run);
  EXPECT_NE(accuracy.fault.find("\"b\" is 0.005 m deep in \"ground\""), std::string::npos) << accuracy.fault;
  EXPECT_NE(describe(accuracy).find("A fault, not chaos: at "), std::string::npos);
  EXPECT_EQ(describe(accuracy).find("Chaotic"), std::string::npos);
}

TEST(AchievedAccuracy, NamesEnergyThatNothingExplains) {
  const Scene scene = fallingSpheres();
  Trajectory run = simulate(scene);
  double largest = 0;
  for (const Frame& frame : run.frames) largest = std::max(largest, frame.energy.kinetic);
  run.frames.back().energy.dissipated += 0.01 * largest;
  EXPECT_NEAR(checkRun(scene, run).numericalEnergy, 0.01, 1e-8);
}

TEST(AchievedAccuracy, SaysWhatTouchedInOneRunAlone) {
  const Scene scene = fallingSpheres();
  Trajectory run = simulate(scene);
  ASSERT_FALSE(run.events.empty());
  Event touch = run.events.front();
  touch.bodyA = 2, touch.bodyB = 1;
  run.events.insert(run.events.begin() + 1, touch);
  const AchievedAccuracy accuracy = checkRun(scene, run);
  EXPECT_EQ(accuracy.touchDifference, fmt::format("\"a\" and \"b\" at {:.6g} s, in the run alone", touch.time));
  EXPECT_NE(describe(accuracy).find("The two runs differ in what touched"), std::string::npos);
}

// Of frames that are what the steps make of the scene, and of such in which a sphere lies elsewhere.
TEST(SteppedRuns, DisagreeWithAFaultOfEventsAndWithNothingElse) {
  const Scene scene = fallingSpheres();
  const Trajectory run = simulate(scene);
  SteppedRuns right(scene), wrong(scene);
  for (const Frame& frame : run.frames) {
    right.take(frame, 1);
    Frame other = frame;
    if (frame.time > 0.5) other.states[0].position.x() += 0.05;
    wrong.take(other, 1);
  }
  EXPECT_FALSE(right.result().disagrees);
  EXPECT_TRUE(wrong.result().disagrees);
  EXPECT_NEAR(wrong.result().time, 31.0 / 60, 1e-9);
  EXPECT_NEAR(wrong.result().difference, 0.05 / 1.05, 0.003);  // relative to 1 + |x_ref|, x about 0 or 0.05
}

}  // namespace
}  // namespace cradle
