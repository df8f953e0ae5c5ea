#include "core/printable.h"

#include <gtest/gtest.h>

namespace cradle {
namespace {

TEST(Printable, ShowsTextAsItIs) {
  const std::string text = "m/s², 3 × \"a\"\n\u65e5\U0001F600~";
  EXPECT_EQ(printable(text), text);
}

TEST(Printable, ShowsWhatATerminalWouldObeyAsNumbers) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(printable("a\rb\tc\x7f\b"), "a\\x0db\\x09c\\x7f\\x08");
  EXPECT_EQ(printable("\u009b31m"), "\\xc2\\x9b31m");  // control sequence introducer, one character of Latin-1
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
}

TEST(Printable, ShowsWhatIsNoUtf8AsNumbers) {
  EXPECT_EQ(printable("caf\xe9 x"), "caf\\xe9 x");                 // Latin-1
  EXPECT_EQ(printable("\xc3"), "\\xc3");                           // cut off
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");                  // 0x1b, written longer than it is
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");         // half of a surrogate pair
  EXPECT_EQ(printable("\xf4\x90\x80\x80").substr(0, 4), "\\xf4");  // beyond the last character
  EXPECT_EQ(printable("\x80\xff"), "\\x80\\xff");
}

TEST(Printable, ShowsWhatTurnsOrHidesTextAsNumbers) {
  EXPECT_EQ(printable("a\u202eb"), "a\\xe2\\x80\\xaeb");
  EXPECT_EQ(printable("\ufeffx"), "\\xef\\xbb\\xbfx");
  EXPECT_EQ(printable("\u2028"), "\\xe2\\x80\\xa8");
  EXPECT_EQ(printable("a\u200bb"), "a\\xe2\\x80\\x8bb");             // no width
  EXPECT_EQ(printable("a\u00adb"), "a\\xc2\\xadb");                  // a hyphen that shows at the end of a line alone
  EXPECT_EQ(printable("\U000e0041"), "\\xf3\\xa0\\x81\\x81");        // tag
  EXPECT_EQ(printable("\u0646\u200c\u0647"), "\u0646\u200c\u0647");  // between letters that would join
}

TEST(Printable, LinesAreOneAndEnd) {
  EXPECT_EQ(printable("a\nb"), "a\nb");
  EXPECT_EQ(printableLine("a\nb"), "a\\x0ab");
  EXPECT_EQ(printableLine("abcdef", 4), "abcd...");
  EXPECT_EQ(printableLine("abc\u00e9f", 4), "abc\u00e9...");  // no character is cut
  EXPECT_EQ(printableLine("abcd", 4), "abcd");
}

}  // namespace
}  // namespace cradle
