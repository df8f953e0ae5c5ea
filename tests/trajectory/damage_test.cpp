#include <fmt/format.h>
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

  int rootPageOf(const std::string& table) const {
    sqlite3* database = nullptr;
    sqlite3_stmt* query = nullptr;
    sqlite3_open(path_.c_str(), &database);
    const std::string sql = "SELECT rootpage FROM sqlite_master WHERE name = '" + table + "'";
    sqlite3_prepare_v2(database, sql.c_str(), -1, &query, nullptr);
    sqlite3_step(query);
    const int root = sqlite3_column_int(query, 0);
    sqlite3_finalize(query);
    sqlite3_close(database);
    return root;
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
    const std::string path = folder_.file(name);
    EXPECT_FALSE(isDatabaseFile(path)) << path;
    expectError(ErrorKind::usage, path + ": " + refusal, [&] { readAll(path); });
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
  expectRefused("DELETE FROM joint_state WHERE frame = 1 AND joint = 1", "joints of frame 1");
  expectRefused("INSERT INTO joint_state VALUES (1, 2, 0.0, 0.0, 0.0)", "joints of frame 1");
  expectRefused("DELETE FROM joint WHERE id = 0", "joint");
  expectRefused("DELETE FROM body WHERE id = 0", "body");
  expectRefused("DELETE FROM mesh", "mesh");
  expectRefused("DELETE FROM meta WHERE key = 'scene'", "scene");
  expectRefused("DELETE FROM meta WHERE key = 'cpuSeconds'", "damaged");
}

TEST_F(DamagedTrajectory, WithContactsThatCannotBeIsRefused) {
  const std::string contact = "INSERT INTO contact VALUES (0, 0, 1, 0.0, NULL); ";
  const std::string force = "INSERT INTO contact_force VALUES (0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1.0, 0.0); ";
  expectRefused("INSERT INTO contact VALUES (1, 0, 1, 0.0, NULL)", "contact is missing");
  expectRefused("INSERT INTO contact VALUES (0, 0, 3, 0.0, NULL)", "contact names a body");
  expectRefused("INSERT INTO contact VALUES (0, 0, 1, 0.5, 0.25)", "lasts when none can");
  expectRefused("INSERT INTO contact VALUES (0, 0, 1, 0.5, 1.1e10)", "lasts when none can");
  expectRefused(contact + force + "UPDATE contact_force SET contact = 1", "not there");
  expectRefused(contact + force + "UPDATE contact_force SET tx = 1e100", "tx");
  expectRefused(contact + force + "UPDATE contact_force SET x = NULL", "x");
  expectRefused("INSERT INTO camera VALUES (0, 0.0, 0.0, 1e30, 1.0, 0.0, 0.0, 0.0, 0.5)", "camera of frame 0");
  expectRefused("INSERT INTO camera VALUES (0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 4.0)", "camera of frame 0");
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
  expectRefused("UPDATE state SET px = 1e99 WHERE frame = 1", "frame 1");
  expectRefused("UPDATE state SET px = 1e100 WHERE frame = 1", "px");
  expectRefused("UPDATE state SET wz = -1e30 WHERE frame = 2 AND body = 2", "frame 2 has a state of body \"wedge\"");
  expectRefused("UPDATE state SET qw = 0.0, qx = 0.0, qy = 0.0, qz = 0.0 WHERE frame = 3", "frame 3");
  expectRefused("UPDATE state SET qw = 1e99 WHERE frame = 3", "frame 3");
  expectRefused("UPDATE body SET mass = 0.0 WHERE id = 0", "ball");
  expectRefused("UPDATE body SET mass = -1.0 WHERE id = 2", "wedge");
  expectRefused("UPDATE body SET iyy = 0.0 WHERE id = 2", "wedge");
  expectRefused("UPDATE frame SET time = 'noon' WHERE id = 1", "time");
  expectRefused("UPDATE frame SET time = 0.0 WHERE id = 1", "order");
  expectRefused("UPDATE frame SET time = -1.0 WHERE id = 0", "order");
  expectRefused("UPDATE frame SET time = 1.1e10 WHERE id = 3", "later");
  expectRefused("UPDATE energy SET kinetic = -1e307 WHERE frame = 1", "kinetic");
  expectRefused("UPDATE body SET mass = 1e308 WHERE id = 0", "mass");
  expectRefused("UPDATE body SET comx = 1e30 WHERE id = 2", "centre of mass");
  expectRefused("UPDATE event SET x = 1e30", "where");
  expectRefused("UPDATE event SET time = 1.1e10", "when");
  expectRefused("UPDATE event SET kind = 'crash'", "crash");
  expectRefused("UPDATE event SET a = 3", "event");
  expectRefused("UPDATE event SET b = -1", "event");
  expectRefused("UPDATE joint SET a = 3 WHERE id = 0", "joint");
  expectRefused("UPDATE joint SET b = -1 WHERE id = 1", "joint");
  expectRefused("UPDATE joint SET a = NULL WHERE id = 1", "a");
  expectRefused("UPDATE joint SET kind = 'knee' WHERE id = 1", "hinge");
  expectRefused("UPDATE joint_state SET coordinate = 1e100 WHERE frame = 1", "coordinate");
  expectRefused("UPDATE joint_state SET force = NULL WHERE frame = 1", "force");
  expectRefused("UPDATE body SET mesh = 1 WHERE id = 2", "mesh");
  expectRefused("UPDATE body SET motion = 'lazy' WHERE id = 2", "dynamic");
  expectRefused("UPDATE body SET shape = NULL WHERE id = 0", "shape");
  expectRefused("UPDATE meta SET value = value || ' ' WHERE key = 'scene'", "scene");
}

