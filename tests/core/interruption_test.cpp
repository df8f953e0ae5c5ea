#include "core/interruption.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "core/error.h"

namespace cradle {
namespace {

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
