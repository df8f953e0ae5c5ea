#include "sampling/wish_watch.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "sampling/metropolis_chain.h"
#include "sampling/scene_sampler.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

class Wishes : public testing::Test {
 protected:
  Wishes() : folder_(fs::temp_directory_path() / ("cradle_wishes_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Wishes() override { fs::remove_all(folder_); }

  SceneSampler samplerOf(const std::string& members) const {
    const std::string path = (folder_ / "scene.json").string();
    std::ofstream(path) << R"({"schema": "cradle-scene/1", "name": "wished", )" << members << "}";
    return SceneSampler(path);
  }

  WishedMotion motionOf(const std::string& members) const {
    return simulateWishes(samplerOf(members).sample(1, 0).loaded.scene);
  }

  fs::path folder_;
};

std::string bodies(const std::string& entries) {
  return R"("bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "smooth"}, )" +
         entries + R"(], "materials": {"smooth": {"restitution": 0.8, "staticFriction": 0, "dynamicFriction": 0}})";
}

std::string ball(const std::string& members) {
  return R"({"name": "ball", "material": "smooth", "shape": {"sphere": {"radius": 0.1}}, )" + members + "}";
}

// Thrown in free fall: at 0.5 s x = 1 * 0.5, y = 10 - 9.81 * 0.125.
TEST_F(Wishes, TellTheDistanceOfTheCentreOfMassFromABox) {
  const WishedMotion motion = motionOf(
      R"("duration": 1, )" + bodies(ball(R"("position": [0, 10, 0], "linearVelocity": [1, 0, 0])")) +
      R"(, "wishes": [{"body": "ball", "at": 0.5, "inside": {"min": [3.5, 0, -1], "max": [4, 4.77375, 1]}, "deviation": 2},
                      {"body": "ball", "inside": {"min": [0.9, 5, -1], "max": [1.1, 6, 1]}, "deviation": 1}])");
  ASSERT_EQ(motion.outcomes.size(), 2);
  EXPECT_NEAR(motion.outcomes[0].distance, 5, 1e-9);
  EXPECT_FALSE(motion.outcomes[0].isMet);
  EXPECT_EQ(motion.outcomes[1].distance, 0);
  EXPECT_TRUE(motion.outcomes[1].isMet);
  EXPECT_NEAR(motion.logLikelihood, -2.5 * 2.5 / 2, 1e-8);
  EXPECT_FALSE(std::signbit(logLikelihood({}, {})));
}

TEST_F(Wishes, TellTheAngleOfADirectionFromUp) {
  const WishedMotion motion = motionOf(
      R"("duration": 1, "gravity": [0, 0, 0], )" +
      bodies(ball(R"("position": [0, 10, 0], "angularVelocity": [0.4, 0, 0])")) +
      R"(, "wishes": [{"body": "ball", "up": [0, 1, 0], "deviation": 1}, {"body": "ball", "up": [0, 0, -2], "deviation": 1}])");
  EXPECT_NEAR(motion.outcomes.at(0).distance, 0.4, 1e-9);
  EXPECT_TRUE(motion.outcomes[0].isMet);
  EXPECT_NEAR(motion.outcomes.at(1).distance, std::numbers::pi / 2 - 0.4, 1e-9);
  EXPECT_FALSE(motion.outcomes[1].isMet);
}

// Past a ball at rest: the least distance is where they are beside each other, at a frame here.
TEST_F(Wishes, TellTheLeastDistanceOfBodiesThatDoNotTouch) {
  const std::string other =
      R"({"name": "other", "motion": "static", "shape": {"sphere": {"radius": 0.2}}, "position": [1, 5, 0]})";
  const auto passing = [&](const std::string& z) {
    return motionOf(R"("duration": 2, "gravity": [0, 0, 0], )" +
                    bodies(ball(R"("linearVelocity": [1, 0, 0], "position": [0, 5, )" + z + "]") + "," + other) +
                    R"(, "wishes": [{"contact": ["ball", "other"], "deviation": 0.1}])");
  };
  EXPECT_NEAR(passing("1").outcomes.at(0).distance, 0.7, 1e-9);
  EXPECT_FALSE(passing("1").outcomes.at(0).isMet);
  EXPECT_TRUE(passing("0.29").outcomes.at(0).isMet);
  EXPECT_EQ(passing("0.29").outcomes.at(0).distance, 0);
}

