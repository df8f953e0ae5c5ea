#include "image/font.h"

#include <gtest/gtest.h>

#include <cmath>

#include "image/test_pictures.h"

namespace cradle {
namespace {

const Ink kInk{{250, 40, 10}, 1};

/// First and last column and row that differ, both included; {0, 0, -1, -1} if none does.
std::array<int, 4> changedBox(const Image& before, const Image& after) {
  std::array<int, 4> box = {before.width, before.height, -1, -1};
  for (int y = 0; y < before.height; ++y)
    for (int x = 0; x < before.width; ++x) {
      if (std::equal(before.at(x, y), before.at(x, y) + 3, after.at(x, y))) continue;
      box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
    }
  return box;
}

TEST(Font, InkLiesWhereTheFontHasIt) {
  // Capital H of DejaVu Sans: from 201 to 1338 of 2048 to the right, up to 1493, its advance 1540.
  for (const double em : {12.0, 23.0, 60.0})
    for (const double start : {20.0, 20.3, 20.5, 20.8}) {
      const TextSize size = crispTextSize(em);
      Image image(100, 80);
      Canvas canvas(image);
      drawText(canvas, "H", size, {start, start > 20.4 ? 69.6 : 70.4}, kInk);  // the baseline at 70
      const auto box = changedBox(Image(100, 80), image);
      EXPECT_EQ(box[0], std::floor(start + 201 * size.em / 2048)) << em << " " << start;
      EXPECT_EQ(box[1], std::floor(70 - 1493 * size.em / 2048)) << em << " " << start;
      EXPECT_EQ(box[2], std::ceil(start + 1338 * size.em / 2048) - 1) << em << " " << start;
      EXPECT_EQ(box[3], 69) << em << " " << start;
      EXPECT_NEAR(textWidth("H", size), 1540 * size.em / 2048, 1e-4);
      EXPECT_NEAR(size.ascent, 1493 * size.em / 2048, 1e-9);
    }
}

TEST(Font, NothingOutsideTheTextChanges) {
  const Image before = makeTestPicture(200, 60, 5);
  Image after = before;
  Canvas canvas(after);
  const TextSize size = crispTextSize(20);
  const std::string text = "Agj|Q 0.25 s";
  drawText(canvas, text, size, {30.4, 40}, kInk);
  const auto box = changedBox(before, after);
  EXPECT_GE(box[0], 30);
  EXPECT_LE(box[2], 31 + textWidth(text, size));
  EXPECT_GE(box[1], 40 - 1.3 * size.ascent);  // the bar is higher than capitals
  EXPECT_LE(box[3], 40 + std::ceil(size.descent));
}

TEST(Font, SmallLettersEndOnPixels) {
  for (double em = 8; em < 40; em += 1.7) {
    const double letters = crispTextSize(em).em * 1120 / 2048;
    EXPECT_NEAR(letters, std::round(letters), 1e-12);
    EXPECT_NEAR(crispTextSize(em).em, em, 2048.0 / 1120 / 2 + 1e-9);
  }
  EXPECT_NEAR(crispTextSize(0.1).em * 1120 / 2048, 1, 1e-12);  // a pixel at least
}

TEST(Font, InsideOfALetterHasTheInkItself) {
  Image image(60, 60);
  Canvas canvas(image);
  drawText(canvas, "I", crispTextSize(50), {10, 50}, kInk);
  // Capital I: a bar from 201 to 403 of 2048.
  const int x = static_cast<int>(10 + 302 * crispTextSize(50).em / 2048);
  EXPECT_EQ(std::vector<int>(image.at(x, 35), image.at(x, 35) + 3), (std::vector<int>{250, 40, 10}));
}

TEST(Font, LetterIsAsDarkAsItIsLarge) {
  // Capital I, a bar of 202 x 1493 of 2048: pixels at its edge take their share. Rounding to 1 of 255 levels is off by
  // up to half of the widest step in light, 0.009, in some 90 of them.
  Image image(60, 60);
  Canvas canvas(image);
  const TextSize size = crispTextSize(50);
  drawText(canvas, "I", size, {10.3, 50}, {{255, 255, 255}, 1});
  double light = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    const double c = image.pixels[i] / 255.0;
    light += c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  EXPECT_NEAR(light, 202 * 1493 * std::pow(size.em / 2048, 2), 0.4);
}

TEST(Font, NeighboursMoveTogetherAsTheFontWants) {
  const TextSize size = crispTextSize(30);
  EXPECT_LT(textWidth("AV", size), textWidth("A", size) + textWidth("V", size) - 1);
  EXPECT_EQ(textWidth("HH", size), 2 * textWidth("H", size));
}

TEST(Font, DigitsAreAllAsWide) {
  const TextSize size = crispTextSize(17);
  for (const char* digit : {"1", "4", "7", "9"}) EXPECT_EQ(textWidth(digit, size), textWidth("0", size));
}

TEST(Font, LongTextsAreCutToFit) {
  const TextSize size = crispTextSize(17);
  EXPECT_EQ(fittedText("short", size, textWidth("short", size)), "short");
  const std::string text = "r\xC3\xA9sum\xC3\xA9 of all that moves";
  EXPECT_EQ(fittedText(text, size, textWidth("r\xC3\xA9...", size)), "r\xC3\xA9...");
  EXPECT_EQ(fittedText(text, size, textWidth("r\xC3\xA9...", size) - 1), "r...");  // never half a character
  EXPECT_EQ(fittedText(text, size, 0), "...");
  // A long arrow is wider than the sign for half of it.
  const std::string arrow = "r\xE2\x9F\xB5s and more";
  EXPECT_EQ(fittedText(arrow, size, textWidth("r\xE2\x9F\xB5...", size) - 1), "r...");
}

TEST(Font, TextIsReadAsUtf8) {
  const TextSize size = crispTextSize(17);
  EXPECT_EQ(textWidth("\xC3\xA9", size), textWidth("e", size));                // e with an accent
  EXPECT_EQ(textWidth("\xCE\xBC", size), textWidth("\xC2\xB5", size));         // mu, and the sign for a millionth
  EXPECT_EQ(textWidth("\xE2\x88\x92", size), textWidth("+", size));            // minus
  EXPECT_GT(textWidth("\xF0\x9D\x94\xB8", size), 0);                           // four bytes
  for (const char* broken : {"\xFF", "\xC3", "\xE2\x82", "\x80", "\xF8\x88"})  // each a sign of its own, and no crash
    EXPECT_GE(textWidth(std::string("a") + broken, size), textWidth("a\xEF\xBF\xBD", size) - 1e-6);
}

TEST(Font, LacksAreNamed) {
  for (const char* text : {"", "Hello", "Größe ≤ 3 µm → ½ Ωж", "two\nlines\tand\x1f", "\xEF\xBF\xBD"})
    EXPECT_FALSE(lackedCharacter(text)) << text;
  EXPECT_EQ(lackedCharacter("a 漢字"), U'漢');
  EXPECT_EQ(lackedCharacter("\U0001F680"), U'\U0001F680');
}

TEST(Font, TextIsWrappedBetweenWordsAndInsideOfWideOnes) {
  const TextSize size = crispTextSize(20);
  const std::string text = "Some words that\nare  short, and Übergrößenträgerhülle too";
  for (const double width : {60.0, 100.0, 200.0, 5000.0}) {
    std::string joined;
    for (const std::string& line : wrappedText(text, size, width)) {
      EXPECT_LE(textWidth(line, size), width);
      EXPECT_FALSE(lackedCharacter(line)) << line;  // no character is broken
      joined += line;
    }
    std::erase(joined, ' ');
    EXPECT_EQ(joined, "Somewordsthatareshort,andÜbergrößenträgerhülletoo");
  }
  EXPECT_EQ(wrappedText(text, size, 5000).size(), 1u);
  EXPECT_EQ(wrappedText("abc", size, 1).size(), 3u);
  EXPECT_TRUE(wrappedText(" \n", size, 100).empty());
}

}  // namespace
}  // namespace cradle
