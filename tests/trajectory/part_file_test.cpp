#include <sched.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "sample_trajectory.h"

// What is on disk before, during and after a run, whatever ends it.

namespace cradle {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr uid_t kNobody = 65534;  // to become where permissions matter: they do not stop the superuser

void expectFirstFrames(const TrajectoryReader& reader) {
  for (long number = 0; number < reader.frameCount(); ++number)
    expectSameBits(reader.readFrame(number), sampleFrame(number));
}

/// Runs `action` in a process of its own and returns how that ended; an exception shows as 99.
int statusOfProcess(const std::function<int()>& action) {
  const pid_t process = fork();
  if (process == 0) {
    try {
      _exit(action());
    } catch (...) {
      _exit(99);
    }
  }
  int status = 0;
  waitpid(process, &status, 0);
  return status;
}

/// Another process that appends sample frames until it is killed; the first is there from the start.
class ChildWriter {
 public:
  explicit ChildWriter(const std::string& path, std::chrono::milliseconds commitInterval = 0ms) {
    int ready[2] = {};
    if (pipe(ready) != 0) std::abort();
    process_ = fork();
    if (process_ == 0) {
      TrajectoryWriter writer(path, sampleHeader(), commitInterval);
      for (long number = 0;; ++number) {
        writer.append(sampleFrame(number));
        if (number == 0 && write(ready[1], "!", 1) != 1) _exit(1);
      }
    }
    char byte = 0;
    EXPECT_EQ(read(ready[0], &byte, 1), 1);
    close(ready[0]);
    close(ready[1]);
  }

  ~ChildWriter() { kill(); }
  ChildWriter(const ChildWriter&) = delete;
  ChildWriter& operator=(const ChildWriter&) = delete;

  void kill() {
    if (process_ == 0) return;
    ::kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_ = 0;
};

TEST(TrajectoryPart, IsAllThereIsUntilTheRunIsFinished) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
  writer.append(sampleFrame(0));
  EXPECT_FALSE(fs::exists(folder.file("a.sqlite")));
  EXPECT_TRUE(fs::exists(folder.file("a.sqlite.part")));
  writer.finish({});
  EXPECT_TRUE(fs::exists(folder.file("a.sqlite")));
  EXPECT_EQ(folder.count(), 1) << "a journal or the .part is left over";
  EXPECT_EQ(writer.keptPath(), "");
}

TEST(TrajectoryPart, StaysReadableWhenTheRunEndsEarly) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
  for (long number = 0; number < 5; ++number) writer.append(sampleFrame(number));
  EXPECT_EQ(writer.keptPath(), folder.file("a.sqlite.part"));
  EXPECT_EQ(folder.count(), 1);
  const TrajectoryReader reader(folder.file("a.sqlite.part"));
  EXPECT_EQ(reader.frameCount(), 5);
  EXPECT_FALSE(reader.isFinished());
  EXPECT_EQ(reader.cost().evaluations, 0);
  expectFirstFrames(reader);
}

TEST(TrajectoryPart, IsClosedByTheDestructorToo) {
  const TemporaryFolder folder;
  {
    TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
    writer.append(sampleFrame(0));
    writer.append(sampleFrame(1));
  }
  EXPECT_EQ(folder.count(), 1);
  EXPECT_EQ(TrajectoryReader(folder.file("a.sqlite.part")).frameCount(), 2);
}

TEST(TrajectoryPart, GoesWhenNoFrameWasWritten) {
  const TemporaryFolder folder;
  {
    TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
    EXPECT_EQ(folder.count(), 1);
    EXPECT_EQ(writer.keptPath(), "");
    EXPECT_EQ(folder.count(), 0);
  }
  { const TrajectoryWriter writer(folder.file("b.sqlite"), sampleHeader()); }
  EXPECT_EQ(folder.count(), 0);
}

