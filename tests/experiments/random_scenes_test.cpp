// A sample of the scenes that benchmarks/random_scenes runs by the thousand.

#include <gmock/gmock.h>

#include "experiments/experiment.h"
#include "experiments/random_scene.h"
#include "experiments/random_scene_figures.h"
#include "experiments/random_sketch.h"
#include "experiments/sketch_oracles.h"

namespace cradle {
namespace {

Scene randomScene(unsigned number) {
  return parseScene(randomSceneText(number), "random.json", modelFilesBeside("random.json")).scene;
}

void expectNoFaults(const SceneSketch& sketch) {
  for (const SketchFault& fault : checkSketch(sketch, [](const std::string&) {}))
    if (fault.oracle != "cpu") ADD_FAILURE() << sketch.name << ": " << fault.oracle << ": " << fault.text;
}

class RandomScenes : public testing::TestWithParam<unsigned> {};

TEST_P(RandomScenes, StayFiniteKeepTheirTiesAndNeverGainEnergy) {
  const Scene scene = randomScene(GetParam());
  EXPECT_THAT(faultsOf(runRandomScene(scene), scene.accuracy), testing::IsEmpty());
}

// Those first that once failed: ropes that come to be pulled at while they are at their length, rows that took the
// place of others, frames in steps at whose end one rope goes taut and another slack, a light body on long arms that
// contact steps throw, a rope whose rebound was over before time had moved on.
INSTANTIATE_TEST_SUITE_P(Sample, RandomScenes,
                         testing::Values(58U, 163U, 323U, 461U, 637U, 1201U, 45045U, 1U, 2U, 3U, 4U, 5U, 9U, 10U, 11U,
                                         12U, 13U, 15U, 16U, 17U, 18U, 21U, 22U, 23U, 24U, 26U));

// Of each family a few, with all their twins. The time they take is the benchmark's to judge.
TEST(RandomSketches, PassAllOracles) {
  for (const SketchFamily family : {SketchFamily::touch, SketchFamily::pinned, SketchFamily::squeezed,
                                    SketchFamily::symmetric, SketchFamily::threshold, SketchFamily::led})
    for (const unsigned number : {1U, 4U}) expectNoFaults(randomSketch(family, number));
}

// Of two balls on tori whose files have single precision, a gap of 1e-9 m decides which is struck first: no twin in
// which it is the other one is wrong.
TEST(RandomSketches, AreNotComparedBeyondTheirSensitivity) {
  expectNoFaults(randomSketch(SketchFamily::symmetric, 51054));
}

// Capsules between rolling discs, and a heap of boxes on discs, far beyond their promise, stay their own images.
TEST(RandomSketches, MirrorImagesStayMirrorImagesInStepsOfContact) {
  for (const unsigned number : {50084U, 50463U}) {
    const SceneSketch sketch = randomSketch(SketchFamily::symmetric, number);
    for (const SketchFault& fault : faultsOfRun(sketch, runSketch(sketch)))
      EXPECT_NE(fault.oracle, "symmetry") << number << ": " << fault.text;
  }
}

// A car on a table that rises: more contacts slide when its motors come to their targets than did before.
TEST(RandomSketches, MotorsChangeTheContactsThatSlide) {
  const SceneSketch sketch = randomSketch(SketchFamily::led, 1075);
  for (const SketchFault& fault : faultsOfRun(sketch, runSketch(sketch)))
    if (fault.oracle != "cpu") ADD_FAILURE() << fault.text;
}

// A car whose strong motors turn it over: what a motor's change sets in motion may strike at once, and ask motors anew.
TEST(RandomSketches, ImpactsOfAMotorsChangeChangeMotors) {
  SceneSketch sketch = randomSketch(SketchFamily::led, 1194);
  sketch.accuracy = 1e-9;
  for (const SketchFault& fault : faultsOfRun(sketch, runSketch(sketch)))
    if (fault.oracle != "cpu") ADD_FAILURE() << fault.text;
}

TEST(RandomScene, IsTheSameForTheSameNumber) {
  EXPECT_EQ(randomSceneText(7), randomSceneText(7));
  EXPECT_NE(randomSceneText(7), randomSceneText(8));
}

// What the other test would say if it went wrong.
TEST(RandomScene, ShowsWhatGoesWrong) {
  RandomSceneFigures figures;
  figures.energyScale = 1;
  EXPECT_TRUE(faultsOf(figures, 1e-5).empty());
  figures.energyGain = figures.penetration = 5e-5;
  EXPECT_EQ(faultsOf(figures, 1e-5).size(), 2u);
  EXPECT_TRUE(faultsOf(figures, 1e-3).empty());
  figures.keepsAccuracy = false;
  EXPECT_TRUE(faultsOf(figures, 1e-5).empty());
  figures.isFinite = false, figures.constraintError = 0.1;
  EXPECT_EQ(faultsOf(figures, 1e-5).size(), 2u);
}

}  // namespace
}  // namespace cradle
