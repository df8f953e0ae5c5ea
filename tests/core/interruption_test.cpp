#include "core/interruption.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "core/error.h"
#include "core/worker_threads.h"

namespace cradle {
namespace {

// The innermost watch of a thread is asked, and none when it is gone.
TEST(InterruptionWatch, EndsWorkByWhatItThrows) {
  int looks = 0;
  {
    const InterruptionWatch outer([&] { throw 1; });
    {
      const InterruptionWatch inner([&] { ++looks; });
      throwIfInterrupted();
    }
    EXPECT_THROW(throwIfInterrupted(), int);
  }
  throwIfInterrupted();
  EXPECT_EQ(looks, 1);
}

// A helper ends once the watch has thrown in the thread that gave the task, and by the same; it does not ask itself.
TEST(InterruptionWatch, EndsHelpersToo) {
  WorkerThreads threads(2);
  std::atomic<bool> isOver = false;
  std::atomic<int> looks = 0, thrown = 0;
  const std::thread::id caller = std::this_thread::get_id();
  const InterruptionWatch watch([&] {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    ++looks;
    throw 7;
  });
  const auto task = [&](int thread) {
    try {
      while (thread == 1 && !isOver) throwIfInterrupted();
      throwIfInterrupted();
    } catch (int number) {
      thrown += number;
      isOver = true;
    }
  };
  threads.run(task);
  EXPECT_EQ(thrown, 14);
  EXPECT_EQ(looks, 1);
}

// Each in a process of its own: a noted signal stays noted.

TEST(InterruptionDeathTest, FirstSignalIsNotedAndThrownWhereItSuits) {
  EXPECT_EXIT(
      {
        noteInterruptions();
        if (interruptingSignal() != 0) std::_Exit(2);
        std::raise(SIGTERM);
        if (interruptingSignal() != SIGTERM) std::_Exit(3);
        try {
          throwIfInterrupted();
        } catch (const Error& error) {
          std::_Exit(error.kind() == ErrorKind::interrupted ? 0 : 4);
        }
        std::_Exit(5);
      },
      testing::ExitedWithCode(0), "");
}

TEST(InterruptionDeathTest, SecondSignalEndsAtOnce) {
  EXPECT_EXIT(
      {
        noteInterruptions();
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::KilledBySignal(SIGINT), "");
}

TEST(InterruptionDeathTest, WorkThatDoesNotLookIsEnded) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    EXPECT_EXIT(
        {
          noteInterruptions();
          std::raise(signal);
          sleep(60);
          std::_Exit(2);
        },
        testing::ExitedWithCode(128 + signal), "interrupted|terminated|hung up");
}

TEST(InterruptionDeathTest, NoticedSignalLeavesTimeToTidyUp) {
  EXPECT_EXIT(
      {
        noteInterruptions();
        std::raise(SIGTERM);
        try {
          throwIfInterrupted();
        } catch (const Error&) {
          std::_Exit(alarm(0) == 0 ? 0 : 2);  // none was set
        }
      },
      testing::ExitedWithCode(0), "");
}

TEST(InterruptionDeathTest, HangUpIsIgnoredUnderNohup) {
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_IGN);
        noteInterruptions();
        std::raise(SIGHUP);
        std::_Exit(interruptingSignal());
      },
      testing::ExitedWithCode(0), "");
}

TEST(InterruptionDeathTest, BrokenPipeDoesNotEndTheProgram) {
  EXPECT_EXIT(
      {
        noteInterruptions();
        std::raise(SIGPIPE);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace cradle
