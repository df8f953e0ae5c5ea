#include "core/console.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "core/error.h"
#include "core/interruption.h"

namespace cradle {
namespace {

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

/// Its standard files are closed when it begins.
[[noreturn]] void showWithoutFiles() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) close(file);
  fillStandardFiles();
  const int next = dup(STDIN_FILENO);
  if (next <= STDERR_FILENO) std::_Exit(1);
  showOn(STDOUT_FILENO);
}

TEST(ConsoleDeathTest, ClosedFilesGiveTheirNumbersToNoOther) {
  EXPECT_EXIT(showWithoutFiles(), testing::ExitedWithCode(static_cast<int>(ErrorKind::output)), "");
}

}  // namespace
}  // namespace cradle
