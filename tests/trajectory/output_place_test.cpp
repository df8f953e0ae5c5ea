#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "own_process.h"
#include "sample_trajectory.h"

// Disks that are full, folders and devices that cannot or must not be written.

namespace cradle {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

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

}  // namespace
}  // namespace cradle
