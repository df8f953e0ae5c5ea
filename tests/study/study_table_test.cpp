#include "study/study_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace cradle {
namespace {

constexpr const char* kHeader =
    "scene,engine,method,setting,error,cpu_seconds_per_simulated_second,evaluations,energy_drift,constraint_drift,"
    "penetration,status\n";

StudyRow goodRow() {
  StudyRow row;
  row.scene = "pendulum";
  row.method = "rk4";
  row.setting = 0.001;
  row.error = 2.5e-11;
  row.cpuSecondsPerSimulatedSecond = 0.0625;
  row.evaluations = 4000;
  row.energyDrift = 1e-9;
  row.constraintDrift = 0;
  row.penetration = 0;
  row.status = RunStatus::ok;
  return row;
}

std::string content(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(StudyTable, ARowHasTheContractedColumns) {
  EXPECT_EQ(tableLine(goodRow()), "pendulum,cradle,rk4,0.001,2.5e-11,0.0625,4000,1e-09,0,0,ok\n");
}

TEST(StudyTable, ARunWithoutAnEndHasNoNumbers) {
  StudyRow row;
  row.scene = "two, joined";
  row.method = "explicitEuler";
  row.setting = 0.5;
  row.status = RunStatus::unstable;
  EXPECT_EQ(tableLine(row), "\"two, joined\",cradle,explicitEuler,0.5,nan,nan,nan,nan,nan,nan,unstable\n");
}

TEST(StudyTable, RowsAreInThePartAtOnceAndInTheFileInTheEnd) {
  const std::string path = ::testing::TempDir() + "study_table_test.csv", part = path + ".part";
  std::filesystem::remove(path);
  {
    StudyTable table(path);
    table.append(goodRow());
    EXPECT_EQ(content(part), kHeader + tableLine(goodRow()));
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  EXPECT_EQ(content(part), kHeader + tableLine(goodRow()));
  StudyTable table(path);
  table.complete();
  EXPECT_EQ(content(path), kHeader);
  EXPECT_FALSE(std::filesystem::exists(part));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace cradle
