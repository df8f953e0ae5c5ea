#include <sqlite3.h>

#include "sample_trajectory.h"

namespace cradle {
namespace {

/// The rows of a query as text, columns separated by "|", as any other program would see them.
std::vector<std::string> rowsOf(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::vector<std::string> rows;
  const auto add = [](void* to, int count, char** values, char**) {
    std::string row = count > 0 && values[0] ? values[0] : "null";
    for (int i = 1; i < count; ++i) row.append("|").append(values[i] ? values[i] : "null");
    static_cast<std::vector<std::string>*>(to)->push_back(row);
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), add, &rows, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  sqlite3_close(database);
  return rows;
}

std::string columnsOf(const std::string& path, const std::string& table) {
  std::string columns;
  for (const std::string& name : rowsOf(path, "SELECT name FROM pragma_table_info('" + table + "') ORDER BY cid"))
    columns.append(columns.empty() ? "" : " ").append(name);
  return columns;
}

class TrajectorySchema : public testing::Test {
 protected:
  TrajectorySchema() { writeSample(path_, 3); }
  std::vector<std::string> rows(const std::string& sql) const { return rowsOf(path_, sql); }

  TemporaryFolder folder_;
  std::string path_ = folder_.file("a.sqlite");
};

TEST_F(TrajectorySchema, HasTheTablesOfTheContract) {
  EXPECT_EQ(rows("SELECT name FROM sqlite_master WHERE type != 'index' ORDER BY name"),
            (std::vector<std::string>{"body", "camera", "checkpoint", "contact", "contact_force", "energy", "event",
                                      "frame", "joint", "joint_state", "mesh", "meta", "state"}));
}

TEST_F(TrajectorySchema, HasTheColumnsOfTheContractInItsOrder) {
  EXPECT_EQ(columnsOf(path_, "meta"), "key value");
  EXPECT_EQ(columnsOf(path_, "mesh"), "id name vertices normals triangles material vertexNumbers");
  EXPECT_EQ(columnsOf(path_, "body"), "id name motion mesh shape mass comx comy comz ixx iyy izz ixy ixz iyz");
  EXPECT_EQ(columnsOf(path_, "frame"), "id time");
  EXPECT_EQ(columnsOf(path_, "state"), "frame body px py pz qw qx qy qz vx vy vz wx wy wz");
  EXPECT_EQ(columnsOf(path_, "joint"), "id name kind a b");
  EXPECT_EQ(columnsOf(path_, "joint_state"), "frame joint coordinate velocity force");
  EXPECT_EQ(columnsOf(path_, "camera"), "frame px py pz qw qx qy qz verticalFieldOfView");
  EXPECT_EQ(columnsOf(path_, "contact"), "id a b begin end");
  EXPECT_EQ(columnsOf(path_, "contact_force"), "frame contact fx fy fz tx ty tz x y z nx ny nz normal friction");
  EXPECT_EQ(columnsOf(path_, "event"), "time kind a b x y z nx ny nz impulse");
  EXPECT_EQ(columnsOf(path_, "energy"),
            "frame kinetic potential dissipated work px py pz lx ly lz impact friction damping numerical");
}

TEST_F(TrajectorySchema, HasTheKeysOfTheContract) {
  EXPECT_EQ(rows("SELECT key FROM meta ORDER BY key"),
            (std::vector<std::string>{"accuracy", "corrections", "cpuSeconds", "evaluations", "method", "plan",
                                      "promise", "scene", "sceneHash", "scenePath", "stateHash", "version"}));
  EXPECT_EQ(rows("SELECT value FROM meta WHERE key = 'sceneHash'"),
            std::vector<std::string>{textHash(sampleHeader().scene)});
}

TEST_F(TrajectorySchema, CountsCorrectionsByKindAsJson) {
  EXPECT_EQ(rows("SELECT json_extract(value, '$.clampedEnergy'), json_extract(value, '$.unsolvedContacts') FROM meta "
                 "WHERE key = 'corrections'"),
            std::vector<std::string>{"2|1"});
}

// What files of the time before the causes of what was dissipated have.
TEST_F(TrajectorySchema, WithoutCausesIsReadAllTheSame) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open_v2(path_.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database,
                         "ALTER TABLE energy RENAME TO full; CREATE TABLE energy AS SELECT frame, kinetic, potential, "
                         "dissipated, work, px, py, pz, lx, ly, lz FROM full; DROP TABLE full",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  const EnergyBalance energy = TrajectoryReader(path_).readFrame(1).energy;
  expectSameBits(energy.dissipated, sampleFrame(1).energy.dissipated);
  for (const double cause : {energy.impact, energy.friction, energy.damping, energy.numerical})
    EXPECT_TRUE(std::isnan(cause));
}

// What files of the time before contacts were told of have.
TEST_F(TrajectorySchema, WithoutContactsIsReadAllTheSame) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open_v2(path_.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "DROP TABLE contact; DROP TABLE contact_force", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  const TrajectoryReader reader(path_);
  EXPECT_TRUE(reader.contacts().empty());
  EXPECT_TRUE(reader.contactsAt(1).empty());
  EXPECT_EQ(reader.hashOfFrames(), reader.stateHash());
}

// What files of the time before joints were told of have.
TEST_F(TrajectorySchema, WithoutJointsIsReadAllTheSame) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open_v2(path_.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "DROP TABLE joint; DROP TABLE joint_state", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const TrajectoryReader reader(path_);
  EXPECT_TRUE(reader.header().joints.empty());
  EXPECT_TRUE(reader.readFrame(1).joints.empty());
  EXPECT_EQ(reader.hashOfFrames(), reader.stateHash());
}

TEST_F(TrajectorySchema, HoldsJointsAsOthersReadThem) {
  EXPECT_EQ(rows("SELECT * FROM joint ORDER BY id"),
            (std::vector<std::string>{R"(0|lid, "old"|hinge|0|2)", "1|rail|slider|2|null"}));
  EXPECT_EQ(rows("SELECT frame, joint FROM joint_state").size(), 6u);
}

TEST_F(TrajectorySchema, HoldsBodiesAsOthersReadThem) {
  const auto bodies = rows("SELECT id, name, motion, mesh, shape, mass, comy, iyy, ixz, iyz FROM body ORDER BY id");
  ASSERT_EQ(bodies.size(), 3u);
  EXPECT_EQ(bodies[0], R"(0|ball|dynamic|null|{"sphere": {"radius": 1}}|2.5|-0.2|1.2|0.2|-0.3)");
  EXPECT_EQ(bodies[1], R"(1|ground|static|null|{"plane": {"normal": [0, 1, 0]}}|0.0|0.0|0.0|0.0|0.0)");
  EXPECT_EQ(rows("SELECT motion, mesh, shape FROM body WHERE name = 'wedge'"),
            std::vector<std::string>{"dynamic|0|null"});
}

TEST_F(TrajectorySchema, HoldsStatesOfDynamicBodiesOnly) {
  EXPECT_EQ(rows("SELECT frame, body FROM state ORDER BY frame, body"),
            (std::vector<std::string>{"0|0", "0|2", "1|0", "1|2", "2|0", "2|2"}));
  EXPECT_EQ(rows("SELECT id, time FROM frame"), (std::vector<std::string>{"0|0.0", "1|0.125", "2|0.25"}));
  EXPECT_EQ(rows("SELECT frame FROM energy"), (std::vector<std::string>{"0", "1", "2"}));
}

TEST_F(TrajectorySchema, HoldsEventsWithNullForTheWorld) {
  EXPECT_EQ(rows("SELECT time, kind, a, b, x, y, z, nx, ny, nz, impulse FROM event"),
            (std::vector<std::string>{"0.1|impact|0|2|1.0|2.0|3.0|0.0|1.0|0.0|0.7",
                                      "0.2|taut|2|null|0.0|0.0|0.25|0.0|0.0|1.0|1.0e+99"}));
}

TEST_F(TrajectorySchema, HoldsMeshesAsLittleEndianArraysAndJson) {
  EXPECT_EQ(rows("SELECT length(vertices), length(normals), length(triangles) FROM mesh"),
            std::vector<std::string>{"288|144|48"});
  // The second vertex starts with 1.0 = 3ff0 0000 0000 0000, the second triangle is 3, 4, 5.
  EXPECT_EQ(rows("SELECT hex(substr(vertices, 25, 8)), hex(substr(triangles, 13, 12)) FROM mesh"),
            std::vector<std::string>{"000000000000F03F|030000000400000005000000"});
  // Drawn vertices a, b, c, a, d, b, ... of corners that scenes number 0 to 3.
  EXPECT_EQ(rows("SELECT hex(substr(vertexNumbers, 1, 24)), length(vertexNumbers) FROM mesh"),
            std::vector<std::string>{"000000000100000002000000000000000300000001000000|48"});
  EXPECT_EQ(rows("SELECT material FROM mesh"),
            std::vector<std::string>{R"([{"name":"brass, \"old\" \\ \n","baseColor":"#ff0080","firstTriangle":0,)"
                                     R"("triangleCount":3},{"name":"","baseColor":"#00ff00","firstTriangle":3,)"
                                     R"("triangleCount":1}])"});
}

TEST_F(TrajectorySchema, FindsFramesWithoutReadingAllStates) {
  const auto plan = rows("EXPLAIN QUERY PLAN SELECT px FROM state WHERE frame = 1 AND body = 2");
  ASSERT_EQ(plan.size(), 1u);
  EXPECT_NE(plan[0].find("SEARCH state USING PRIMARY KEY"), std::string::npos) << plan[0];
}

TEST_F(TrajectorySchema, PassesTheDatabasesOwnCheck) {
  EXPECT_EQ(rows("PRAGMA integrity_check"), std::vector<std::string>{"ok"});
}

/// A wrench of contact `id` whose numbers tell from which frame it is.
ContactWrench sampleWrench(long id, double number) {
  return {id, 0, 1, Vec3(number, 2, 2), Vec3(0, 2, 0), Vec3(0, 0, number), Vec3(-0.0, 1, 3)};
}

// Contact 0 changes at frames 0 and 2, and goes on; contact 1 is that of frames 1 and 2.
TEST(TrajectorySchemaOfContacts, HasRowsWhereForcesChange) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
  std::vector<std::vector<ContactWrench>> wrenches;
  for (int number = 0; number < 4; ++number) {
    Frame frame = sampleFrame(number);
    if (number == 0) writer.append(LastingContact{0, 0, 1, 0});
    if (number == 1) writer.append(LastingContact{1, 0, 2, 0.5 * frame.time});
    if (number == 3) writer.append(LastingContact{1, 0, 2, 0.25, sampleFrame(2).time});
    frame.contacts.push_back(sampleWrench(0, number < 2 ? 1 : 7));
    if (number == 1 || number == 2) frame.contacts.push_back(sampleWrench(1, number));
    writer.append(frame);
    wrenches.push_back(frame.contacts);
  }
  writer.finish({});
  EXPECT_EQ(rowsOf(folder.file("a.sqlite"), "SELECT frame, contact FROM contact_force ORDER BY contact, frame"),
            (std::vector<std::string>{"0|0", "2|0", "1|1", "2|1"}));
  const TrajectoryReader reader(folder.file("a.sqlite"));
  ASSERT_EQ(reader.contacts().size(), 2u);
  EXPECT_FALSE(reader.contacts()[0].end);
  EXPECT_EQ(*reader.contacts()[1].end, sampleFrame(2).time);
  for (const std::size_t number : {0u, 1u, 2u, 3u, 1u, 0u, 3u}) {  // in any order
    const std::vector<ContactWrench> found = reader.contactsAt(static_cast<long>(number));
    ASSERT_EQ(found.size(), wrenches[number].size()) << number;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].contact, wrenches[number][i].contact);
      EXPECT_EQ(found[i].force, wrenches[number][i].force);
      EXPECT_EQ(found[i].normalForce, wrenches[number][i].normalForce);
      EXPECT_EQ(found[i].torque, wrenches[number][i].torque);
      EXPECT_EQ(found[i].point, wrenches[number][i].point);
    }
  }
}