TEST_F(Wishes, AreMetByContactThatThereWasFromTheStart) {
  const WishedMotion motion = motionOf(R"("duration": 0.1, )" + bodies(ball(R"("position": [0, 0.1, 0])")) +
                                       R"(, "wishes": [{"contact": ["floor", "ball"], "deviation": 1}])");
  EXPECT_TRUE(motion.outcomes.at(0).isMet);
}

TEST_F(Wishes, OfContactNeedBodiesThatCanTouch) {
  const SceneSampler sampler =
      samplerOf(R"("duration": 1, )" + bodies(ball(R"("collision": "none", "position": [0, 1, 0])")) +
                R"(, "wishes": [{"contact": ["ball", "floor"], "deviation": 1}])");
  EXPECT_THROW(simulateWishes(sampler.sample(1, 0).loaded.scene), Error);
}

// One bounce off a smooth floor: at 1 s x = v, with v normal (0, 1) before a wish for x = 2 with the deviation 0.5. By
// Bayes' rule x is then normal with the mean 2 * 1 / (1 + 0.25) = 1.6 and the deviation 0.5 / sqrt(1.25). Kolmogorov
// and Smirnov: sup |F_n - F| of n independent numbers exceeds 1.95 / sqrt(n) once in a thousand.
TEST_F(Wishes, GiveTheLandingPointOfABallItsPosteriorDensity) {
  const SceneSampler sampler = samplerOf(
      R"("duration": 1, "output": {"framesPerSecond": 1}, )" +
      bodies(ball(R"("position": [0, 1, 0], "linearVelocity": [{"draw": {"normal": [0, 1]}}, 0, 0])")) +
      R"(, "wishes": [{"body": "ball", "inside": {"min": [2, -9, -9], "max": [2, 9, 9]}, "deviation": 0.5}])");
  const auto likelihood = [&](const UniformSource& uniform, const std::vector<NamedBumpChange>&) {
    return ChainOutcome{simulateWishes(sampler.sceneOf(uniform).loaded.scene).logLikelihood};
  };
  const DrawnScene start = sampler.sample(4, 0);
  MetropolisChain chain(sampler.places(), false, likelihood, RandomStream(4),
                        {start.numbers, simulateWishes(start.loaded.scene).logLikelihood});
  std::vector<double> all, thinned;
  for (int i = 1; i <= 6000; ++i) {
    chain.step(i);
    all.push_back(normalQuantile(chain.state().numbers.begin()->second.at(0)));
  }
  const int time = static_cast<int>(std::ceil(autocorrelationTime(all)));
  for (std::size_t i = 50; i < all.size(); i += static_cast<std::size_t>(2 * time)) thinned.push_back(all[i]);
  std::sort(thinned.begin(), thinned.end());
  const double count = static_cast<double>(thinned.size());
  ASSERT_GT(count, 100);
  double farthest = 0;
  for (std::size_t i = 0; i < thinned.size(); ++i) {
    const double share = std::erfc(-(thinned[i] - 1.6) * std::sqrt(1.25) / 0.5 / std::numbers::sqrt2) / 2;
    farthest = std::max({farthest, static_cast<double>(i + 1) / count - share, share - static_cast<double>(i) / count});
  }
  EXPECT_LT(farthest, 1.95 / std::sqrt(count));
}

