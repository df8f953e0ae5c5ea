// A sample of the scenes that benchmarks/random_scenes runs by the thousand.

#include <gtest/gtest.h>

#include "experiments/experiment.h"
#include "experiments/random_scene.h"
#include "experiments/random_scene_figures.h"

namespace cradle {
namespace {

Scene randomScene(unsigned number) {
  return parseScene(randomSceneText(number), "random.json", modelFilesBeside("random.json")).scene;
}

TEST(RandomScenes, StayFiniteKeepTheirTiesAndNeverGainEnergy) {
  for (unsigned number = 1; number <= 60; ++number) {
    const Scene scene = randomScene(number);
    const std::vector<std::string> faults = faultsOf(runRandomScene(scene), scene.accuracy);
    EXPECT_TRUE(faults.empty()) << "random_scenes 1 " << number << ": " << fmt::format("{}", fmt::join(faults, "; "));
  }
}

TEST(RandomScenes, AreTheSameForTheSameNumber) {
  EXPECT_EQ(randomSceneText(7), randomSceneText(7));
  EXPECT_NE(randomSceneText(7), randomSceneText(8));
}

// What the other test would say if it went wrong.
TEST(RandomScenes, ShowWhatGoesWrong) {
  RandomSceneFigures figures;
  figures.energyScale = 1;
  EXPECT_TRUE(faultsOf(figures, 1e-5).empty());
  figures.energyGain = figures.penetration = 2e-4;
  EXPECT_EQ(faultsOf(figures, 1e-5).size(), 2u);
  EXPECT_TRUE(faultsOf(figures, 1e-3).empty());
  figures.keepsAccuracy = false;
  EXPECT_TRUE(faultsOf(figures, 1e-5).empty());
  figures.isFinite = false, figures.tieError = 0.1;
  EXPECT_EQ(faultsOf(figures, 1e-5).size(), 2u);
}

}  // namespace
}  // namespace cradle
