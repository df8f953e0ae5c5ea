#include "scene/draws.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "math/random_stream.h"

namespace cradle {
namespace {

JsonValue read(const std::string& text) {
  FaultList faults("scene.json", ErrorKind::scene);
  return readJson(text, faults);
}

/// The text of a tree in which every number that draws are made of is `share`.
std::string drawnText(const std::string& text, double share) {
  const UniformSource same = [share](const std::string&, std::size_t) { return share; };
  std::string line;
  for (const char byte : writeJson(drawn(read(text), same).document))
    if (byte != '\n' && byte != ' ') line += byte;
  return line;
}

std::string faultOf(const std::string& text) {
  FaultList faults("scene.json", ErrorKind::scene);
  checkDraws(read(text), faults);
  try {
    faults.throwIfAny();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Draws, UniformNumbersAndVectorsLieBetweenTheirEnds) {
  EXPECT_EQ(drawnText(R"({"a": {"draw": {"uniform": [1, 5]}}, "b": 7})", 0.25), R"({"a":2,"b":7})");
  EXPECT_EQ(drawnText(R"([{"draw": {"uniform": [[-1, 1, -1], [1, 2, 1]]}}])", 0.5), R"([[0,1.5,0]])");
}

TEST(Draws, NormalNumbersAreQuantiles) {
  EXPECT_EQ(drawnText(R"([{"draw": {"normal": [2, 0.1]}}])", 0.5), "[2]");
  const JsonValue document = read(R"([{"draw": {"normal": [2, 0.1]}}])");
  const DrawnDocument made = drawn(document, [](const std::string&, std::size_t) { return 0.975; });
  EXPECT_DOUBLE_EQ(std::get<double>(made.values.at(0).value.content), 2 + 0.1 * 1.959963984540054);
}

TEST(Draws, ChoicesHaveEqualSharesAndMayHaveDrawsInThem) {
  const std::string text = R"([{"draw": {"choice": ["a", {"draw": {"uniform": [0, 8]}}, [1], true]}}])";
  EXPECT_EQ(drawnText(text, 0.2499), R"(["a"])");
  EXPECT_EQ(drawnText(text, 0.25), "[2]");
  EXPECT_EQ(drawnText(text, 0.5), "[[1]]");
  EXPECT_EQ(drawnText(text, 0.9999), "[true]");
}

TEST(Draws, ElementsThatAreDrawnAsNullAreLeftOut) {
  EXPECT_EQ(drawnText(R"([1, {"draw": {"choice": [null, 2]}}, null, 3])", 0.1), "[1,null,3]");
  EXPECT_EQ(drawnText(R"([1, {"draw": {"choice": [null, 2]}}, null, 3])", 0.9), "[1,2,null,3]");
}

TEST(Draws, NumbersAreAskedForByThePlaceOfTheirDraw) {
  std::vector<std::string> places;
  const JsonValue document = read(
      R"({"x": {"draw": {"choice": [0, {"y/z": {"draw": {"uniform": [[0, 0], [1, 1]]}}}]}}, "o": {"draw": "rotation"}})");
  drawn(document, [&](const std::string& pointer, std::size_t index) {
    places.push_back(pointer + "#" + std::to_string(index));
    return 0.75;
  });
  EXPECT_THAT(places, testing::UnorderedElementsAre("/x#0", "/x/draw/choice/1/y~1z#0", "/x/draw/choice/1/y~1z#1",
                                                    "/o#0", "/o#1", "/o#2"));
}

TEST(Draws, BodiesKnowWhereTheyStandInTheFile) {
  const JsonValue document =
      read(R"({"bodies": [{"draw": {"choice": [null]}}, {"name": "a"}, {"draw": {"choice": [{"name": "b"}]}}]})");
  const DrawnDocument made = drawn(document, [](const std::string&, std::size_t) { return 0.5; });
  EXPECT_THAT(made.bodyOrigins, testing::ElementsAre("/bodies/1", "/bodies/2/draw/choice/0"));
}

// Of a rotation that is uniform, the image of an axis is uniform on the sphere: each of its coordinates is uniform in
// -1..1 (Archimedes), with mean square 1/3 and mean fourth power 1/5. n = 20000: standard deviations of the means are
// sqrt(4/45 / n) = 0.0021 and sqrt((1/9 - 1/25) / n) = 0.0019; and w^2 has the mean 1/4 with sqrt(1/16 / n) = 0.0018.
// Five of them are allowed.
TEST(Draws, RotationsAreUniform) {
  constexpr int kCount = 20'000;
  const JsonValue document = read(R"([{"draw": "rotation"}])");
  double square = 0, fourth = 0, scalar = 0, longest = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const RandomStream stream = RandomStream(5).at(i);
    const DrawnDocument made =
        drawn(document, [&](const std::string&, std::size_t index) { return stream.at(index).nextUniform(); });
    std::array<double, 4> q{};  // w, x, y, z
    const auto& members = std::get<JsonValue::Object>(made.values.at(0).value.content);
    for (std::size_t k = 0; k < 4; ++k) q[k] = std::get<double>(members.at(k).value.content);
    const double image = 2 * (q[1] * q[2] + q[0] * q[3]);  // y of the image of x
    square += image * image / kCount, fourth += std::pow(image, 4) / kCount, scalar += q[0] * q[0] / kCount;
    longest = std::max(longest, std::abs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1));
  }
  EXPECT_NEAR(square, 1.0 / 3, 5 * 0.0021);
  EXPECT_NEAR(fourth, 1.0 / 5, 5 * 0.0019);
  EXPECT_NEAR(scalar, 1.0 / 4, 5 * 0.0018);
  EXPECT_LT(longest, 1e-15);
}

TEST(Draws, WhatIsWrongWithThemIsSaidWithItsPlace) {
  using testing::HasSubstr;
  EXPECT_THAT(faultOf("[1,\n {\"draw\": {\"unifrom\": [0, 1]}}]"),
              HasSubstr("scene.json:2:12 /1/draw/unifrom: unknown key \"unifrom\""));
  EXPECT_THAT(faultOf(R"([{"draw": {"uniform": [1, 0]}}])"), HasSubstr("low <= high"));
  EXPECT_THAT(faultOf(R"([{"draw": {"uniform": [[0, 1], [0]]}}])"), HasSubstr("an array of 2 elements"));
  EXPECT_THAT(faultOf(R"([{"draw": {"normal": [1, -1]}}])"), HasSubstr("deviation from 0"));
  EXPECT_THAT(faultOf(R"([{"draw": {"choice": []}}])"), HasSubstr("at least one value"));
  EXPECT_THAT(faultOf(R"([{"draw": "rotations"}])"), HasSubstr("\"rotation\""));
  EXPECT_THAT(faultOf(R"([{"draw": {"uniform": [0, 1], "normal": [0, 1]}}])"), HasSubstr("2 distributions"));
  EXPECT_THAT(faultOf(R"([{"draw": {"uniform": [0, 1]}, "x": 1}])"), HasSubstr("unknown key \"x\""));
  EXPECT_THAT(faultOf(R"({"draw": {"choice": [1]}})"), HasSubstr("the scene as a whole"));
  EXPECT_EQ(faultOf(R"({"materials": {"draw": {"density": 1}}})"), "");
}

}  // namespace
}  // namespace cradle