// An event ends the contact just at frame 1.
TEST(TrajectorySchemaOfContacts, HasNoForceWhereTheContactEndsAtAFrame) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
  Frame frame = sampleFrame(0);
  frame.contacts.push_back(sampleWrench(0, 1));
  writer.append(LastingContact{0, 0, 1, 0});
  writer.append(frame);
  writer.append(LastingContact{0, 0, 1, 0, sampleFrame(1).time});
  writer.append(sampleFrame(1));
  writer.finish({});
  EXPECT_EQ(rowsOf(folder.file("a.sqlite"), "SELECT frame, fx, normal FROM contact_force ORDER BY frame"),
            (std::vector<std::string>{"0|1.0|2.0", "1|0.0|0.0"}));
  const TrajectoryReader reader(folder.file("a.sqlite"));
  EXPECT_EQ(reader.contactsAt(0).size(), 1u);
  EXPECT_TRUE(reader.contactsAt(1).empty());
}

TEST_F(TrajectorySchema, HoldsCamerasAsTheyWereGiven) {
  TrajectoryWriter writer(folder_.file("b.sqlite"), sampleHeader());
  writer.append(sampleFrame(0));
  writer.append(CameraPose{0, {1, 2, 3}, Quat(0.6, 0, 0.8, 0), 0.5});
  writer.finish({});
  EXPECT_EQ(rowsOf(folder_.file("b.sqlite"), "SELECT * FROM camera"),
            std::vector<std::string>{"0|1.0|2.0|3.0|0.6|0.0|0.8|0.0|0.5"});
  const std::vector<CameraPose> cameras = TrajectoryReader(folder_.file("b.sqlite")).cameras();
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_EQ(cameras[0].frame, 0);
  EXPECT_EQ(cameras[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(cameras[0].orientation.coeffs(), Quat(0.6, 0, 0.8, 0).coeffs());
  EXPECT_EQ(cameras[0].verticalFieldOfView, 0.5);
}

}  // namespace
}  // namespace cradle
