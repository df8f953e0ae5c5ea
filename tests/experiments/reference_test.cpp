// Problems with known solutions, through the whole pipeline at several accuracies. references.json says where each
// solution comes from.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "experiments/tie_error.h"

namespace cradle {
namespace {

using Json = nlohmann::json;

const Json& references() {
  static const Json all = Json::parse(std::ifstream(CRADLE_SOURCE_DIR "/tests/experiments/references.json"));
  return all;
}

const Json& reference(const std::string& name) {
  for (const Json& problem : references())
    if (problem["name"] == name) return problem;
  throw std::out_of_range(name);
}

Scene sceneOfProblem(const Json& problem, double accuracy) {
  Json scene = problem["scene"];
  scene["accuracy"] = accuracy;
  return sceneOf(scene.dump());
}

Vec3 vectorOf(const Json& numbers) {
  return Vec3(numbers[0], numbers[1], numbers[2]);
}

/// Largest error of components, scaled 1 + |x|.
double scaledError(const Eigen::VectorXd& actual, const Eigen::VectorXd& expected) {
  return ((actual - expected).array().abs() / (1 + expected.array().abs())).maxCoeff();
}

double errorOf(const BodyState& state, const Json& expected) {
  double error = 0;
  const auto compare = [&](const char* key, const Vec3& value) {
    if (expected.contains(key)) error = std::max(error, scaledError(value, vectorOf(expected[key])));
  };
  compare("position", state.position);
  compare("linearVelocity", state.linearVelocity);
  compare("angularVelocity", state.angularVelocity);
  if (expected.contains("orientation")) {
    const Json& q = expected["orientation"];
    const Eigen::Vector4d wanted = Quat(q[0], q[1], q[2], q[3]).coeffs(), got = state.orientation.coeffs();
    error = std::max(error, std::min(scaledError(got, wanted), scaledError(-got, wanted)));
  }
  return error;
}

class Reference : public testing::TestWithParam<std::string> {};

// The accuracy bounds local errors; the motion makes `sensitivity` times as much of them as a disturbance of its start
// grows by. Ten steps and more add up to a tenth each. Digits of double precision end at 1e-12 of the same.
TEST_P(Reference, IsMetAtEveryAccuracy) {
  const Json& problem = reference(GetParam());
  for (const double accuracy : {1e-3, 1e-6, 1e-8, 1e-10}) {
    const Scene scene = sceneOfProblem(problem, accuracy);
    const Trajectory run = simulate(scene);
    for (const Json& expected : problem["expected"]) {
      const double sensitivity = expected["sensitivity"];
      const Frame& frame = run.frames.at(expected["time"].get<std::size_t>());  // one a second
      ASSERT_EQ(frame.time, expected["time"].get<double>());
      EXPECT_LE(errorOf(frame.states.at(expected["body"]), expected),
                std::max(accuracy * std::max(10., sensitivity), 1e-12 * sensitivity))
          << "accuracy " << accuracy << " at " << frame.time << " s";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, Reference,
                         testing::Values("Tumbling body", "Lagrange top", "Box on a corner spring",
                                         "Double rod pendulum", "Ball on a rope", "Two boxes on a spring",
                                         "Simple pendulum"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

// Projection leaves rounding at the ends of steps; frames lie anywhere between, on interpolants whose error is below
// the steps' own.
TEST(Ties, HoldInEveryFrameAtTheFinestAccuracy) {
  for (const char* name : {"Lagrange top", "Double rod pendulum", "Simple pendulum"}) {
    Scene scene = sceneOfProblem(reference(name), 1e-10);
    scene.output.framesPerSecond = 61;
    EXPECT_LE(largestTieError(simulate(scene), scene), 1e-10) << name;
  }
}

// Each later time is off by the error of the swing before: sensitivity 19 of 1e-10 in all.
TEST(BallOnARope, GoesTautAndSlackAtTheReferencesTimes) {
  const Json& problem = reference("Ball on a rope");
  const Trajectory run = simulate(sceneOfProblem(problem, 1e-10));
  ASSERT_EQ(run.events.size(), problem["events"].size());
  for (std::size_t i = 0; i < run.events.size(); ++i) {
    const Json& expected = problem["events"][i];
    EXPECT_EQ(eventKindName(run.events[i].kind), expected["kind"]) << i;
    EXPECT_NEAR(run.events[i].time, expected["time"], 1e-9) << i;
    EXPECT_NEAR(run.events[i].impulse, expected.value("impulse", 0.0), 1e-8) << i;
  }
}

}  // namespace
}  // namespace cradle
