#include "sampling/scene_sampler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "simulate/start_overlaps.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

class SceneSamplers : public testing::Test {
 protected:
  SceneSamplers() : folder_(fs::temp_directory_path() / ("cradle_sampler_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~SceneSamplers() override { fs::remove_all(folder_); }

  SceneSampler samplerOf(const std::string& bodies) const {
    const std::string path = (folder_ / "scene.json").string();
    std::ofstream(path) << R"({"schema": "cradle-scene/1", "name": "drawn", "duration": 0.1, "bodies": [)" << bodies
                        << "]}";
    return SceneSampler(path);
  }

  static double xOf(const DrawnScene& drawn, std::size_t body) {
    return drawn.loaded.scene.bodies.at(body).worldFromBody.translation.x();
  }

  fs::path folder_;
};

std::string ball(const std::string& name, const std::string& x) {
  return R"({"name": ")" + name + R"(", "shape": {"sphere": {"radius": 0.5}}, "position": [)" + x + ", 0, 0]}";
}

const char* const kAnywhere = R"({"draw": {"uniform": [0, 4]}})";

TEST_F(SceneSamplers, SamplesDependOnSeedAndNumberAlone) {
  const SceneSampler sampler = samplerOf(ball("a", kAnywhere));
  const double first = xOf(sampler.sample(1, 0), 0);
  EXPECT_NE(xOf(sampler.sample(1, 1), 0), first);
  EXPECT_NE(xOf(sampler.sample(2, 0), 0), first);
  EXPECT_EQ(xOf(sampler.sample(1, 0), 0), first);
}

// Of two balls of radius 1/2 in 0..4, drawn without a thought for the other, 1 - (3/4)^2 = 7/16 overlap.
TEST_F(SceneSamplers, BodiesThatOverlapAreDrawnAgainAndThoseBeforeThemStay) {
  const SceneSampler both = samplerOf(ball("a", kAnywhere) + "," + ball("b", kAnywhere));
  constexpr int kSamples = 400;
  int redrawn = 0;
  for (long i = 0; i < kSamples; ++i) {
    const DrawnScene drawn = both.sample(3, i);
    EXPECT_GE(std::abs(xOf(drawn, 0) - xOf(drawn, 1)), 1);
    EXPECT_TRUE(bodiesInEachOther(drawn.loaded.scene).empty());
    redrawn += drawn.redrawn > 0;
  }
  // Standard deviation sqrt(p (1 - p) / n) = 0.025; four of them.
  EXPECT_NEAR(redrawn / double(kSamples), 7.0 / 16, 0.1);
  const SceneSampler alone = samplerOf(ball("a", kAnywhere));
  for (long i = 0; i < 20; ++i) EXPECT_EQ(xOf(both.sample(3, i), 0), xOf(alone.sample(3, i), 0));
}

TEST_F(SceneSamplers, BodiesWithoutDrawsAreThereFirst) {
  const SceneSampler sampler = samplerOf(ball("a", kAnywhere) + "," + ball("b", "2"));
  for (long i = 0; i < 50; ++i) EXPECT_GE(std::abs(xOf(sampler.sample(1, i), 0) - 2), 1);
}

TEST_F(SceneSamplers, TheDrawThatChoosesABodyIsNotMadeAgain) {
  // Else there would be fewer samples with two balls than half of them: the overlaps would choose the empty place.
  const std::string optional = R"({"draw": {"choice": [null, )" + ball("b", kAnywhere) + "]}}";
  const SceneSampler sampler = samplerOf(ball("a", kAnywhere) + "," + optional);
  constexpr int kSamples = 400;
  int both = 0;
  for (long i = 0; i < kSamples; ++i) both += sampler.sample(1, i).loaded.scene.bodies.size() == 2;
  EXPECT_NEAR(both / double(kSamples), 0.5, 4 * std::sqrt(0.25 / kSamples));
}

TEST_F(SceneSamplers, WhereThereIsNoRoomTheErrorNamesTheBody) {
  const SceneSampler sampler = samplerOf(ball("a", "0") + "," + ball("b", R"({"draw": {"uniform": [-0.1, 0.1]}})"));
  try {
    sampler.sample(1, 0);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    EXPECT_THAT(error.what(), testing::HasSubstr("/bodies/1: is in another body in each of 1000 draws"));
  }
}

TEST_F(SceneSamplers, FaultsOfDrawnValuesNameTheirPlaceInTheFileWithDraws) {
  const SceneSampler sampler = samplerOf("\n" + ball("a", R"({"draw": {"uniform": [1e13, 2e13]}})"));
  try {
    sampler.sample(1, 0);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("scene.json:2:"));
    EXPECT_THAT(error.what(), testing::HasSubstr("/bodies/0/position/0"));
  }
}

TEST_F(SceneSamplers, PathsInTheTextLeadToTheSameFilesFromAnotherFolder) {
  fs::copy_file(fs::path(CRADLE_SOURCE_DIR) / "assets" / "ball.3ds", folder_ / "ball.3ds");
  const SceneSampler sampler =
      samplerOf(R"({"name": "a", "shape": {"mesh": "ball.3ds"}, "position": [)" + std::string(kAnywhere) + ", 0, 0]}");
  const DrawnScene drawn = sampler.sample(1, 0);
  const fs::path inside = folder_ / "set" / "sample_000000";
  fs::create_directories(inside);
  std::ofstream(inside / "scene.json") << textInFolder(drawn, sampler.path(), inside.string());
  const LoadedScene loaded = loadScene((inside / "scene.json").string());
  EXPECT_EQ(loaded.scene.bodies.at(0).worldFromBody.translation.x(), xOf(drawn, 0));
  EXPECT_GT(loaded.scene.bodies.at(0).massProperties.mass, 0);
}

}  // namespace
}  // namespace cradle
