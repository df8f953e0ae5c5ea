#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "core/crash.h"
#include "core/part_lock.h"
#include "mesh/confined_child.h"
#include "test_files.h"

// What a child that parses a stranger's file can do, and what becomes of one that fails.

namespace cradle {
namespace {

constexpr ChildLimits kLimits{256 << 20, 512 << 20, 5};

/// 0 if the call worked in the child, else what it failed with.
int errorInChild(const std::function<long()>& call) {
  const ChildAnswer answer = answerOfChild(
      [&] {
        errno = 0;
        return std::to_string(call() < 0 ? errno : 0);
      },
      kLimits);
  EXPECT_EQ(answer.failure, "");
  return std::stoi(answer.bytes);
}

TEST(ConfinedChild, ReadsFilesAndChangesNothing) {
  const std::string path = writeFile("a.txt", "content");
  const char* const name = path.c_str();
  EXPECT_EQ(answerOfChild([&] { return bytesOf(path); }, kLimits).bytes, "content");
  EXPECT_EQ(errorInChild([&] { return open(name, O_RDONLY); }), 0);
  EXPECT_EQ(errorInChild([&] { return open(name, O_WRONLY); }), EPERM);
  EXPECT_EQ(errorInChild([&] { return open(name, O_RDWR); }), EPERM);
  EXPECT_EQ(errorInChild([&] { return open(name, O_RDONLY | O_TRUNC); }), EPERM);
  EXPECT_EQ(errorInChild([&] { return open((path + ".new").c_str(), O_RDONLY | O_CREAT, 0666); }), EPERM);
  EXPECT_EQ(errorInChild([&] { return unlink(name); }), EPERM);
  EXPECT_EQ(errorInChild([&] { return rename(name, (path + ".new").c_str()); }), EPERM);
  EXPECT_EQ(errorInChild([&] { return symlink(name, (path + ".new").c_str()); }), EPERM);
  EXPECT_EQ(errorInChild([&] { return chmod(name, 0777); }), EPERM);
  EXPECT_EQ(bytesOf(path), "content");
  EXPECT_FALSE(std::filesystem::exists(path + ".new"));
}

TEST(ConfinedChild, StartsAndReachesNoOther) {
  EXPECT_EQ(errorInChild([] { return fork(); }), EPERM);
  EXPECT_EQ(errorInChild([] { return execl("/bin/true", "true", nullptr); }), EPERM);
  EXPECT_EQ(errorInChild([] { return socket(AF_INET, SOCK_STREAM, 0); }), EPERM);
  EXPECT_EQ(errorInChild([] { return kill(getppid(), 0); }), EPERM);
}

TEST(ConfinedChild, HasNoFileOfThisProcess) {
  const std::string path = writeFile("a.txt", "content");
  const int file = open(path.c_str(), O_RDWR);
  ASSERT_GE(file, 0);
  const int high = dup2(file, 50);
  const auto writes = [](int to) { return [to] { return write(to, "x", 1); }; };
  EXPECT_EQ(errorInChild(writes(high)), EBADF);
  EXPECT_EQ(bytesOf(path), "content");
  close(file), close(high);
}

TEST(ConfinedChild, TellsHowItFailed) {
  EXPECT_EQ(answerOfChild([]() -> std::string { std::abort(); }, kLimits).failure, "makes the importer crash");
  EXPECT_EQ(answerOfChild([]() -> std::string { throw std::runtime_error("odd"); }, kLimits).failure, "odd");
  volatile bool goesOn = true;
  const auto endless = [&]() -> std::string {
    while (goesOn) {
    }
    return "";
  };
  EXPECT_EQ(answerOfChild(endless, {256 << 20, 256 << 20, 1}).failure, "takes longer than 1 s");
  try {
    answerOfChild([]() -> std::string { throw Error(ErrorKind::scene, "here", "what"); }, kLimits);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    EXPECT_STREQ(error.what(), "here: what");
  }
}

std::string sizeOfMegabytes(std::size_t count) {
  const std::vector<char> bytes(count << 20, 'x');
  return std::to_string(bytes.size() >> 20);
}

TEST(ConfinedChild, HasTheMemoryThatItWasGiven) {
  EXPECT_EQ(answerOfChild([] { return sizeOfMegabytes(64); }, kLimits).bytes, "64");
  EXPECT_NE(answerOfChild([] { return sizeOfMegabytes(400); }, kLimits).failure, "");
  const auto withMore = [](std::size_t most) {
    return [most] {
      limitMemory(most << 20);
      return sizeOfMegabytes(400);
    };
  };
  EXPECT_EQ(answerOfChild(withMore(500), kLimits).bytes, "400");
  EXPECT_NE(answerOfChild(withMore(300), kLimits).failure, "");
  EXPECT_NE(answerOfChild(
                [] {
                  limitMemory(4096ULL << 20);
                  return sizeOfMegabytes(800);
                },
                kLimits)
                .failure,
            "");
}

TEST(ConfinedChild, AnswersWithMuch) {
  const ChildAnswer answer = answerOfChild([] { return std::string(50 << 20, 'y'); }, kLimits);
  EXPECT_EQ(answer.bytes.size(), std::size_t{50} << 20);
  EXPECT_EQ(answer.failure, "");
}

// The handler of the process that asked would remove what that is about to write.
TEST(ConfinedChildDeathTest, CrashIsNoneOfTheProcessThatAsked) {
  const std::string path = testing::TempDir() + "asked_" + std::to_string(getpid());
  EXPECT_EXIT(
      {
        noteCrashes();
        const PartLock lock(path);
        answerOfChild([]() -> std::string { std::abort(); }, kLimits);
        std::_Exit(std::filesystem::remove(path + ".part") ? 0 : 2);
      },
      testing::ExitedWithCode(0), "^$");
}

}  // namespace
}  // namespace cradle
