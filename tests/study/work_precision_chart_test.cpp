#include "study/work_precision_chart.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "core/error.h"
#include "study/gnuplot.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

StudyRow rowOf(const char* method, double step, double error) {
  StudyRow row;
  row.method = method;
  row.setting = step;
  row.status = std::isnan(error) ? RunStatus::unstable : RunStatus::ok;
  row.error = error;
  row.cpuSecondsPerSimulatedSecond = 1e-6 / step;
  row.evaluations = 4 / step;
  return row;
}

/// Two blow-ups, then errors from 0.25 down by factors of 16.
WorkPrecisionChart sampleChart() {
  WorkPrecisionChart chart{"It's a test", {}, {}, 10};
  chart.reference.uncertainty = 1e-8;
  chart.reference.madeBy = "RK4, step 1e-5 s";
  chart.rows = {rowOf("rk4", 0.5, std::nan("")), rowOf("rk4", 0.25, std::nan(""))};
  for (int i = 0; i < 5; ++i) chart.rows.push_back(rowOf("rk4", 0.125 / (1 << i), 0.25 * std::pow(16, -i)));
  return chart;
}

/// Where the word "better" stands, in parts of the panel; nothing if it does not.
std::optional<std::pair<double, double>> placeOfBetter(const std::string& commands) {
  const std::string begin = "set label 5 'better' at graph ";
  const std::size_t place = commands.find(begin);
  if (place == std::string::npos) return std::nullopt;
  std::pair<double, double> found;
  if (std::sscanf(commands.c_str() + place + begin.size(), "%lf, graph %lf", &found.first, &found.second) != 2)
    return std::nullopt;
  return found;
}

TEST(WorkPrecisionChart, BetterStandsWhereNoCurveGoes) {
  WorkPrecisionChart chart = sampleChart();
  const auto usual = placeOfBetter(chartCommands(chart, ChartFormat::svg));
  ASSERT_TRUE(usual);
  EXPECT_LT(usual->first, 0.1);
  // A closed form: one run, cheap and exact, in the lower left corner.
  StudyRow exact = rowOf("plan", 1, 2e-8);
  exact.cpuSecondsPerSimulatedSecond = 1e-6;
  chart.rows.push_back(exact);
  chart.rows.push_back(exact);
  chart.rows.back().error = 1e-5;  // and something above it
  const auto moved = placeOfBetter(chartCommands(chart, ChartFormat::svg));
  ASSERT_TRUE(moved);
  EXPECT_GT(std::hypot(moved->first - usual->first, moved->second - usual->second), 0.1);
}

TEST(WorkPrecisionChart, BlowUpsStandWhereSuchARunWould) {
  // The coarsest good run has 32 evaluations at a step of 0.125 s, 8e-06 s of CPU time.
  const std::string commands = chartCommands(sampleChart(), ChartFormat::svg);
  const std::string blowUps = commands.substr(commands.find("$blowUps0"));
  EXPECT_THAT(blowUps.substr(0, blowUps.find("EOD\n", 20)),
              ::testing::AllOf(HasSubstr("2e-06 8 "), HasSubstr("4e-06 16 ")));
}

TEST(WorkPrecisionChart, AnUncertainReferenceIsSaidInTheHeading) {
  WorkPrecisionChart chart = sampleChart();
  EXPECT_THAT(chartCommands(chart, ChartFormat::svg), Not(HasSubstr("UNCERTAIN")));
  chart.reference.uncertainty = 1e-3;
  EXPECT_THAT(chartCommands(chart, ChartFormat::svg), HasSubstr("UNCERTAIN"));
}

TEST(WorkPrecisionChart, TextsCannotBeCommands) {
  EXPECT_THAT(chartCommands(sampleChart(), ChartFormat::svg), HasSubstr("'Work and precision: It''s a test'"));
}

TEST(WorkPrecisionChart, GnuplotDrawsBothFiles) {
  ASSERT_TRUE(canDrawCharts()) << "gnuplot is among the packages that ./run packages installs";
  const std::string stem = ::testing::TempDir() + "work_precision_chart_test";
  WorkPrecisionChart chart = sampleChart();
  for (const char* method : {"explicitEuler", "semiImplicitEuler", "dop853FixedStep", "dop853", "plan"})
    for (int i = 0; i < 4; ++i) chart.rows.push_back(rowOf(method, 0.01 / (1 << i), 0.1 * std::pow(2, -i)));
  drawChart(chart, stem);
  for (const char* ending : {".svg", ".png"}) {
    EXPECT_GT(std::filesystem::file_size(stem + ending), 10000U);
    EXPECT_FALSE(std::filesystem::exists(stem + ending + ".part"));
    std::filesystem::remove(stem + ending);
  }
}

// A line feed is a space in a text for gnuplot; files have their names from elsewhere, and links are not followed.
TEST(WorkPrecisionChart, NamesOfFilesAreNoneOfGnuplots) {
  const std::string stem = ::testing::TempDir() + "work_precision 'chart'\ntest";
  drawChart(sampleChart(), stem);
  for (const char* ending : {".svg", ".png"}) {
    EXPECT_GT(std::filesystem::file_size(stem + ending), 10000U);
    std::filesystem::remove(stem + ending);
  }
  EXPECT_THAT(chartCommands(sampleChart(), ChartFormat::png), Not(HasSubstr("\nset output")));
}

TEST(WorkPrecisionChart, ASceneThatNothingReachesTheEndOfHasNone) {
  const std::string stem = ::testing::TempDir() + "work_precision_chart_empty";
  drawChart({"none", {rowOf("rk4", 0.5, std::nan(""))}, {}, 1}, stem);
  EXPECT_FALSE(std::filesystem::exists(stem + ".png"));
}

}  // namespace
}  // namespace cradle
