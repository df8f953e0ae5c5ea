#include "image/child_process.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include "core/error.h"
#include "core/interruption.h"

namespace cradle {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> shell(const std::string& script) {
  return {"/bin/sh", "-c", script};
}

ErrorKind failureOfWriting(ChildProcess& process) {
  const std::vector<char> bytes(10'000'000);  // more than a pipe takes
  try {
    process.write(bytes.data(), bytes.size());
  } catch (const Error& error) {
    return error.kind();
  }
  return ErrorKind::different;
}

TEST(ChildProcess, ThatReadsNothingIsSaidToHang) {
  ChildProcess process({"sleep", "1000"}, {}, 300ms);
  EXPECT_EQ(failureOfWriting(process), ErrorKind::encoder);
}

TEST(ChildProcess, ThatDoesNotEndIsSaidToHang) {
  ChildProcess process({"sleep", "1000"}, {}, 300ms);
  EXPECT_THROW(process.finish(), Error);
}

TEST(ChildProcess, ThatWorksIsWaitedForThoughAnotherDoesIt) {
  // The shell waits for a second one, which counts: a second or so, with a patience of tenths.
  ChildProcess process(shell("sh -c 'i=0; while [ $i -lt 1500000 ]; do i=$((i+1)); done'; exit 7"), {}, 300ms);
  EXPECT_EQ(process.finish(), 7);
}

TEST(ChildProcess, EndsWithAllThatItHasStarted) {
  pid_t second = 0;
  {
    ChildProcess process(shell("sleep 1000 & echo $!; wait"));
    while (process.standardOutput().find('\n') == std::string::npos) std::this_thread::sleep_for(1ms);
    second = std::stoi(process.standardOutput());
    ASSERT_EQ(kill(second, 0), 0);
  }
  // Killed, it is gone once whoever has inherited it has taken note.
  for (int turn = 0; turn < 5000 && kill(second, 0) == 0; ++turn) {
    std::ifstream status("/proc/" + std::to_string(second) + "/stat");
    std::string number, name, state;
    if (status >> number >> name >> state && state == "Z") return;
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_NE(kill(second, 0), 0);
}

TEST(ChildProcessDeathTest, CrashEndsItToo) {
  // A pipe that this process alone holds open at its end: it closes when that is no more.
  std::array<int, 2> ends;
  ASSERT_EQ(pipe(ends.data()), 0);
  EXPECT_EXIT(
      {
        noteCrashes();
        close(ends[0]);
        const ChildProcess process(shell("exec 2>&-; sleep 1000"));
        std::raise(SIGSEGV);
      },
      testing::KilledBySignal(SIGSEGV), "");
  close(ends[1]);
  pollfd closed{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&closed, 1, 10'000), 1);
  close(ends[0]);
}

TEST(ChildProcessDeathTest, SignalEndsTheWaiting) {
  EXPECT_EXIT(
      {
        noteInterruptions();
        std::optional<ChildProcess> process(std::in_place, std::vector<std::string>{"sleep", "1000"});
        std::raise(SIGTERM);
        const ErrorKind kind = failureOfWriting(*process);
        process.reset();
        std::_Exit(kind == ErrorKind::interrupted ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace cradle
