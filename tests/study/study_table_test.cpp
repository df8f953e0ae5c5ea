#include "study/study_table.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/csv_field.h"
#include "core/error.h"
#include "image/temporary_folder.h"
#include "study/growing_table.h"
#include "study/unfinished_study.h"

namespace cradle {
namespace {

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
  EXPECT_STREQ(kStudyColumns,
               "scene,engine,method,setting,error,cpu_seconds_per_simulated_second,evaluations,energy_drift,"
               "constraint_drift,penetration,status\n");
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

TEST(StudyTable, ItsLastLinesAreReplacedAndItGoesOn) {
  const TemporaryFolder folder;
  const std::string path = folder / "growing.csv";
  GrowingTable table(path, "columns\n");
  for (const char* line : {"one\n", "two\n", "three\n"}) table.append(line);
  table.replaceLast({"second\n", "3\n"});
  table.append("four\n");
  table.complete();
  EXPECT_EQ(content(path), "columns\none\nsecond\n3\nfour\n");
}

TEST(StudyTable, ALineReadsBackToTheSameRow) {
  StudyRow row = goodRow();
  row.scene = "a \"b\", c";
  row.error = 1.0 / 3;
  row.energyDrift = std::numeric_limits<double>::quiet_NaN();
  const CsvLines lines = csvLines(tableLine(row));
  const std::optional<StudyRow> read = rowOf(lines.lines.at(0));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene, row.scene);
  EXPECT_EQ(tableLine(*read), tableLine(row));
  EXPECT_FALSE(rowOf({"a", "b"}));
}

TEST(GrowingTable, LinesAreInThePartAtOnceAndInTheFileInTheEnd) {
  const TemporaryFolder folder;
  const std::string path = folder / "growing.csv", part = path + ".part";
  {
    GrowingTable table(path, "x,y\n");
    table.append("1,2\n");
    EXPECT_EQ(content(part), "x,y\n1,2\n");
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  GrowingTable table(path, "x,y\n", 4);
  table.append("3,4\n");
  table.complete();
  EXPECT_EQ(content(path), "x,y\n3,4\n");
  EXPECT_FALSE(std::filesystem::exists(part));
}

TEST(GrowingTableDeathTest, IsWrittenByOneAtATime) {
  const TemporaryFolder folder;
  const std::string path = folder / "growing.csv";
  GrowingTable table(path, "x,y\n");
  EXPECT_EXIT(
      {
        try {
          GrowingTable second(path, "x,y\n");
        } catch (const Error& error) {
          std::fputs(error.what(), stderr);
          std::_Exit(static_cast<int>(error.kind()));
        }
        std::_Exit(0);
      },
      testing::ExitedWithCode(static_cast<int>(ErrorKind::output)),
      "is being written by process " + std::to_string(getpid()));
  table.append("1,2\n");
  table.complete();
  EXPECT_EQ(content(path), "x,y\n1,2\n");
}

TEST(GrowingTable, FollowsNoLink) {
  const TemporaryFolder folder;
  std::ofstream(folder / "thesis.txt") << "chapter one";
  std::filesystem::create_symlink(folder / "thesis.txt", folder / "growing.csv.part");
  EXPECT_THROW(GrowingTable(folder / "growing.csv", "x,y\n"), Error);
  EXPECT_EQ(content(folder / "thesis.txt"), "chapter one");
}

/// What a study of the scenes `begun` leaves when it is stopped in the middle of a line.
void leaveInterruptedStudy(const TemporaryFolder& folder, const std::vector<StudyOrigin>& begun) {
  GrowingTable rows(folder / "unfinished.csv", kStudyColumns);
  GrowingTable references(folder / "unfinished_references.csv", kReferenceColumns);
  for (const StudyOrigin& origin : begun) {
    references.append(tableLine(ReferenceLine{origin, {{}, 2e-13, "DOP853, fine", "RK4 agrees"}}));
    StudyRow row = goodRow();
    row.scene = origin.scene;
    rows.append(tableLine(row));
  }
  rows.append("pendulum,cradle,rk4,0.00");
}

UnfinishedStudy readIn(const TemporaryFolder& folder, const std::vector<StudyOrigin>& origins) {
  return readUnfinishedStudy(folder / "unfinished.csv", folder / "unfinished_references.csv", origins);
}

TEST(UnfinishedStudy, HasTheRowsThatAreWhole) {
  const std::vector<StudyOrigin> scenes = {{"a", "1"}, {"b", "2"}, {"c", "3"}};
  const TemporaryFolder folder;
  leaveInterruptedStudy(folder, {scenes[0], scenes[1]});
  const UnfinishedStudy study = readIn(folder, scenes);
  ASSERT_EQ(study.rows.size(), 2U);
  EXPECT_TRUE(study.rows[0].isEarlier);
  EXPECT_EQ(study.rowsOf("b").size(), 1U);
  EXPECT_TRUE(study.hasFinished("a"));
  EXPECT_FALSE(study.hasFinished("b"));
  EXPECT_FALSE(study.hasFinished("c"));
  EXPECT_EQ(study.referenceOf("a")->reference.uncertainty, 2e-13);
  EXPECT_EQ(study.referenceOf("a")->reference.madeBy, "DOP853, fine");
  EXPECT_EQ(study.referenceOf("c"), nullptr);
}

TEST(UnfinishedStudy, OfOtherScenesOrAnotherProgramIsRefused) {
  const TemporaryFolder folder;
  leaveInterruptedStudy(folder, {{"a", "1"}, {"b", "2"}});
  for (const std::vector<StudyOrigin>& others : std::vector<std::vector<StudyOrigin>>{
           {{"a", "1"}}, {{"b", "2"}, {"a", "1"}}, {{"a", "1"}, {"b", "another"}}, {{"c", "1"}, {"b", "2"}}})
    EXPECT_THROW(readIn(folder, others), Error);
  EXPECT_NO_THROW(readIn(folder, {{"before", "0"}, {"a", "1"}, {"b", "2"}}));
}

// A pipe would be waited for, a device read without end.
TEST(UnfinishedStudy, IsReadFromFilesAlone) {
  const std::vector<StudyOrigin> scenes = {{"a", "1"}};
  for (const char* name : {"unfinished.csv.part", "unfinished_references.csv.part", "unfinished_references.csv"}) {
    const TemporaryFolder folder;
    leaveInterruptedStudy(folder, scenes);
    if (name == std::string("unfinished_references.csv"))
      std::filesystem::remove(folder / "unfinished_references.csv.part");
    const std::string path = folder / name;
    const auto expectRefused = [&](const char* what) {
      EXPECT_THROW(readIn(folder, scenes), Error) << name << ", " << what;
      std::filesystem::remove_all(path);
    };
    std::filesystem::remove_all(path);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    expectRefused("a pipe");
    std::filesystem::create_symlink("/dev/zero", path);
    expectRefused("a link");
    std::filesystem::create_directory(path);
    expectRefused("a folder");
    std::ofstream(path).close();
    std::filesystem::resize_file(path, 3'000'000'000);
    expectRefused("a large file");
  }
}

}  // namespace
}  // namespace cradle
