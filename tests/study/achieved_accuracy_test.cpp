#include "study/achieved_accuracy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "simulate/simulate.h"
#include "study/sample_scenes.h"

namespace cradle {
namespace {

/// Runs a scene into a file, and checks it.
AchievedAccuracy check(const Scene& scene, std::vector<Frame>* frames = nullptr) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = std::filesystem::path(testing::TempDir()) / (std::string(test->name()) + ".sqlite");
  {
    TrajectoryWriter writer(path, headerOf(scene, planOf(scene)));
    const Trajectory run = simulate(scene);
    for (const Frame& frame : run.frames) writer.append(frame);
    writer.finish(run.cost);
    if (frames != nullptr) *frames = run.frames;
  }
  const TrajectoryReader reader(path);
  const AchievedAccuracy accuracy = achievedAccuracy(scene, reader, [](long) {});
  std::filesystem::remove(path);
  return accuracy;
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

}  // namespace
}  // namespace cradle
