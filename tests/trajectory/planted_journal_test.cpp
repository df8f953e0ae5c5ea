#include <sqlite3.h>
#include <sys/stat.h>

#include <cstdint>

#include "sample_trajectory.h"

// A file may come from a stranger, and a journal beside it. SQLite takes back what a journal holds, and deletes the
// super-journal that it names when that names no other journal: any file of the user's.

namespace cradle {
namespace {

namespace fs = std::filesystem;

void appendBigEndian(std::uint32_t number, std::string& bytes) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
}

/// A rollback journal without pages for a database of `pages` pages of 4096 bytes, which names `superJournal`.
/// ("Database File Format" on sqlite.org, section 3; "Atomic Commit In SQLite", section 5)
std::string journalNaming(const std::string& superJournal, std::uint32_t pages) {
  const std::string magic("\xd9\xd5\x05\xf9\x20\xa1\x63\xd7", 8);
  std::string journal = magic;
  for (const std::uint32_t number : {0u, 0u, pages, 512u, 4096u}) appendBigEndian(number, journal);
  journal.resize(512);
  const std::uint32_t lockPage = 0x40000000 / 4096 + 1;
  appendBigEndian(lockPage, journal);
  journal += superJournal;
  std::uint32_t sum = 0;
  for (const char c : superJournal) sum += static_cast<unsigned char>(c);
  appendBigEndian(static_cast<std::uint32_t>(superJournal.size()), journal);
  appendBigEndian(sum, journal);
  return journal + magic;
}

/// A rollback journal that says that a database of `pages` pages began with the page `first`. A record's checksum is
/// the header's number, here 0, and every 200th byte from the end of the page.
std::string journalRestoring(const std::string& first, std::uint32_t pages) {
  std::string journal = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";
  for (const std::uint32_t number : {1u, 0u, pages, 512u, 4096u}) appendBigEndian(number, journal);
  journal.resize(512);
  appendBigEndian(1, journal);
  journal += first;
  std::uint32_t sum = 0;
  for (std::size_t i = first.size() - 200; i > 0 && i < first.size(); i -= 200)
    sum += static_cast<unsigned char>(first[i]);
  appendBigEndian(sum, journal);
  return journal;
}

class PlantedJournal : public testing::Test {
 protected:
  /// Puts a file of the user's, and a journal that names it beside the database at `path`.
  void plant(const std::string& path) const {
    writeContent(victim_, "dear diary");
    writeContent(path + "-journal", journalNaming(victim_, static_cast<std::uint32_t>(fs::file_size(path) / 4096)));
  }

