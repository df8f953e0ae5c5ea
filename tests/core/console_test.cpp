#include "core/console.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "core/error.h"
#include "core/interruption.h"

namespace cradle {
namespace {

TEST(Console, ShowsTextAsItIs) {
  const std::string text = "m/s², 3 × \"a\"\n\u65e5\U0001F600~";
  EXPECT_EQ(printable(text), text);
}

TEST(Console, ShowsWhatATerminalWouldObeyAsNumbers) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(printable("a\rb\tc\x7f\b"), "a\\x0db\\x09c\\x7f\\x08");
  EXPECT_EQ(printable("\u009b31m"), "\\xc2\\x9b31m");  // control sequence introducer, one character of Latin-1
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
}

TEST(Console, ShowsWhatIsNoUtf8AsNumbers) {
  EXPECT_EQ(printable("caf\xe9 x"), "caf\\xe9 x");             // Latin-1
  EXPECT_EQ(printable("\xc3"), "\\xc3");                       // cut off
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");              // 0x1b, written longer than it is
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");     // half of a surrogate pair
  EXPECT_EQ(printable("\xf4\x90\x80\x80").substr(0, 4), "\\xf4");  // beyond the last character
  EXPECT_EQ(printable("\x80\xff"), "\\x80\\xff");
}

/// Its standard output is `file`, and what is shown there is all written. Exits with the kind of the error.
[[noreturn]] void showOn(int file) {
  noteInterruptions();
  dup2(file, STDOUT_FILENO);
  try {
    show("{}\n", "text");
    flushOutput();
  } catch (const Error& error) {
    std::_Exit(static_cast<int>(error.kind()));
  }
  std::_Exit(0);
}

TEST(ConsoleDeathTest, ReaderThatGoesIsNoFault) {
  std::array<int, 2> ends;
  ASSERT_EQ(pipe(ends.data()), 0);
  close(ends[0]);
  EXPECT_EXIT(showOn(ends[1]), testing::ExitedWithCode(0), "");
  close(ends[1]);
}

TEST(ConsoleDeathTest, FullDiskIsOne) {
  std::FILE* full = std::fopen("/dev/full", "w");
  EXPECT_EXIT(showOn(fileno(full)), testing::ExitedWithCode(static_cast<int>(ErrorKind::output)), "");
  std::fclose(full);
}

}  // namespace
}  // namespace cradle