TEST_F(DamagedTrajectory, WithLongValuesIsRefused) {
  expectRefused("INSERT INTO meta VALUES ('plans', CAST(zeroblob(64000001) AS TEXT))", "longer than 64000000 bytes");
  expectRefused("UPDATE meta SET value = NULL WHERE key = 'plan'", "missing");
}

// The table's root becomes a page of 300 children that are all one page of 300 children ..., and so on seven times,
// above the leaf that it was. ("Database File Format" on sqlite.org, section 1.6)
TEST_F(DamagedTrajectory, WithPagesThatAreHeldManyTimesIsRefused) {
  constexpr std::size_t kPage = 4096, kChildren = 300;
  for (const std::string table : {"mesh", "body", "frame", "event"}) {
    writeSample(path_, 4);
    const auto root = static_cast<std::size_t>(rootPageOf(table) - 1) * kPage;
    std::string file = contentOf(path_);
    std::string page = file.substr(root, kPage);
    const auto number = [](std::string& text, std::size_t at, int bytes, std::size_t value) {
      for (int i = 0; i < bytes; ++i)
        text[at + static_cast<std::size_t>(i)] = static_cast<char>(value >> 8 * (bytes - 1 - i));
    };
    for (int level = 0; level < 7; ++level) {
      file += page;
      const std::size_t child = file.size() / kPage;
      page.assign(kPage, '\0');
      page[0] = 5;
      number(page, 3, 2, kChildren);
      number(page, 5, 2, kPage - 5 * kChildren);
      number(page, 8, 4, child);
      for (std::size_t i = 0; i < kChildren; ++i) {
        const std::size_t cell = kPage - 5 * (i + 1);
        number(page, 12 + 2 * i, 2, cell);
        number(page, cell, 4, child);
        page[cell + 4] = 1;
      }
    }
    number(file, 28, 4, file.size() / kPage);
    file.replace(root, kPage, page);
    writeContent(path_, file);
    expectError(ErrorKind::usage, "damaged", [&] { readAll(path_); });
  }
}

// Each frame would be sought among all rows.
TEST_F(DamagedTrajectory, WithoutKeysIsRefusedBeforeItTakesLong) {
  const std::string many = "WITH RECURSIVE c(i) AS (SELECT 10 UNION ALL SELECT i + 1 FROM c WHERE i < 200000) ";
  expectRefused("CREATE TABLE s AS SELECT * FROM state; DROP TABLE state; ALTER TABLE s RENAME TO state; " + many +
                    "INSERT INTO state (frame, body) SELECT i, 0 FROM c",
                "no order");
}

// Rows of 40 bytes would give gigabytes.
TEST_F(DamagedTrajectory, WithComputedColumnsIsRefused) {
  const std::string rest = "kind TEXT, a INTEGER, b INTEGER, x, y, z, nx, ny, nz, impulse";
  expectRefused("ALTER TABLE event ADD COLUMN more AS (zeroblob(1000000000))", "computes");
  expectRefused("ALTER TABLE joint_state ADD COLUMN more AS (zeroblob(1000000000))", "computes");
  expectRefused("DROP TABLE event; CREATE TABLE event (time AS (1.0) STORED, " + rest + ")", "computes");
  expectRefused("DROP TABLE event; CREATE VIRTUAL TABLE event USING fts5(time)", "computes");
}