  TemporaryFolder folder_, users_;
  std::string victim_ = users_.file("diary.txt"), path_ = folder_.file("a.sqlite");
};

// Else the tests below would hold whatever was read.
TEST_F(PlantedJournal, DeletesAFileWhereSqliteReadsAsItDoesByItself) {
  writeSample(path_, 3);
  plant(path_);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "SELECT count(*) FROM frame", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  EXPECT_FALSE(fs::exists(victim_));
}

TEST_F(PlantedJournal, IsNotLookedAtBesideAFinishedTrajectory) {
  writeSample(path_, 3);
  const std::string before = contentOf(path_);
  plant(path_);
  const std::string journal = contentOf(path_ + "-journal");
  readAll(path_);
  EXPECT_EQ(contentOf(victim_), "dear diary");
  EXPECT_EQ(contentOf(path_), before);
  EXPECT_EQ(contentOf(path_ + "-journal"), journal);
  EXPECT_EQ(folder_.count(), 2);
}

TEST_F(PlantedJournal, OfAPartIsRefusedByReadersAndWriters) {
  writeSample(path_, 3);
  fs::rename(path_, path_ + ".part");
  plant(path_ + ".part");
  expectError(ErrorKind::usage, ".part-journal: is none of cradle's", [&] { readAll(path_ + ".part"); });
  expectError(ErrorKind::output, ".part-journal: is none of cradle's",
              [&] { TrajectoryWriter(path_, sampleHeader()); });
  fs::create_symlink(path_ + ".part", folder_.file("link.sqlite"));
  expectError(ErrorKind::usage, ".part-journal: is none of cradle's", [&] { readAll(folder_.file("link.sqlite")); });
  EXPECT_EQ(contentOf(victim_), "dear diary");
}

// What it takes back may say that the file keeps a log beside it, which SQLite deletes when it has been taken in.
TEST_F(PlantedJournal, OfAPartBringsNoLogToLife) {
  for (const bool isOurs : {false, true}) {
    const std::string path = folder_.file(isOurs ? "ours.sqlite" : "sqlites.sqlite");
    writeSample(path, 3);
    const std::string part = isOurs ? path + ".part" : path, whole = contentOf(path);
    std::string first = whole.substr(0, 4096);
    first[18] = first[19] = 2;  // kept with a log
    fs::rename(path, part);
    writeContent(part + "-journal", journalRestoring(first, static_cast<std::uint32_t>(whole.size() / 4096)));
    writeContent(part + "-wal", "dear diary");
    if (isOurs) {
      expectError(ErrorKind::usage, ".sqlite.part: ", [&] { readAll(part); });
    } else {
      sqlite3* database = nullptr;
      ASSERT_EQ(sqlite3_open(part.c_str(), &database), SQLITE_OK);
      EXPECT_EQ(sqlite3_exec(database, "SELECT count(*) FROM frame", nullptr, nullptr, nullptr), SQLITE_OK);
      sqlite3_close(database);
    }
    EXPECT_EQ(fs::exists(part + "-wal"), isOurs);
    EXPECT_FALSE(fs::exists(part + "-shm"));
  }
}

TEST_F(PlantedJournal, OfAPartThatMakesItLongerIsRefused) {
  writeSample(path_, 3);
  const std::string whole = contentOf(path_);
  fs::rename(path_, path_ + ".part");
  writeContent(path_ + ".part-journal", journalRestoring(whole.substr(0, 4096), 1u << 30));
  expectError(ErrorKind::usage, "belongs to a longer file", [&] { readAll(path_ + ".part"); });
  expectError(ErrorKind::output, "belongs to a longer file", [&] { TrajectoryWriter(path_, sampleHeader()); });
  EXPECT_EQ(contentOf(path_ + ".part"), whole);
  std::string journal = journalRestoring(whole.substr(0, 4096), 1u << 30);
  journal.replace(24, 4, std::string(4, '\0'));  // bytes of a page: as many as the database has
  writeContent(path_ + ".part-journal", journal);
  expectError(ErrorKind::usage, "belongs to a longer file", [&] { readAll(path_ + ".part"); });
  EXPECT_EQ(contentOf(path_ + ".part"), whole);
}

TEST_F(PlantedJournal, ThatIsNoRegularFileIsRefused) {
  writeSample(path_, 3);
  fs::rename(path_, path_ + ".part");
  ASSERT_EQ(mkfifo((path_ + ".part-journal").c_str(), 0600), 0);  // would be waited for without end
  expectError(ErrorKind::usage, "no regular file", [&] { readAll(path_ + ".part"); });
  expectError(ErrorKind::output, "no regular file", [&] { TrajectoryWriter(path_, sampleHeader()); });
}

// Names that SQLite takes for addresses, or would if they were not written out.
TEST_F(PlantedJournal, NamesOfFilesAreNames) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  for (const std::string name : {"file:b.sqlite", "c?mode=memory#d%41.sqlite", "e f\xc3\xa9.sqlite", ":memory:"}) {
    writeSample(name, 3);
    EXPECT_TRUE(fs::exists(folder_.file(name))) << name;
    EXPECT_EQ(TrajectoryReader(name).frameCount(), 3) << name;
  }
  fs::current_path(before);
  EXPECT_EQ(folder_.count(), 4);
}

}  // namespace
}  // namespace cradle
