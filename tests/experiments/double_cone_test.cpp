// A double cone on two rails that rise and diverge: it rolls up, as its middle sinks between them.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "experiments/experiment.h"

namespace cradle {
namespace {

constexpr double kConeRadius = 0.05, kConeLength = 0.15;            // m; half of the whole length
constexpr double kDiverging = 0.45, kRising = 0.06, kWire = 0.005;  // rad, rad; m: radius of the rails
constexpr int kFacets = 200;

void writeDoubleCone(const std::string& path) {
  std::ofstream file(path);
  file << fmt::format("v {} 0 0\nv {} 0 0\n", -kConeLength, kConeLength);
  for (int i = 0; i < kFacets; ++i) {
    const double angle = 2 * 3.14159265358979324 * i / kFacets;
    file << fmt::format("v 0 {:.12f} {:.12f}\n", kConeRadius * std::cos(angle), kConeRadius * std::sin(angle));
  }
  for (int i = 0; i < kFacets; ++i) {
    const int here = 3 + i, next = 3 + (i + 1) % kFacets;
    file << fmt::format("f 1 {} {}\nf 2 {} {}\n", next, here, here, next);
  }
}

/// Along z and up, from beside x = 0 to the side of `sign`.
std::string railText(const char* name, double sign) {
  const Vec3 way(sign * std::sin(kDiverging) * std::cos(kRising), std::sin(kRising),
                 std::cos(kDiverging) * std::cos(kRising));
  const Quat turn = Quat::FromTwoVectors(Vec3::UnitY(), way);
  return fmt::format(R"({{"name": "{}", "shape": {{"capsule": {{"radius": {}, "length": 0.5}}}}, "motion": "static",
      "position": {}, "orientation": {{"w": {}, "x": {}, "y": {}, "z": {}}}}})",
                     name, kWire, vectorText(Vec3(sign * 0.03, 0, 0) + 0.15 * way), turn.w(), turn.x(), turn.y(),
                     turn.z());
}

// What it loses is what facets of 1.8 degrees take at each edge that it rolls over, and contact steps: some per cent.
TEST(DoubleCone, RollsUpTheRailsAndSinks) {
  const std::string folder = testing::TempDir() + "double_cone/";
  std::filesystem::create_directories(folder);
  writeDoubleCone(folder + "cone.obj");
  const std::string text = fmt::format(R"({{"schema": "cradle-scene/1", "name": "Double cone", "duration": 0.6,
    "accuracy": 1e-3, "output": {{"framesPerSecond": 20}},
    "bodies": [{}, {}, {{"name": "cone", "shape": {{"mesh": "cone.obj"}}, "mass": 1, "position": [0, 0.041, 0.05]}}]}})",
                                       railText("left", 1), railText("right", -1));
  const Trajectory run =
      simulate(parseScene(text, folder + "scene.json", modelFilesBeside(folder + "scene.json")).scene);
  const double start = mechanicalEnergy(run.frames[1]);  // on the rails
  for (std::size_t i = 2; i < run.frames.size(); ++i) {
    const BodyState &before = run.frames[i - 1].states[0], &now = run.frames[i].states[0];
    EXPECT_GT(now.position.z(), before.position.z()) << i;
    EXPECT_LT(now.position.y(), before.position.y()) << i;
    EXPECT_NEAR(now.position.x(), 0, 1e-6) << i;
  }
  const Frame& end = run.frames.back();
  EXPECT_GT(end.states[0].position.z() - run.frames[0].states[0].position.z(), 0.05);
  EXPECT_NEAR(mechanicalEnergy(end), start, 0.05 * end.energy.kinetic);
}

}  // namespace
}  // namespace cradle
