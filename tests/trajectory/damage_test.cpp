#include <sqlite3.h>
#include <sys/stat.h>
#include <map>

#include <random>

#include "sample_trajectory.h"

// Files that are no trajectory, or no longer one: an error that says so, never a crash and never a wrong result where
// the file shows that it is wrong.

namespace cradle {
namespace {

class DamagedTrajectory : public testing::Test {
 protected:
  /// Changes the sample by SQL and expects that reading all of it fails with `words`.
  void expectRefused(const std::string& sql, const std::string& words) const {
    writeSample(path_, 4);
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
    sqlite3_close(database);
    SCOPED_TRACE(sql);
    expectError(ErrorKind::usage, words, [&] { readAll(path_); });
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.file("a.sqlite");
};

TEST_F(DamagedTrajectory, OtherFilesAreNone) {
  writeContent(folder_.file("scene.json"), "{\"schema\": \"cradle-scene/1\"}");
  writeContent(folder_.file("empty"), "");
  ASSERT_EQ(mkfifo(folder_.file("pipe").c_str(), 0600), 0);
  const std::map<std::string, std::string> refusals = {{"scene.json", "is not a trajectory"},
                                                       {"empty", "is not a trajectory"},
                                                       {"missing", "no such file"},
                                                       {"pipe", "is not a regular file"},
                                                       {".", "is a directory"}};
  for (const auto& [name, refusal] : refusals) {
    EXPECT_FALSE(isDatabaseFile(folder_.file(name))) << name;
    expectError(ErrorKind::usage, folder_.file(name) + ": " + refusal, [&] { readAll(folder_.file(name)); });
  }
}

TEST_F(DamagedTrajectory, OtherDatabasesAreNone) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "CREATE TABLE frame (id, time)", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  EXPECT_TRUE(isDatabaseFile(path_));
  EXPECT_FALSE(isTrajectoryFile(path_));
  expectError(ErrorKind::usage, "not a trajectory", [&] { readAll(path_); });
}

TEST_F(DamagedTrajectory, WithMissingRowsIsRefused) {
  expectRefused("DELETE FROM frame WHERE id = 1", "frame 1");
  expectRefused("DELETE FROM frame WHERE id = 0", "frame 0");
  expectRefused("DELETE FROM frame", "frames are missing");
  expectRefused("DELETE FROM state WHERE frame = 2 AND body = 0", "frame 2");
  expectRefused("DELETE FROM state WHERE frame = 2 AND body = 2", "frame 2");
  expectRefused(
      "INSERT INTO state SELECT frame, 1, px, py, pz, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz FROM state "
      "WHERE frame = 3 AND body = 0",
      "frame 3");
  expectRefused("UPDATE state SET body = 1 WHERE frame = 3 AND body = 0", "frame 3");
  expectRefused(
      "INSERT INTO state SELECT frame, 3, px, py, pz, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz FROM state "
      "WHERE frame = 3 AND body = 0",
      "frame 3");
  expectRefused("DELETE FROM energy WHERE frame = 3", "energies of frame 3");
  expectRefused("DELETE FROM body WHERE id = 0", "body");
  expectRefused("DELETE FROM mesh", "mesh");
  expectRefused("DELETE FROM meta WHERE key = 'scene'", "scene");
  expectRefused("DELETE FROM meta WHERE key = 'cpuSeconds'", "damaged");
}

TEST_F(DamagedTrajectory, WithMissingTablesIsRefused) {
  for (const std::string table : {"meta", "mesh", "body", "frame", "state", "event", "energy"}) {
    expectRefused("DROP TABLE " + table, "not a trajectory");
    expectRefused("ALTER TABLE " + table + " RENAME TO other; CREATE VIEW " + table + " AS SELECT * FROM other",
                  "not a trajectory");
  }
  expectRefused("ALTER TABLE state RENAME COLUMN qw TO qv", "qw");
  expectRefused("PRAGMA user_version = 2", "version 2");
}

TEST_F(DamagedTrajectory, WithWrongValuesIsRefused) {
  expectRefused("UPDATE state SET vx = NULL WHERE frame = 1", "vx");
  expectRefused("UPDATE state SET vx = 9e999 WHERE frame = 1", "vx");
  expectRefused("UPDATE state SET px = 1e308 WHERE frame = 1", "frame 1");
  expectRefused("UPDATE state SET wz = -1e30 WHERE frame = 2 AND body = 2", "frame 2 has a state of body \"wedge\"");
  expectRefused("UPDATE state SET qw = 0.0, qx = 0.0, qy = 0.0, qz = 0.0 WHERE frame = 3", "frame 3");
  expectRefused("UPDATE state SET qw = 1e200 WHERE frame = 3", "frame 3");
  expectRefused("UPDATE body SET mass = 0.0 WHERE id = 0", "ball");
  expectRefused("UPDATE body SET mass = -1.0 WHERE id = 2", "wedge");
  expectRefused("UPDATE body SET iyy = 0.0 WHERE id = 2", "wedge");
  expectRefused("UPDATE frame SET time = 'noon' WHERE id = 1", "time");
  expectRefused("UPDATE frame SET time = 0.0 WHERE id = 1", "order");
  expectRefused("UPDATE frame SET time = -1.0 WHERE id = 0", "order");
  expectRefused("UPDATE event SET kind = 'crash'", "crash");
  expectRefused("UPDATE event SET a = 3", "event");
  expectRefused("UPDATE event SET b = -1", "event");
  expectRefused("UPDATE body SET mesh = 1 WHERE id = 2", "mesh");
  expectRefused("UPDATE body SET motion = 'lazy' WHERE id = 2", "dynamic");
  expectRefused("UPDATE body SET shape = NULL WHERE id = 0", "shape");
  expectRefused("UPDATE meta SET value = value || ' ' WHERE key = 'scene'", "scene");
}

// Rows of 40 bytes would give gigabytes.
TEST_F(DamagedTrajectory, WithComputedColumnsIsRefused) {
  const std::string rest = "kind TEXT, a INTEGER, b INTEGER, x, y, z, nx, ny, nz, impulse";
  expectRefused("ALTER TABLE event ADD COLUMN more AS (zeroblob(1000000000))", "computes");
  expectRefused("DROP TABLE event; CREATE TABLE event (time AS (1.0) STORED, " + rest + ")", "computes");
  expectRefused("DROP TABLE event; CREATE VIRTUAL TABLE event USING fts5(time)", "computes");
}

TEST_F(DamagedTrajectory, WithALogBesideItIsRefused) {
  expectRefused("PRAGMA journal_mode = WAL", "log");
}

TEST_F(DamagedTrajectory, WithWrongMeshesIsRefused) {
  expectRefused("UPDATE mesh SET vertices = substr(vertices, 2)", "mid-element");
  expectRefused("UPDATE mesh SET vertices = substr(vertices, 25)", "normal");
  expectRefused("UPDATE mesh SET normals = x''", "normal");
  expectRefused("UPDATE mesh SET triangles = x'000000000100000040000000'", "vertices that it does not have");
  expectRefused("UPDATE mesh SET triangles = substr(triangles, 13)", "cover");
  expectRefused("UPDATE mesh SET vertices = CAST(zeroblob(length(vertices) - 8) || x'000000000000f07f' AS BLOB)",
                "finite");
  expectRefused("UPDATE mesh SET vertices = NULL", "vertices");
  expectRefused("UPDATE mesh SET material = '['", "damaged");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[0].baseColor', 'red')", "colour");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[1].firstTriangle', 2)", "follow");
  expectRefused("UPDATE mesh SET material = json_remove(material, '$[1]')", "cover");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[1].triangleCount', -1)", "follow");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[1].triangleCount', 9223372036854775807)", "follow");
}

TEST_F(DamagedTrajectory, CutAnywhereIsRefused) {
  writeSample(path_, 200);
  const std::string whole = contentOf(path_);
  ASSERT_GT(whole.size(), 60000u);
  for (std::size_t size = 0; size < whole.size(); size += 509) {
    writeContent(path_, whole.substr(0, size));
    EXPECT_THROW(readAll(path_), Error) << size << " of " << whole.size() << " bytes";
  }
}

// Changed numbers cannot be seen; changed structure must not crash. Seeds make a failure repeatable.
TEST_F(DamagedTrajectory, WithChangedBytesNeverCrashes) {
  writeSample(path_, 60);
  const std::string whole = contentOf(path_);
  int refused = 0;
  for (unsigned seed = 0; seed < 1500; ++seed) {
    std::mt19937 random(seed);
    std::string changed = whole;
    for (int count = static_cast<int>(seed % 12); count >= 0; --count) {
      // Every other seed aims at the first pages, where the structure is.
      const std::size_t range = seed % 2 == 0 ? whole.size() : 8192;
      changed[random() % range] = static_cast<char>(random());
    }
    writeContent(path_, changed);
    try {
      readAll(path_);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace cradle