/// The definition of a table, in a file whose schema says that the table is stored.
std::string asStored(const std::string& table, const std::string& sql) {
  return "PRAGMA writable_schema = ON; UPDATE sqlite_master SET rootpage = 3, sql = '" + sql + "' WHERE name = '" +
         table + "'";
}

TEST_F(DamagedTrajectory, WithATableThatIsAModuleIsRefused) {
  expectRefused(asStored("event", "CREATE VIRTUAL TABLE event USING rtree(id, a, b)"), "no such module: rtree");
  expectRefused(asStored("event", "CREATE VIRTUAL TABLE event USING json_each"), "computes");
}

// SQLite would parse all of them before its first query.
TEST_F(DamagedTrajectory, WithManyDefinitionsIsRefused) {
  std::string sql = "BEGIN; ";
  for (int i = 0; i < 5000; ++i) sql += fmt::format("CREATE VIEW more{0} AS SELECT {0} AS {1:a>40}; ", i, "");
  expectRefused(sql + "COMMIT", "defines more than 200 tables");
}

TEST_F(DamagedTrajectory, WithAViewOfItsOwnAndIntegersForNumbersIsRead) {
  writeSample(path_, 4);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database,
                         "CREATE VIEW heights AS SELECT py FROM state; UPDATE frame SET time = 0 WHERE id = 0; UPDATE "
                         "energy SET work = CAST(work AS INTEGER) WHERE work = CAST(work AS INTEGER)",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_NO_THROW(readAll(path_));
}

TEST_F(DamagedTrajectory, WithALogBesideItIsRefused) {
  expectRefused("PRAGMA journal_mode = WAL", "log");
}

TEST_F(DamagedTrajectory, WithWrongMeshesIsRefused) {
  expectRefused("UPDATE mesh SET vertices = substr(vertices, 2)", "mid-element");
  expectRefused("UPDATE mesh SET vertices = substr(vertices, 25)", "normal");
  expectRefused("UPDATE mesh SET normals = x''", "normal");
  expectRefused("UPDATE mesh SET triangles = x'000000000100000040000000000000000100000002000000'",
                "vertices that it does not have");
  expectRefused("UPDATE mesh SET triangles = substr(triangles, 13)", "cover");
  expectRefused("UPDATE mesh SET vertices = CAST(zeroblob(length(vertices) - 8) || x'000000000000f07f' AS BLOB)",
                "finite");
  expectRefused("UPDATE mesh SET vertices = CAST(zeroblob(length(vertices) - 8) || x'0000000000004046' AS BLOB)",
                "1e30 m");
  expectRefused("UPDATE mesh SET vertices = NULL", "vertices");
  expectRefused("UPDATE mesh SET material = '['", "damaged");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[0].baseColor', 'red')", "colour");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[1].firstTriangle', 2)", "follow");
  expectRefused("UPDATE mesh SET triangles = substr(triangles, 1, 12)", "more materials than triangles");
  expectRefused("UPDATE mesh SET material = json_remove(material, '$[1]')", "cover");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[1].triangleCount', -1)", "follow");
  expectRefused("UPDATE mesh SET material = json_set(material, '$[1].triangleCount', 9223372036854775807)", "follow");
}

TEST_F(DamagedTrajectory, WithWrongTexturesIsRefused) {
  const std::string tables =
      "CREATE TABLE texture (id INTEGER PRIMARY KEY, name TEXT, image BLOB);"
      "CREATE TABLE texture_coordinates (mesh INTEGER PRIMARY KEY, coordinates BLOB);";
  const std::string named = "UPDATE mesh SET material = json_set(material, '$[0].texture', 0);";
  const std::string whole = "INSERT INTO texture VALUES (0, 'a.png', x'00');";
  expectRefused(named, "a mesh has a texture that is not there");
  expectRefused(tables + named, "a mesh has a texture that is not there");
  expectRefused(tables + "INSERT INTO texture VALUES (1, 'a.png', x'00')", "a texture is missing");
  expectRefused(tables + whole + "INSERT INTO texture_coordinates VALUES (0, zeroblob(8))",
                "not one pair of texture coordinates a vertex");
  expectRefused(tables + whole + "INSERT INTO texture_coordinates VALUES (0, zeroblob(9))", "ends in mid-element");
  const std::string notFinite(2 * 8 * sampleModel().drawn.vertices.size(), 'f');  // hexadecimal digits
  expectRefused(tables + whole + "INSERT INTO texture_coordinates VALUES (0, x'" + notFinite + "')",
                "texture coordinates that are not finite");
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