// Chi-squared with five degrees of freedom exceeds 20.5 once in a thousand.
TEST_F(Wishes, FindADieFairWhoseOrientationIsAnyRotation) {
  const SceneSampler sampler = samplerOf(
      R"("duration": 1.5, "accuracy": "visual", "bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static"},
        {"name": "die", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "position": [0, 0.3, 0], "orientation": {"draw": "rotation"}}],
        "wishes": [{"body": "die", "up": [1, 0, 0], "deviation": 1}, {"body": "die", "up": [-1, 0, 0], "deviation": 1},
                   {"body": "die", "up": [0, 1, 0], "deviation": 1}, {"body": "die", "up": [0, -1, 0], "deviation": 1},
                   {"body": "die", "up": [0, 0, 1], "deviation": 1}, {"body": "die", "up": [0, 0, -1], "deviation": 1}])");
  constexpr int kThrows = 300;
  std::vector<int> counts(6, 0);
  for (long i = 0; i < kThrows; ++i) {
    const WishedMotion motion = simulateWishes(sampler.sample(11, i).loaded.scene);
    int met = 0;
    for (std::size_t face = 0; face < 6; ++face) {
      if (!motion.outcomes[face].isMet) continue;
      ++counts[face], ++met;
      EXPECT_LT(motion.outcomes[face].distance, 1e-3) << i;  // flat on the floor
    }
    EXPECT_EQ(met, 1) << i;
  }
  double chiSquared = 0;
  for (const int count : counts) chiSquared += (count - kThrows / 6.0) * (count - kThrows / 6.0) / (kThrows / 6.0);
  EXPECT_LT(chiSquared, 20.5) << testing::PrintToString(counts);
}

// Onto an edge, off its middle by a normal number with the mean m and the deviation s: to the right with Phi(m / s).
TEST_F(Wishes, FindABallToGoToTheSideOfAnEdgeThatItHit) {
  const SceneSampler sampler = samplerOf(
      R"("duration": 0.7, )" +
      bodies(
          R"({"name": "edge", "motion": "static", "material": "smooth", "shape": {"box": {"size": [0.2, 0.2, 1]}}, "position": [0, 1, 0],
                 "orientation": {"axis": [0, 0, 1], "angleDegrees": 45}}, )" +
          ball(R"("position": [{"draw": {"normal": [0.02, 0.04]}}, 1.5, 0])")) +
      R"(, "wishes": [{"body": "ball", "inside": {"min": [0, -9, -9], "max": [9, 9, 9]}, "deviation": 1}])");
  constexpr int kThrows = 400;
  int right = 0;
  for (long i = 0; i < kThrows; ++i) right += simulateWishes(sampler.sample(2, i).loaded.scene).outcomes[0].isMet;
  const double expected = std::erfc(-0.5 / std::numbers::sqrt2) / 2;
  EXPECT_NEAR(right / double(kThrows), expected, 4 * std::sqrt(expected * (1 - expected) / kThrows));
}

/// Four rows of pegs, `side` 1 or -1 to mirror all, a ball that comes from `x` (m) above them, and a wish for it to be
/// in the right, or the left, half of the floor in the end.
std::string pegBoard(double side, double x) {
  std::string entries;
  for (int row = 0; row < 4; ++row)
    for (int peg = 0; peg < 3; ++peg)
      entries += fmt::format(
          R"({{"name": "peg{}{}", "motion": "static", "material": "smooth", "shape": {{"sphere": {{"radius": 0.05}}}},
              "position": [{}, {}, 0]}}, )",
          row, peg, side * (0.4 * (peg - 1) + 0.2 * (row % 2) + 0.01 * row), 2 - 0.3 * row);
  return R"("duration": 1.5, )" + bodies(entries + ball(fmt::format(R"("position": [{}, 2.4, 0])", side * x))) +
         fmt::format(
             R"(, "wishes": [{{"body": "ball", "inside": {{"min": [{}, -9, -9], "max": [{}, 9, 9]}}, "deviation": 1}}])",
             side > 0 ? 0 : -9, side > 0 ? 9 : 0);
}

// Rounding, 1e-16, grows at each of at most ten bounces by less than 4 d / r, d the way between pegs: 1e-16 * 12^10 =
// 6e-6.
TEST_F(Wishes, AreMetByMirroredMotionsOnAMirroredBoard) {
  RandomStream random(8);
  int met = 0;
  constexpr int kBalls = 60;
  for (int i = 0; i < kBalls; ++i) {
    const double x = 0.4 * (random.nextUniform() - 0.5);
    const WishOutcome right = motionOf(pegBoard(1, x)).outcomes.at(0), left = motionOf(pegBoard(-1, x)).outcomes.at(0);
    EXPECT_NEAR(right.distance, left.distance, 1e-5) << x;
    EXPECT_TRUE(right.isMet == left.isMet || right.distance < 1e-5) << x;
    met += right.isMet;
  }
  EXPECT_GT(met, 5);
  EXPECT_LT(met, kBalls - 5);
}

}  // namespace
}  // namespace cradle
