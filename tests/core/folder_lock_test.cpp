#include "core/folder_lock.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <utility>

#include "core/error.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

class FolderLockTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directory(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string folder_ = testing::TempDir() + "folder_lock_" + std::to_string(getpid());
};

TEST_F(FolderLockTest, SecondRunIsTurnedAway) {
  for (const auto& [first, second] : {std::pair(FolderUse::alone, FolderUse::alone),
                                      {FolderUse::alone, FolderUse::shared},
                                      {FolderUse::shared, FolderUse::alone}}) {
    const FolderLock lock(folder_, first);
    try {
      const FolderLock other(folder_, second);
      FAIL() << "locked twice";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::output);
      EXPECT_NE(std::string(error.what()).find("process "), std::string::npos) << error.what();
    }
  }
}

TEST_F(FolderLockTest, PartsShareIt) {
  const FolderLock lock(folder_, FolderUse::shared);
  EXPECT_NO_THROW(FolderLock(folder_, FolderUse::shared));
}

TEST_F(FolderLockTest, LeavesNothingAndEndsWithItsProcess) {
  EXPECT_EXIT(
      {
        const FolderLock lock(folder_, FolderUse::alone);
        std::_Exit(0);  // without its destructor
      },
      testing::ExitedWithCode(0), "");
  EXPECT_TRUE(fs::is_empty(folder_));
  for (int i = 0; i < 2; ++i) EXPECT_NO_THROW(FolderLock(folder_, FolderUse::alone));
}

TEST_F(FolderLockTest, FolderOfARunWithoutResultsIsGone) {
  const std::string made = folder_ + "/new", held = folder_ + "/held", filled = folder_ + "/filled";
  { const ResultFolder results(made), there(folder_); }
  EXPECT_FALSE(fs::exists(made));
  EXPECT_TRUE(fs::exists(folder_));
  {
    const ResultFolder results(filled);
    fs::create_directory(filled + "/result");
  }
  EXPECT_TRUE(fs::exists(filled));
  std::optional<FolderLock> lock;
  {
    const ResultFolder results(held);
    lock.emplace(held, FolderUse::shared);
  }
  EXPECT_TRUE(fs::exists(held));
}

TEST_F(FolderLockTest, NeedsAFolder) {
  EXPECT_THROW(FolderLock(folder_ + "/none", FolderUse::alone), Error);
}

}  // namespace
}  // namespace cradle
