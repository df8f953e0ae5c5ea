// Damaged scene files: whatever happens to the text, the answer is a scene or an Error, and every fault has a place
// inside the text. The damage is random but the same in every run.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

using Random = std::mt19937;  // its numbers are fixed by the standard; those of distributions are not

std::size_t below(std::size_t limit, Random& random) {
  return random() % limit;
}

void damageByte(std::string& text, Random& random) {
  text[below(text.size(), random)] = static_cast<char>(random() & 0xFFU);
}

void removePart(std::string& text, Random& random) {
  const std::size_t at = below(text.size(), random);
  text.erase(at, below(20, random));
}

void repeatPart(std::string& text, Random& random) {
  const std::size_t from = below(text.size(), random);
  const std::string part = text.substr(from, below(200, random));
  text.insert(below(text.size(), random), part);
}

void insertToken(std::string& text, Random& random) {
  static const std::vector<std::string> tokens{
      "{",  "}",  "[",  "]",       ",",     ":",        "\"",   "null", "true", "-1", "0",  "1e308", "1e-320",
      "//", "/*", "*/", "\\u0000", "1e999", "\"name\"", "[[[[", "{}",   "[]",   "-",  "\n", "NaN",   "4294967297"};
  const std::size_t at = below(text.size(), random);
  text.insert(at, tokens[below(tokens.size(), random)]);
}

// Numbers are where a text that is still JSON goes wrong.
void replaceNumber(std::string& text, Random& random) {
  static const std::vector<std::string> numbers{"0", "-1", "1e300", "1e-300", "0.5", "1e9", "3", "-0.0", "17", "2e5"};
  const std::size_t digit = text.find_first_of("0123456789", below(text.size(), random));
  if (digit == text.npos) return;
  const std::size_t end = text.find_first_not_of("0123456789.eE+-", digit);
  text.replace(digit, end - digit, numbers[below(numbers.size(), random)]);
}

using Damage = void (*)(std::string&, Random&);
constexpr Damage kDamages[] = {damageByte,    removePart,    repeatPart,   insertToken,
                               replaceNumber, replaceNumber, replaceNumber};

// Each line starts with "scenes/test.json:LINE:COLUMN", and the text has that line.
void expectPlacesInside(const std::string& message, const std::string& text) {
  const long lines = 1 + std::count(text.begin(), text.end(), '\n');
  std::istringstream input(message);
  for (std::string line; std::getline(input, line);) {
    if (line.starts_with("and ") && line.ends_with(" more")) continue;
    const std::string start = "scenes/test.json:";
    ASSERT_TRUE(line.starts_with(start)) << message;
    const long number = std::stol(line.substr(start.size()));
    ASSERT_TRUE(number >= 1 && number <= lines) << message;
  }
}

class Fuzz : public testing::TestWithParam<unsigned> {};

TEST_P(Fuzz, DamagedScenesAreScenesOrErrors) {
  Random random(GetParam());
  const std::string intact = everyKey();
  int scenes = 0;
  for (int round = 0; round < 400; ++round) {
    std::string text = intact;
    for (std::size_t count = 1 + below(4, random); count > 0; --count)
      kDamages[below(std::size(kDamages), random)](text, random);
    try {
      parse(text);
      ++scenes;
    } catch (const Error& error) {
      EXPECT_TRUE(error.kind() == ErrorKind::scene || error.kind() == ErrorKind::mesh);
      expectPlacesInside(error.what(), text);
    }
  }
  EXPECT_GT(scenes, 0);    // some damage is harmless,
  EXPECT_LT(scenes, 300);  // most is not
}

INSTANTIATE_TEST_SUITE_P(Seeds, Fuzz, testing::Range(1U, 11U));

}  // namespace
}  // namespace cradle
