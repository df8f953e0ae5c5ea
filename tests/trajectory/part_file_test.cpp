#include <signal.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "own_process.h"
#include "sample_trajectory.h"

// What is on disk before, during and after a run, whatever ends it.

namespace cradle {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

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
