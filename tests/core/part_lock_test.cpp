#include "core/part_lock.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/crash.h"
#include "core/error.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

class PartLockDeathTest : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(path_) << "of an earlier run"; }
  void TearDown() override {
    std::ifstream file(path_);
    std::string kept;
    std::getline(file, kept);
    EXPECT_EQ(kept, "of an earlier run");
    EXPECT_FALSE(fs::exists(path_ + ".part"));
    fs::remove(path_);
  }

  std::string path_ = testing::TempDir() + "part_lock_" + std::to_string(getpid());
};

TEST_F(PartLockDeathTest, CrashLeavesNoPart) {
  for (const int signal : {SIGSEGV, SIGABRT})
    EXPECT_EXIT(
        {
          noteCrashes();
          const PartLock lock(path_);
          if (!fs::exists(path_ + ".part")) std::_Exit(2);
          std::raise(signal);
        },
        testing::KilledBySignal(signal), "crashed, perhaps for lack of memory");
}

TEST_F(PartLockDeathTest, FailedCheckLeavesNoPart) {
  EXPECT_THROW(
      {
        const PartLock lock(path_);
        CRADLE_CHECK(!fs::exists(path_ + ".part"));
      },
      FailedCheck);
  EXPECT_FALSE(fs::exists(path_ + ".part"));
}

TEST_F(PartLockDeathTest, CrashLeavesFinishedFilesAndThoseOfOthers) {
  EXPECT_EXIT(
      {
        noteCrashes();
        const std::string done = path_ + "_done";
        for (int i = 0; i < 20; ++i) PartLock(done).finish();  // more than are kept in mind at once
        std::ofstream(done + ".part") << "of another";
        std::raise(SIGSEGV);
      },
      testing::KilledBySignal(SIGSEGV), "");
  EXPECT_TRUE(fs::remove(path_ + "_done"));
  EXPECT_TRUE(fs::remove(path_ + "_done.part"));
}

TEST(PartLock, NamesOfPartsAreNoOutputs) {
  EXPECT_THROW(PartLock(testing::TempDir() + "a.sqlite.part"), Error);
}

TEST(PartLock, WriterIsNamed) {
  const std::string path = testing::TempDir() + "part_lock_held_" + std::to_string(getpid());
  const PartLock lock(path);
  EXPECT_NO_THROW(requireNoWriter(path + ".none"));
  EXPECT_EXIT(
      {
        try {
          requireNoWriter(path + ".part");
        } catch (const Error& error) {
          std::fputs(error.what(), stderr);
          std::_Exit(static_cast<int>(error.kind()));
        }
        std::_Exit(0);
      },
      testing::ExitedWithCode(static_cast<int>(ErrorKind::output)), "process " + std::to_string(getpid()));
}

}  // namespace
}  // namespace cradle
