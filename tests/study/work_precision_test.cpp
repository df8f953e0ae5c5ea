#include "study/work_precision.h"

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "study/sample_scenes.h"
#include "study/study_table.h"

namespace cradle {
namespace {

void ignore() {}

std::vector<StudyRow> rowsOf(StudyScene& scene, const char* method, const Reference& reference,
                             const std::vector<StudyRow>& earlier = {}) {
  std::vector<StudyRow> rows;
  sweep(scene, "test", methodOf(method), reference, {earlier, [&](const StudyRow& row) { rows.push_back(row); }});
  return rows;
}

/// The reference as if it were known no better than that, so that sweeps end there.
Reference coarselyKnown(StudyScene& scene, double uncertainty) {
  Reference reference = findReference(scene, ignore);
  reference.uncertainty = uncertainty;
  return reference;
}

/// Fields of a line of study.csv that has no quotes.
std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream text(line);
  for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
  return fields;
}

TEST(Reference, OfAnOscillatorIsAsNearToTheClosedFormAsItSays) {
  const double omega = 7, duration = 2;
  StudyScene scene(oscillator(omega, duration));
  const Reference reference = findReference(scene, ignore);
  EXPECT_LT(reference.uncertainty, 1e-10);
  EXPECT_NEAR(reference.end[0].position.x(), 1 + 0.25 * std::cos(omega * duration),
              2.25 * reference.uncertainty + 1e-14);
}

TEST(Reference, EndsWhereNothingIsGained) {
  // RK4 solves a parabola exactly at any step: the first two runs agree to the rounding of some hundred steps.
  StudyScene scene(freeFall(2));
  const Reference reference = findReference(scene, ignore);
  EXPECT_LT(reference.uncertainty, 1e-12);
  EXPECT_NEAR(reference.end[0].position.y(), -9.81 * 2 * 2 / 2, 20 * 1e-12);
}

TEST(WorkPrecision, Rk4HasSlopeFourOnTheSuspendedModel) {
  Scene loaded = loadScene(CRADLE_SOURCE_DIR "/scenes/suspended_model.json").scene;
  loaded.duration = 3;
  StudyScene scene(std::move(loaded));
  const Reference reference = findReference(scene, ignore);
  std::vector<double> errors;
  for (const StudyRow& row : rowsOf(scene, "rk4", reference)) {
    const double error = std::stod(fieldsOf(tableLine(row))[4]);
    if (error < 1e-4 && error > 100 * reference.uncertainty) errors.push_back(error);
  }
  // C h^4 (1 + c h + ...): the next order is left of h at the coarse end, a factor 10 of 16^n over all rungs at most.
  ASSERT_GE(errors.size(), 4U);
  const double order = std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
  EXPECT_NEAR(order, 4, 0.15);
}

TEST(WorkPrecision, CostAndErrorGoOppositeWays) {
  StudyScene scene(oscillator(5, 2));
  const std::vector<StudyRow> rows = rowsOf(scene, "rk4", findReference(scene, ignore));
  ASSERT_GE(rows.size(), 6U);
  for (std::size_t i = 2; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].evaluations, 2 * rows[i - 1].evaluations);
    EXPECT_LT(rows[i].error, rows[i - 1].error);
  }
  EXPECT_GT(rows.back().cpuSecondsPerSimulatedSecond, rows[1].cpuSecondsPerSimulatedSecond);
}

TEST(WorkPrecision, RowsThatAreThereAreNotRunAgain) {
  StudyScene scene(oscillator(5, 2));
  const Reference reference = coarselyKnown(scene, 1e-6);
  const std::vector<StudyRow> whole = rowsOf(scene, "rk4", reference);
  ASSERT_GE(whole.size(), 4U);
  std::vector<StudyRow> half(whole.begin(), whole.begin() + 3);
  for (StudyRow& row : half) row.isEarlier = true;
  const std::vector<StudyRow> goneOn = rowsOf(scene, "rk4", reference, half);
  ASSERT_EQ(goneOn.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(goneOn[i].isEarlier, i < half.size());
    EXPECT_EQ(goneOn[i].setting, whole[i].setting);
    EXPECT_EQ(fieldsOf(tableLine(goneOn[i]))[4], fieldsOf(tableLine(whole[i]))[4]);  // the error, NaN among them
  }
}

// Two oscillations take far less than 0.1 s. What took 0.3 s is exact enough, and an unstable run has no cost.
TEST(WorkPrecision, AnotherTurnFindsLessTimeForShortRuns) {
  StudyScene scene(oscillator(5, 2));
  std::vector<StudyRow> rows = rowsOf(scene, "rk4", coarselyKnown(scene, 1e-6));
  ASSERT_GE(rows.size(), 5U);
  rows.erase(rows.begin(), rows.end() - 4);
  const std::vector<double> seconds = {0.1, 0.3, 1e-12, 0.1};
  for (std::size_t i = 0; i < 4; ++i) rows[i].cpuSecondsPerSimulatedSecond = seconds[i] / scene.duration();
  rows[3].status = RunStatus::unstable;
  timeInAnotherTurn(scene, {methodOf("rk4")}, rows, ignore);
  EXPECT_LT(rows[0].cpuSecondsPerSimulatedSecond, 0.1 / scene.duration());
  for (const std::size_t i : {1U, 2U, 3U})
    EXPECT_EQ(rows[i].cpuSecondsPerSimulatedSecond, seconds[i] / scene.duration()) << i;
}

TEST(WorkPrecision, ThePlanGoesThroughAllAccuracies) {
  // Exact at the first: free fall has a closed form.
  StudyScene scene(freeFall(1));
  EXPECT_EQ(rowsOf(scene, "plan", findReference(scene, ignore)).size(), 11U);
}

TEST(WorkPrecision, ExplicitEulerIsUnstableAtItsLargestSteps) {
  // An undamped oscillator gains the factor 1 + (step x omega)^2 of its energy a step, 5 at the first rung: after 30
  // steps nothing explains it. The sweep ends where it follows the motion.
  StudyScene scene(oscillator(20, 3));
  const std::vector<StudyRow> rows = rowsOf(scene, "explicitEuler", coarselyKnown(scene, 1e-2));
  EXPECT_EQ(rows.front().status, RunStatus::unstable);
  EXPECT_TRUE(std::isnan(rows.front().error));
  EXPECT_EQ(rows.back().status, RunStatus::ok);
  EXPECT_LT(rows.back().error, 1e-2);
}

TEST(WorkPrecision, EveryMethodWorksOrFailsOnce) {
  StudyScene scene(oscillator(5, 0.5));
  const Reference reference = coarselyKnown(scene, 1e-3);
  for (const StudyMethod& method : studyMethods()) {
    const std::vector<StudyRow> rows = rowsOf(scene, method.name.c_str(), reference);
    ASSERT_FALSE(rows.empty());
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) EXPECT_NE(rows[i].status, RunStatus::failed) << method.name;
    EXPECT_EQ(rows.back().status == RunStatus::failed, !rows.back().message.empty()) << method.name;
  }
}

TEST(StudyMethods, AnUnknownNameIsToldWithTheKnownOnes) {
  try {
    studyMethodsNamed({"rk4", "rk5"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("rk5"), ::testing::HasSubstr("semiImplicitEuler")));
  }
}

TEST(StudyMethods, AreInTheOrderOfChartsWhateverTheOrderOfNames) {
  const std::vector<StudyMethod> methods = studyMethodsNamed({"rk4", "explicitEuler"});
  ASSERT_EQ(methods.size(), 2U);
  EXPECT_EQ(methods[0].name, "explicitEuler");
}

}  // namespace
}  // namespace cradle
