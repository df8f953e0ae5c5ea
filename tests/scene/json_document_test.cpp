// What is no JSON, and where. In the texts an @ marks the place of the fault; it is taken out before they are read.

#include "scene/json_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct SyntaxFault {
  std::string text, pointer, words;
};

const std::vector<SyntaxFault> kSyntaxFaults{
    {"@", "", "ends too early"},
    {" \n // nothing\n@", "", "ends too early"},
    {"{} @x", "", "no JSON"},
    {"@[]", "", "an array of 0 elements; allowed is an object"},
    {"@7", "", "the number 7; allowed is an object"},
    {"{\"a\": @NaN}", "/a", "\"NaN\" is no number of JSON; numbers must be finite"},
    {"{\"a\": @-Infinity}", "/a", "\"-Infinity\" is no number"},
    {"{\"a\":\n[0, @1e999]}", "/a/0", "\"1e999\" is too large"},
    {"{\"a\": @-1e999 }", "/a", "\"-1e999\" is too large"},
    {"{\"a\": [1,\n 2, @]}", "/a/1", "comma stands before a closing bracket"},
    {"{\"a\": 1, @}", "/a", "comma stands before a closing bracket"},
    {"{\"a\": @'x'}", "/a", "double quotes"},
    {"{\"a\": [1, [2@", "/a/1/0", "the bracket at 1:11 is not closed"},
    {"{\"a\" @1}", "/a", "no JSON"},
    {"{\"a\": 1 @\"b\": 2}", "/a", "no JSON"},
    {"{\"a\": @.5}", "/a", "no JSON"},
    {"{\"a\": @+5}", "/a", "no JSON"},
    {"{\"a\": @01}", "/a", "\"01\""},
    {"{\"a\": @0x10, \"b\": 1}", "/a", "\"0x10\""},
    {"{\"a\": [1, @9.81m]}", "/a/1", "\"9.81m\""},
    {"{\"a\": @1.5.2}", "/a", "\"1.5.2\""},
    {"{\"a\": @truex}", "/a", "\"truex\""},
    {"{\"a\": [1@}", "/a/0", "no JSON"},
    {"{\"a\": @\"never closed}", "/a", "missing closing quote"},
    {"{\"a\": @\"line\nbreak\"}", "/a", "control character"},
    {"{\"a\": @\"\\q\"}", "/a", "invalid string"},
    {"{} @/ 1", "", "comment"},
    {"{\"a\": 1 @/* no end ", "/a", "a comment has no end"},
    {"{\"\xC3\xA4\": \"\xE2\x82\xAC@\xFF\"}", "/\xC3\xA4", "UTF-8"},
    {"{\"a\": \"\xC3@\"}", "/a", "UTF-8"},
    {"@\xFF\xFE{", "", "no JSON"},
    {std::string("{}@\0{", 5), "", "NUL"},
};

TEST(Json, WhatItIsNotIsReportedAtItsPlace) {
  for (const SyntaxFault& fault : kSyntaxFaults) {
    const Error error = errorOf(unmarked(fault.text));
    const std::string where = "scenes/test.json:" + markedPlace(fault.text) + (fault.pointer.empty() ? "" : " ");
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    EXPECT_THAT(error.what(), StartsWith(where + fault.pointer + ": ")) << fault.text;
    EXPECT_THAT(error.what(), HasSubstr(fault.words)) << fault.text;
  }
}

TEST(Json, EveryBeginningOfASceneIsAnError) {
  const std::string text = everyKey();
  for (std::size_t length = 0; length + 2 < text.size(); ++length) {
    EXPECT_EQ(errorOf(text.substr(0, length)).kind(), ErrorKind::scene) << length;
  }
}

TEST(Json, ValuesKnowTheirPlaces) {
  FaultList faults("f", ErrorKind::scene);
  const JsonValue root = readJson(
      "\xEF\xBB\xBF{\"\xC3\xA4\\\"\": /* , */ [1,// :\n \"\xE2\x82\xAC\", true,null,-2e3,{}]\r\n, \"b\": {}}", faults);
  EXPECT_EQ(faults.count(), 0U);
  const auto& members = std::get<JsonValue::Object>(root.content);
  ASSERT_EQ(members.size(), 2U);
  EXPECT_EQ(members[0].key, "\xC3\xA4\"");
  EXPECT_EQ(members[0].place.column, 2U);
  EXPECT_EQ(members[1].place.line, 3U);
  EXPECT_EQ(members[1].place.column, 3U);
  const auto& items = std::get<JsonValue::Array>(members[0].value.content);
  ASSERT_EQ(items.size(), 6U);
  const std::uint32_t columns[] = {18, 2, 7, 12, 17, 22};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(items[i].place.line, i == 0 ? 1U : 2U);
    EXPECT_EQ(items[i].place.column, columns[i]) << i;
  }
  EXPECT_EQ(std::get<double>(items[4].content), -2000);
}