TEST(TrajectoryPart, LeavesAnEarlierResultAloneUntilTheEnd) {
  const TemporaryFolder folder;
  writeContent(folder.file("a.sqlite"), "precious");
  {
    TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
    writer.append(sampleFrame(0));
  }
  EXPECT_EQ(contentOf(folder.file("a.sqlite")), "precious");
  writeSample(folder.file("a.sqlite"), 2);
  EXPECT_EQ(TrajectoryReader(folder.file("a.sqlite")).frameCount(), 2);
  EXPECT_EQ(folder.count(), 1);
}

TEST(TrajectoryPart, ReplacesAnOldPartAndItsJournal) {
  const TemporaryFolder folder;
  writeContent(folder.file("a.sqlite.part"), "left by a killed run");
  writeContent(folder.file("a.sqlite.part-journal"), std::string(4096, '\xd9'));
  writeSample(folder.file("a.sqlite"), 2);
  EXPECT_EQ(folder.count(), 1);
  readAll(folder.file("a.sqlite"));
}

TEST(TrajectoryPart, OfAnotherRunIsNotTaken) {
  const TemporaryFolder folder;
  ChildWriter other(folder.file("a.sqlite"), 1h);
  expectError(ErrorKind::output, "another run",
              [&] { const TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader()); });
  readAll(folder.file("a.sqlite.part"));
  other.kill();
  writeSample(folder.file("a.sqlite"), 2);
  EXPECT_EQ(folder.count(), 1);
}

TEST(TrajectoryFile, CanBeReadWhereNothingMayBeWritten) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 3);
  fs::permissions(folder.file("a.sqlite"), fs::perms(0444));
  fs::permissions(folder.path(), fs::perms(0555));
  const int status = statusOfProcess([&] {
    if (geteuid() == 0 && setuid(kNobody) != 0) return 2;
    readAll(folder.file("a.sqlite"));
    return 0;
  });
  fs::permissions(folder.path(), fs::perms::owner_all);
  EXPECT_EQ(status, 0);
}

TEST(TrajectoryPart, CanBeReadWhileItIsWritten) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader(), 0ms);
  for (long number = 0; number < 4; ++number) {
    writer.append(sampleFrame(number));
    const TrajectoryReader reader(folder.file("a.sqlite.part"));
    EXPECT_EQ(reader.frameCount(), number + 1);
    expectFirstFrames(reader);
  }
  writer.finish({});
}

