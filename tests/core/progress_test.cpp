#include "core/progress.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <thread>

namespace cradle {
namespace {

using testing::HasSubstr;

void countToThree(bool quiet) {
  Progress progress("simulating", "frames", 3, quiet);
  for (long frame = 1; frame <= 3; ++frame) progress.update(frame);
}

// What `work` writes to a stderr that is a terminal.
std::string onTerminal(const std::function<void()>& work) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  EXPECT_TRUE(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
  const int terminal = open(ptsname(master), O_RDWR | O_NOCTTY), before = dup(STDERR_FILENO);
  dup2(terminal, STDERR_FILENO);
  work();
  dup2(before, STDERR_FILENO);
  for (const int file : {before, terminal}) close(file);
  std::string text;
  char piece;
  while (read(master, &piece, 1) == 1) text += piece;  // until all is read from a terminal that is closed
  close(master);
  return text;
}

TEST(Progress, EndsWithWhatWasDoneOnATerminal) {
  EXPECT_THAT(onTerminal([] { countToThree(false); }), HasSubstr("simulating: 3 frames in 0:00\r\n"));
}

TEST(Progress, ShowsHowFarTheNextOneHasCome) {
  const std::string text = onTerminal([] {
    Progress progress("simulating", "frames", 3, false);
    progress.update(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    progress.showTime(0.25);
    progress.showTime(0.5);  // too soon
  });
  EXPECT_THAT(text, HasSubstr("simulating: 1/3 frames, 0.25 s simulated, 0:00 left\r\n"));
}

TEST(Progress, IsSilentWhenQuiet) {
  EXPECT_EQ(onTerminal([] { countToThree(true); }), "");
}

TEST(Progress, ShortWorkLeavesLogsAlone) {
  testing::internal::CaptureStderr();
  countToThree(false);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// On a terminal that is closed before the first line.
[[noreturn]] void countWithoutReader() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) std::_Exit(1);
  dup2(open(ptsname(master), O_RDWR | O_NOCTTY), STDERR_FILENO);
  Progress progress("simulating", "frames", 3, false);
  close(master);
  progress.update(3);
  progress.endLine();
  std::_Exit(0);
}

TEST(ProgressDeathTest, WhatCannotBeToldIsLost) {
  EXPECT_EXIT(countWithoutReader(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace cradle