TEST(Json, NestsAtMost64Levels) {
  const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  FaultList faults("f", ErrorKind::scene);
  EXPECT_NO_THROW(readJson(nested(64), faults));
  EXPECT_THROW(readJson(nested(65), faults), Error);
  EXPECT_THAT(errorOf(std::string(100000, '[')).what(),
              StartsWith("scenes/test.json:1:65: brackets nest deeper than 64"));
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  EXPECT_THAT(errorOf(objects).what(), HasSubstr("brackets nest deeper than 64"));
}

TEST(Json, IsAtMost64MegabytesLong) {
  EXPECT_THAT(errorOf(std::string(kLongestText + 1, ' ')).what(), HasSubstr("64000001 bytes; at most 64 MB"));
}

TEST(Json, ArraysHaveAtMostAMillionElements) {
  std::string zeros;
  for (int i = 0; i < 1000000; ++i) zeros += "0,";
  EXPECT_THAT(errorOf(sceneWith("\"bodies\": [" + zeros + "0]")).what(), HasSubstr("bodies has 1000001 elements"));
}

TEST(Json, NumbersHaveAnEnd) {
  const std::string digits(999'998, '1');
  EXPECT_THAT(errorOf("{\"a\": 0." + digits + "1}").what(), HasSubstr("a word of more than 1000000 characters"));
  EXPECT_THAT(errorOf("{\"a\": 0." + digits + "}").what(), Not(HasSubstr("a word of more")));
}

TEST(Json, CommentsAndBlanksArePassedOver) {
  const std::string blanks(200'000, '\n'), comment = "/* \" [ \xff" + blanks + "*/ // \"{\n";
  EXPECT_NO_THROW(parse("{" + blanks + comment + everyKey().substr(everyKey().find('{') + 1) + comment));
  EXPECT_THAT(errorOf("{\"a\": " + comment + " x").what(), HasSubstr("200002:2 /a: this is no JSON"));
  EXPECT_THAT(errorOf("{\"a\": " + blanks + " x").what(), HasSubstr("200001:2 /a: this is no JSON"));
  EXPECT_THAT(errorOf("{\"a\": /*/" + blanks).what(), HasSubstr("1:7 /a: a comment has no end"));
  FaultList faults("f", ErrorKind::scene);
  const JsonValue text = readJson("[\"/* // \\\" \\t/*\"]", faults);
  EXPECT_EQ(std::get<std::string>(std::get<JsonValue::Array>(text.content)[0].content), "/* // \" \t/*");
}

TEST(Json, DuplicateKeysAreFoundAtAnyDepth) {
  EXPECT_THAT(errorOf("{\"a\": [{\"b\": {}, \"b\": 1}]}").what(), HasSubstr("1:18 /a/0/b: duplicate key \"b\""));
}

TEST(Json, ObjectsHaveAtMostTenThousandKeys) {
  std::string keys;
  for (int i = 0; i < 10'001; ++i) keys += (i == 0 ? "\"k" : ", \"k") + std::to_string(i) + "\": 0";
  EXPECT_THAT(errorOf("{" + keys + "}").what(), HasSubstr("an object of more than 10000 keys"));
}

TEST(Json, HasAtMostFourMillionValues) {
  const auto repeated = [](const std::string& text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += text;
    return all;
  };
  const std::string most = "[" + repeated("0,", 3'999'997) + "{\"key\": ";  // the last value is yet to come
  EXPECT_THAT(errorOf(most + "}]").what(), Not(HasSubstr("values")));
  EXPECT_THAT(errorOf(most + "0, \"k\": \"v\"}]").what(), HasSubstr("more than 4000000 values"));
  EXPECT_THAT(errorOf("[" + repeated("[],", 4'000'000) + "[]]").what(), HasSubstr("1:11999999: the text has more"));
  EXPECT_THAT(errorOf("a," + repeated("0,", 4'000'000)).what(), HasSubstr("no JSON"));
}

TEST(Json, NumbersAreReadAsTheyWereWritten) {
  for (const double number : {0.0, -0.0, 1.0, -7.0, 0.1, 1e300, 4.9e-324, 9007199254740993.0}) {
    FaultList faults("f", ErrorKind::scene);
    const JsonValue written{{}, JsonValue::Object{{"a", {}, JsonValue{{}, number}}}};
    const JsonValue read = readJson(writeJson(written), faults);
    const double again = std::get<double>(std::get<JsonValue::Object>(read.content)[0].value.content);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(again), std::bit_cast<std::uint64_t>(number)) << number;
  }
}

}  // namespace
}  // namespace cradle
