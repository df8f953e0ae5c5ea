// Each kind of fault: its exact place, its pointer, and the words that tell the user what to do. The cases are in
// scene_cases.txt.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "scene/scene_cases.h"
#include "scene/scene_texts.h"

namespace cradle {

void PrintTo(const SceneCase& sceneCase, std::ostream* out) {
  *out << sceneCase.text;
}

namespace {

using testing::EndsWith;
using testing::HasSubstr;

std::vector<SceneCase> casesThatAre(bool valid) {
  std::vector<SceneCase> cases = readSceneCases(CRADLE_SOURCE_DIR "/tests/scene/scene_cases.txt");
  std::erase_if(cases, [valid](const SceneCase& sceneCase) { return sceneCase.isValid != valid; });
  return cases;
}

class Fault : public testing::TestWithParam<SceneCase> {};

TEST_P(Fault, IsReportedOnceAtItsPlace) {
  const SceneCase& fault = GetParam();
  ASSERT_NE(fault.text.find('@'), std::string::npos) << fault.text;
  const Error error = errorOf(unmarked(fault.text));
  const std::string message = error.what();
  EXPECT_EQ(error.kind(), ErrorKind::scene) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << "more than one fault:\n" << message;
  const std::string where =
      "scenes/test.json:" + markedPlace(fault.text) + (fault.pointer.empty() ? "" : " ") + fault.pointer + ": ";
  EXPECT_EQ(message.substr(0, where.size()), where) << message;
  for (const std::string& word : fault.words) EXPECT_THAT(message, HasSubstr(word));
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, Fault, testing::ValuesIn(casesThatAre(false)));

class ValidScene : public testing::TestWithParam<SceneCase> {};

TEST_P(ValidScene, IsAcceptedAndWarnsWhereItShould) {
  LoadedScene loaded;
  ASSERT_NO_THROW(loaded = parse(GetParam().text)) << errorOf(GetParam().text).what();
  if (GetParam().warning.empty()) return;
  EXPECT_THAT(loaded.warnings, testing::ElementsAre(HasSubstr(GetParam().warning)));
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, ValidScene, testing::ValuesIn(casesThatAre(true)));

TEST(Faults, AreCountedBeyondFifty) {
  std::string members = "\"bodies\": []";
  for (int i = 0; i < 60; ++i) members += ",\n\"unknown" + std::to_string(i) + "\": 0";
  std::istringstream lines(errorOf(sceneWith(members)).what());
  std::string line;
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_THAT(line, HasSubstr(":" + std::to_string(3 + i) + ":1 /unknown" + std::to_string(i) + ": unknown key"));
  }
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "and 10 more");
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(Faults, StandInTheOrderOfTheFile) {
  const std::string message =
      errorOf(R"({"x": 0, "bodies": [{"name": "a"}], "duration": -1, "name": "n", "schema": 1})").what();
  const std::size_t unknown = message.find("unknown key"), shape = message.find("shape"),
                    duration = message.find("/duration"), schema = message.find("/schema");
  EXPECT_LT(unknown, shape);
  EXPECT_LT(shape, duration);
  EXPECT_LT(duration, schema);
  EXPECT_NE(schema, std::string::npos);
}

/// One key is meant for one that is missing: a second one stays a fault of its own, as does what else is missing.
TEST(Faults, OfAKeyThatIsMissingAreAsManyAsThereAre) {
  std::istringstream lines(
      errorOf(R"({"schema": "cradle-scene/1", "durration": 1, "dduration": 1, "bodies": []})").what());
  std::vector<std::string> found;
  for (std::string line; std::getline(lines, line);) found.push_back(line);
  EXPECT_THAT(found, UnorderedElementsAre(HasSubstr("\"name\" is missing"), HasSubstr("unknown key \"durration\""),
                                          HasSubstr("unknown key \"dduration\"")));
}

TEST(Faults, QuotationsAreCutAndHarmless) {
  const std::string message =
      errorOf(sceneWith("\"bodies\": [], \"a\\u001b[31m\\n" + std::string(1000, 'x') + "\": 1")).what();
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_EQ(message.find('\n'), std::string::npos);
  EXPECT_LT(message.size(), 1000U);
}

TEST(Faults, EndTheReadingAtAThousand) {
  std::string zeros = "0";
  for (int i = 1; i < 2000; ++i) zeros += ",0";
  EXPECT_THAT(errorOf(sceneWith("\"bodies\": [" + zeros + "]")).what(), EndsWith("and at least 950 more"));
}

}  // namespace
}  // namespace cradle