TEST(TrajectoryPart, DoesNotStopTheRunWhileAnotherProgramReads) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader(), 0ms);
  writer.append(sampleFrame(0));
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(folder.file("a.sqlite.part").c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN; SELECT count(*) FROM state", nullptr, nullptr, nullptr), SQLITE_OK);
  for (long number = 1; number < 50; ++number) writer.append(sampleFrame(number));
  ASSERT_EQ(sqlite3_exec(other, "COMMIT", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(other);
  writer.append(sampleFrame(50));
  EXPECT_EQ(TrajectoryReader(folder.file("a.sqlite.part")).frameCount(), 51);
}

// Killed at 30 different moments while committing every frame: now and then in the middle of a commit.
TEST(TrajectoryPart, IsConsistentAfterTheProcessIsKilled) {
  const TemporaryFolder folder;
  long most = 0;
  for (int round = 0; round < 30; ++round) {
    const std::string path = folder.file(std::to_string(round) + ".sqlite");
    ChildWriter writer(path);
    std::this_thread::sleep_for(round * 700us);
    writer.kill();
    const TrajectoryReader reader(path + ".part");
    EXPECT_GE(reader.frameCount(), 1);
    expectFirstFrames(reader);
    most = std::max(most, reader.frameCount());
  }
  EXPECT_GT(most, 1);
}

/// No file of this process may be larger from now on. Further writing fails like a broken disk.
void limitFileSize(rlim_t bytes) {
  signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

/// Makes `folder` a disk of 200 kB, for this process alone. False where that is not permitted.
bool mountSmallDisk(const std::string& folder) {
  return unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=200k") == 0;
}

/// Writes frames until that fails, then reads those that were kept.
void fillDisk(const std::string& path, const std::string& words) {
  TrajectoryWriter writer(path, sampleHeader(), 0ms);
  expectError(ErrorKind::output, words, [&] {
    for (long number = 0;; ++number) writer.append(sampleFrame(number));
  });
  ASSERT_EQ(writer.keptPath(), path + ".part");
  const TrajectoryReader reader(path + ".part");
  EXPECT_GT(reader.frameCount(), 50);
  expectFirstFrames(reader);
}

int failures() {
  return testing::Test::HasFailure() ? 1 : 0;
}

TEST(TrajectoryPart, KeepsItsFramesWhenItCannotGrow) {
  const TemporaryFolder folder;
  const int status = statusOfProcess([&] {
    limitFileSize(100000);
    fillDisk(folder.file("a.sqlite"), "cannot be written");
    return failures();
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(folder.count(), 1);
  EXPECT_GT(TrajectoryReader(folder.file("a.sqlite.part")).frameCount(), 50);
}

TEST(TrajectoryPart, SaysThatTheDiskIsFull) {
  const TemporaryFolder folder;
  const int status = statusOfProcess([&] {
    const bool isSmall = mountSmallDisk(folder.path());
    if (!isSmall) limitFileSize(100000);
    fillDisk(folder.file("a.sqlite"), isSmall ? "the disk is full" : "cannot be written");
    return failures();
  });
  EXPECT_EQ(status, 0);
}

TEST(TrajectoryPart, LeavesNothingWhenTheDiskIsFullFromTheStart) {
  const TemporaryFolder folder;
  const int status = statusOfProcess([&] {
    limitFileSize(5000);
    expectError(ErrorKind::output, "cannot be written",
                [&] { const TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader()); });
    return failures();
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(folder.count(), 0);
}

TEST(TrajectoryPart, NeedsAPlaceThatCanBeWritten) {
  const TemporaryFolder folder;
  const auto open = [](const std::string& path) { const TrajectoryWriter writer(path, sampleHeader()); };
  expectError(ErrorKind::output, "/dev/full", [&] { open("/dev/full"); });
  expectError(ErrorKind::output, "/dev/null", [&] { open("/dev/null"); });
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  expectError(ErrorKind::output, folder.path(), [&] { open(folder.path()); });
  expectError(ErrorKind::output, "missing", [&] { open(folder.file("missing/a.sqlite")); });
  expectError(ErrorKind::output, "a.sqlite", [&] { open("/proc/a.sqlite"); });
  ASSERT_EQ(mkfifo(folder.file("pipe").c_str(), 0600), 0);
  expectError(ErrorKind::output, "pipe", [&] { open(folder.file("pipe")); });
  fs::create_directory(folder.file("b.sqlite.part"));
  expectError(ErrorKind::output, "b.sqlite.part", [&] { open(folder.file("b.sqlite")); });
  EXPECT_EQ(folder.count(), 2);
}

TEST(TrajectoryPart, NeedsAFolderThatItMayWriteTo) {
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  const int status = statusOfProcess([&] {
    if (geteuid() == 0 && setuid(kNobody) != 0) return 2;
    try {
      const TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
    } catch (const Error& error) {
      return error.kind() == ErrorKind::output ? 0 : 1;
    }
    return 3;
  });
  fs::permissions(folder.path(), fs::perms::owner_all);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(folder.count(), 0);
}

TEST(TrajectoryPart, IsNotPutOverSomethingThatCameMeanwhile) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
  writer.append(sampleFrame(0));
  ASSERT_EQ(mkfifo(folder.file("a.sqlite").c_str(), 0600), 0);
  expectError(ErrorKind::output, "a.sqlite", [&] { writer.finish({}); });
  EXPECT_TRUE(fs::is_fifo(folder.file("a.sqlite")));
  EXPECT_EQ(writer.keptPath(), folder.file("a.sqlite.part"));
  EXPECT_TRUE(TrajectoryReader(writer.keptPath()).isFinished());
}

}  // namespace
}  // namespace cradle
