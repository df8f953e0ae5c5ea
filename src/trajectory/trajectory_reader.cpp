// The file may have been cut, changed or made up. Everything that later code relies on (sizes, ranges, order, finite
// numbers) is checked here, where it can still be reported as a fault of the file.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "core/read_file.h"
#include "trajectory/database.h"
#include "trajectory/trajectory_file.h"
#include "trajectory/trajectory_schema.h"

namespace cradle {
namespace {

// The header of a SQLite file. ("Database File Format" on sqlite.org, section 1.3)
constexpr std::string_view kMagic("SQLite format 3\0", 16);
constexpr std::size_t kHeaderSize = 100, kApplicationIdAt = 68;  // bytes; the id is big-endian
constexpr std::size_t kVersionsAt = 18;                          // of writing and reading: 1, or kWithLog
constexpr char kWithLog = 2;
constexpr double kLatestTime = 1e10;        // s: scenes last 1e9 s at most
constexpr int kLongestValue = 64'000'000;   // bytes of a value of the table meta: the longest scene that is read
constexpr std::size_t kLongestName = 1100;  // bytes of a body's: 250 characters and the number of a copy
constexpr const char* kMaterialsOfMesh =
    "SELECT value ->> 'name', value ->> 'baseColor', value ->> 'firstTriangle', value ->> 'triangleCount', "
    "value ->> 'texture' "
    "FROM mesh, json_each(mesh.material) WHERE mesh.id = ?";
constexpr const char* kTableNames = "('meta', 'mesh', 'body', 'frame', 'state', 'event', 'energy')";
constexpr const char* kJointTableNames = "('joint', 'joint_state')";        // which earlier versions did not write
constexpr const char* kContactTableNames = "('contact', 'contact_force')";  // the same
constexpr const char* kCameraTableNames = "('camera')";
constexpr const char* kTextureTableNames = "('texture', 'texture_coordinates')";  // only where there are textures

/// The first bytes of a file, or all; empty if it cannot be read.
std::string fileHeaderOf(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return "";
  std::string header(kHeaderSize, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(header.data(), kHeaderSize);
  return header.substr(0, static_cast<std::size_t>(file.gcount()));
}

std::int64_t oneInteger(Database& database, const std::string& sql) {
  Statement query = database.prepare(sql);
  if (!query.step()) database.failDamaged("a row is missing");
  return query.integer(0);
}

std::int64_t countTables(Database& database, const char* names) {
  return oneInteger(database,
                    fmt::format("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN {}", names));
}

/// Tables that compute what they give could give without end.
void requireStored(Database& database, const char* names) {
  const bool isStored =
      oneInteger(database,
                 fmt::format("SELECT count(*) FROM sqlite_master WHERE rootpage = 0 AND name IN {}", names)) == 0 &&
      oneInteger(database, fmt::format("SELECT count(*) FROM sqlite_master AS t, pragma_table_xinfo(t.name) AS c WHERE "
                                       "t.type = 'table' AND t.name IN {} AND c.hidden <> 0",
                                       names)) == 0;
  if (!isStored) database.failDamaged("a table computes its columns instead of holding them");
}

void requireTrajectory(Database& database, const std::string& path) {
  const bool isOurs =
      oneInteger(database, "PRAGMA application_id") == kApplicationId && countTables(database, kTableNames) == 7;
  if (!isOurs) throw Error(ErrorKind::usage, path, "is a SQLite database, but not a trajectory of cradle");
  requireStored(database, kTableNames);
  requireStored(database, kJointTableNames);
  requireStored(database, kContactTableNames);
  requireStored(database, kCameraTableNames);
  requireStored(database, kTextureTableNames);
  const std::int64_t version = oneInteger(database, "PRAGMA user_version");
  if (version != kSchemaVersion)
    throw Error(
        ErrorKind::usage, path,
        fmt::format("has version {} of the trajectory tables; this program reads version {}", version, kSchemaVersion));
}

/// An array as the file has it, element by element of `Element`.
template <class Element>
std::vector<Element> arrayOf(const Statement& row, int column, const Database& database) {
  const auto bytes = row.blob(column);
  if (bytes.size() % sizeof(Element) != 0) database.failDamaged("an array of a mesh ends in mid-element");
  std::vector<Element> elements(bytes.size() / sizeof(Element));
  std::ranges::copy(bytes, std::as_writable_bytes(std::span(elements)).begin());
  return elements;
}

Vec3f colorFromHex(const std::string& text, const Database& database) {
  unsigned red = 0, green = 0, blue = 0;
  if (text.size() != 7 || std::sscanf(text.c_str(), "#%2x%2x%2x", &red, &green, &blue) != 3)
    database.failDamaged("a colour of a mesh is not #rrggbb");
  return Vec3f(static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)) / 255.0f;
}

/// Texture coordinates by mesh, of those that have any.
std::map<std::int64_t, std::vector<Vec2f>> readCoordinates(Database& database) {
  std::map<std::int64_t, std::vector<Vec2f>> coordinates;
  if (countTables(database, kTextureTableNames) < 2) return coordinates;
  Statement query = database.prepare("SELECT mesh, coordinates FROM texture_coordinates");
  while (query.step()) coordinates[query.integer(0)] = arrayOf<Vec2f>(query, 1, database);
  return coordinates;
}

/// The texture that a row names, or none.
SharedTexture textureAt(const Statement& row, int column, const std::vector<SharedTexture>& textures,
                        const Database& database) {
  if (row.isNull(column)) return nullptr;
  const std::int64_t id = row.integer(column);
  if (id < 0 || id >= std::ssize(textures)) database.failDamaged("a mesh has a texture that is not there");
  return textures[static_cast<std::size_t>(id)];
}

/// The ranges of a mesh of so many triangles, at most one for each; `query` is kMaterialsOfMesh.
std::vector<ModelMaterial> readMaterials(Statement& query, const Database& database, std::int64_t mesh,
                                         std::size_t triangles, const std::vector<SharedTexture>& textures) {
  query.reset();
  query.bind(1, mesh);
  std::vector<ModelMaterial> materials;
  std::int64_t next = 0;
  while (query.step()) {
    const std::int64_t first = query.integer(2), count = query.integer(3);
    if (materials.size() == triangles) database.failDamaged("a mesh has more materials than triangles");
    if (first != next || count < 0 || count > UINT32_MAX - first)
      database.failDamaged("the materials of a mesh do not follow one another");
    next = first + count;
    materials.push_back({query.text(0), colorFromHex(query.text(1), database), static_cast<std::uint32_t>(first),
                         static_cast<std::uint32_t>(count), textureAt(query, 4, textures, database)});
  }
  return materials;
}

void requireConsistent(const DrawnMesh& drawn, const Database& database) {
  const auto hasLength = [](const Vec3f& normal) { return std::isfinite(normal.squaredNorm()); };
  const auto inRange = [&](const Triangle& triangle) {
    return std::all_of(triangle.begin(), triangle.end(), [&](auto vertex) { return vertex < drawn.vertices.size(); });
  };
  if (drawn.normals.size() != drawn.vertices.size()) database.failDamaged("a mesh has not one normal a vertex");
  if (!std::all_of(drawn.normals.begin(), drawn.normals.end(), hasLength))
    database.failDamaged("a mesh has normals of no finite length");
  if (!std::all_of(drawn.vertices.begin(), drawn.vertices.end(), isPossiblePlace))
    database.failDamaged("a mesh has vertices whose coordinates are not finite and below 1e30 m");
  const auto isFinite = [](const Vec2f& place) { return place.allFinite(); };
  if (!drawn.textureCoordinates.empty() && drawn.textureCoordinates.size() != drawn.vertices.size())
    database.failDamaged("a mesh has not one pair of texture coordinates a vertex");
  if (!std::all_of(drawn.textureCoordinates.begin(), drawn.textureCoordinates.end(), isFinite))
    database.failDamaged("a mesh has texture coordinates that are not finite");
  if (!std::all_of(drawn.triangles.begin(), drawn.triangles.end(), inRange))
    database.failDamaged("a mesh has triangles between vertices that it does not have");
  if (drawn.materials.empty()) return;
  const ModelMaterial& last = drawn.materials.back();
  if (std::size_t{last.firstTriangle} + last.triangleCount != drawn.triangles.size())
    database.failDamaged("the materials of a mesh do not cover its triangles");
}

/// The three numbers from column `first` on.
Vec3 vectorAt(const Statement& row, int first) {
  return {row.real(first), row.real(first + 1), row.real(first + 2)};
}

BodyState stateAt(const Statement& row, int first) {
  return {vectorAt(row, first),
          Quat(row.real(first + 3), row.real(first + 4), row.real(first + 5), row.real(first + 6)),
          vectorAt(row, first + 7), vectorAt(row, first + 10)};
}

MassProperties massPropertiesAt(const Statement& row, int first) {
  MassProperties properties{row.real(first), vectorAt(row, first + 1), Mat3::Zero()};
  Mat3& inertia = properties.inertiaTensor;
  inertia.diagonal() = vectorAt(row, first + 4);
  inertia(0, 1) = inertia(1, 0) = row.real(first + 7);
  inertia(0, 2) = inertia(2, 0) = row.real(first + 8);
  inertia(1, 2) = inertia(2, 1) = row.real(first + 9);
  return properties;
}

/// A body's number; `who` names it.
int bodyAt(const Statement& row, int column, const TrajectoryHeader& header, const Database& database,
           const char* who) {
  const std::int64_t id = row.integer(column);
  if (id < 0 || id >= static_cast<std::int64_t>(header.bodies.size()))
    database.failDamaged(fmt::format("{} names a body that is not there", who));
  return static_cast<int>(id);
}

/// The same, or -1: null is the world.
int bodyOrWorldAt(const Statement& row, int column, const TrajectoryHeader& header, const Database& database,
                  const char* who) {
  return row.isNull(column) ? -1 : bodyAt(row, column, header, database, who);
}

/// Earlier versions did not write the causes of what was dissipated.
std::string energyQuery(Database& database) {
  const bool hasCauses =
      oneInteger(database, "SELECT count(*) FROM pragma_table_info('energy') WHERE name = 'numerical'") == 1;
  return fmt::format(
      "SELECT kinetic, potential, dissipated, work, px, py, pz, lx, ly, lz, {} FROM energy WHERE frame = ?",
      hasCauses ? "impact, friction, damping, numerical" : "NULL, NULL, NULL, NULL");
}

}  // namespace

struct TrajectoryReader::Session {
  explicit Session(std::unique_ptr<Database> whole) : database(std::move(whole)) {
    state.emplace(
        database->prepare("SELECT body, px, py, pz, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz FROM state "
                          "WHERE frame = ? ORDER BY body"));
    energy.emplace(database->prepare(energyQuery(*database)));
    if (countTables(*database, kJointTableNames) == 2)
      joint.emplace(database->prepare(
          "SELECT joint, coordinate, velocity, force FROM joint_state WHERE frame = ? ORDER BY joint"));
  }

  /// Contacts and their last rows up to a frame.
  struct Forces {
    std::optional<std::vector<LastingContact>> contacts;  // once they are asked for
    std::map<long, ContactWrench> latest;
    long nextFrame = 0;
  };

  std::unique_ptr<Database> database;
  Forces forces;
  std::optional<Statement> state, energy;
  std::optional<Statement> joint;  // none in files of earlier versions
};

TrajectoryReader::TrajectoryReader(const std::string& path) : path_(path) {
  requireRegularFile(path, ErrorKind::usage);
  // Asked first because SQLite takes an empty file for a database.
  if (!isDatabaseFile(path)) throw Error(ErrorKind::usage, path, "is not a trajectory (or cannot be read)");
  const std::string header = fileHeaderOf(path);
  if (header.size() < kHeaderSize) throw Error(ErrorKind::usage, path, "is not a trajectory: it is cut off");
  if (header[kVersionsAt] == kWithLog || header[kVersionsAt + 1] == kWithLog)
    throw Error(
        ErrorKind::usage, path,
        "keeps its changes in a log beside it, which cradle never does and does not read; `sqlite3 FILE 'PRAGMA "
        "journal_mode = DELETE'` takes them in");
  auto database = std::make_unique<Database>(path, DatabaseAccess::read);
  requireTrajectory(*database, path);
  session_ = std::make_unique<Session>(std::move(database));
  readAll();
}

TrajectoryReader::TrajectoryReader(TrajectoryWriter& finished) : session_(new Session(finished.release())) {
  readAll();
}

void TrajectoryReader::readAll() {
  readMeta();
  readTextures();
  readMeshes();
  readBodies();
  if (session_->joint) readJoints();
  readFrameTimes();
}

TrajectoryReader::TrajectoryReader(TrajectoryReader&&) noexcept = default;
TrajectoryReader::~TrajectoryReader() = default;

void TrajectoryReader::readMeta() {
  Statement query = session_->database->prepare(
      fmt::format("SELECT key, CASE WHEN length(CAST(value AS BLOB)) <= {} THEN value END FROM meta", kLongestValue));
  while (query.step()) {
    if (query.isNull(1))
      session_->database->failDamaged(
          fmt::format("its table meta has a value that is missing or longer than {} bytes", kLongestValue));
    meta_[query.text(0)] = query.anyAsText(1);
  }
  const auto value = [&](const char* key) {
    const auto found = meta_.find(key);
    if (found == meta_.end()) session_->database->failDamaged(fmt::format("its table meta has no {}", key));
    return found->second;
  };
  header_.scene = value("scene");
  header_.scenePath = value("scenePath");
  header_.version = value("version");
  header_.plan = value("plan");
  header_.accuracy = value("accuracy");
  header_.method = value("method");
  if (textHash(header_.scene) != value("sceneHash"))
    session_->database->failDamaged("its scene is not the one that was run (sceneHash)");
}

void TrajectoryReader::readTextures() {
  Database& database = *session_->database;
  if (countTables(database, kTextureTableNames) < 2) return;
  Statement query = database.prepare("SELECT id, name, image FROM texture ORDER BY id");
  while (query.step()) {
    if (query.integer(0) != std::ssize(header_.textures)) database.failDamaged("a texture is missing");
    const auto bytes = query.blob(2);
    header_.textures.push_back(std::make_shared<const Texture>(
        Texture{query.text(1), std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())}));
  }
}

void TrajectoryReader::readMeshes() {
  Database& database = *session_->database;
  Statement query = database.prepare("SELECT id, name, vertices, normals, triangles FROM mesh ORDER BY id");
  Statement materials = database.prepare(kMaterialsOfMesh);
  const auto coordinates = readCoordinates(database);
  while (query.step()) {
    if (query.integer(0) != static_cast<std::int64_t>(header_.meshes.size())) database.failDamaged("a mesh is missing");
    Model model;
    model.name = query.text(1);
    model.drawn.vertices = arrayOf<Vec3>(query, 2, database);
    model.drawn.normals = arrayOf<Vec3f>(query, 3, database);
    model.drawn.triangles = arrayOf<Triangle>(query, 4, database);
    if (const auto places = coordinates.find(query.integer(0)); places != coordinates.end())
      model.drawn.textureCoordinates = places->second;
    model.drawn.materials =
        readMaterials(materials, database, query.integer(0), model.drawn.triangles.size(), header_.textures);
    requireConsistent(model.drawn, database);
    model.solid = weld(model.drawn.vertices, model.drawn.triangles);
    header_.meshes.push_back(std::move(model));
  }
}

void TrajectoryReader::readBodies() {
  Database& database = *session_->database;
  Statement query = database.prepare(
      "SELECT id, name, motion, mesh, shape, mass, comx, comy, comz, ixx, iyy, izz, ixy, ixz, iyz FROM body ORDER BY "
      "id");
  while (query.step()) {
    const auto id = static_cast<std::int64_t>(header_.bodies.size());
    const std::string name = query.text(1), motion = query.text(2);
    if (name.size() > kLongestName)
      database.failDamaged(
          fmt::format("body {} has a name of {} bytes; scenes have at most {}", id, name.size(), kLongestName));
    const bool hasMesh = !query.isNull(3);
    const std::int64_t mesh = hasMesh ? query.integer(3) : -1;
    if (query.integer(0) != id) database.failDamaged("a body is missing");
    if (motion != "dynamic" && motion != "static" && motion != "driven")
      database.failDamaged("a body is neither dynamic nor static nor driven");
    if (hasMesh && (mesh < 0 || mesh >= static_cast<std::int64_t>(header_.meshes.size())))
      database.failDamaged("a body has a mesh that is not there");
    const MassProperties properties = massPropertiesAt(query, 5);
    if (motion == "dynamic" && !(properties.mass > 0 && properties.inertiaTensor.diagonal().minCoeff() > 0))
      database.failDamaged(fmt::format("body \"{}\" has a mass or a moment of inertia that is not above 0", name));
    if (!isPossiblePlace(properties.centerOfMass))
      database.failDamaged(fmt::format("body \"{}\" has its centre of mass 1e30 m away or more", name));
    if (motion != "static") movingBodies_.push_back(static_cast<int>(id));
    header_.bodies.push_back({name, motion == "dynamic", motion == "driven", static_cast<int>(mesh),
                              hasMesh ? "" : query.text(4), properties});
  }
}

void TrajectoryReader::readJoints() {
  Database& database = *session_->database;
  Statement query = database.prepare("SELECT id, name, kind, a, b FROM joint ORDER BY id");
  while (query.step()) {
    if (query.integer(0) != static_cast<std::int64_t>(header_.joints.size()))
      database.failDamaged("a joint is missing");
    header_.joints.push_back({query.text(1), query.text(2), bodyAt(query, 3, header_, database, "a joint"),
                              bodyOrWorldAt(query, 4, header_, database, "a joint")});
    const JointRecord& joint = header_.joints.back();
    if (joint.name.size() > kLongestName)
      database.failDamaged("a joint has a name that is longer than those of scenes");
    if (joint.kind != "hinge" && joint.kind != "slider")
      database.failDamaged("a joint is neither a hinge nor a slider");
  }
}

void TrajectoryReader::readFrameTimes() {
  Database& database = *session_->database;
  Statement query = database.prepare("SELECT id, time FROM frame ORDER BY id");
  while (query.step()) {
    if (query.integer(0) != frameCount()) database.failDamaged(fmt::format("frame {} is missing", frameCount()));
    const double time = query.real(1);
    if (frameTimes_.empty() ? time < 0 : time <= frameTimes_.back())
      database.failDamaged("its frames are not in order of time, from 0 on");
    if (time > kLatestTime)
      database.failDamaged(fmt::format("frame {} is at {} s, later than any simulation ends", frameCount(), time));
    frameTimes_.push_back(time);
  }
  if (isFinished() && frameTimes_.empty()) database.failDamaged("its frames are missing");
}

Frame TrajectoryReader::readFrame(long number) const {
  CRADLE_CHECK(number >= 0 && number < frameCount());
  Frame frame;
  frame.number = number;
  frame.time = frameTimes_[static_cast<std::size_t>(number)];
  const auto fail = [&](const char* what) {
    session_->database->failDamaged(fmt::format("{} of frame {} are not those of its bodies", what, number));
  };

  Statement& state = *session_->state;
  state.reset();
  state.bind(1, number);
  for (const int body : movingBodies_) {
    if (!state.step() || state.integer(0) != body) fail("the states");
    frame.states.push_back(stateAt(state, 1));
    if (!isPossible(frame.states.back()))
      session_->database->failDamaged(fmt::format("frame {} has a state of body \"{}\" that no body can have", number,
                                                  header_.bodies[static_cast<std::size_t>(body)].name));
  }
  if (state.step()) fail("the states");
  state.reset();

  Statement& energy = *session_->energy;
  energy.reset();
  energy.bind(1, number);
  if (!energy.step()) fail("the energies");
  const auto cause = [&](int column) { return energy.isNull(column) ? NAN : energy.real(column); };
  frame.energy = {energy.real(0), energy.real(1), energy.real(2), cause(10),           cause(11),
                  cause(12),      cause(13),      energy.real(3), vectorAt(energy, 4), vectorAt(energy, 7)};
  energy.reset();
  readJointStates(frame);
  return frame;
}

void TrajectoryReader::readJointStates(Frame& frame) const {
  if (header_.joints.empty()) return;
  Statement& query = *session_->joint;
  query.reset();
  query.bind(1, frame.number);
  const auto fail = [&] {
    session_->database->failDamaged(
        fmt::format("the states of joints of frame {} are not those of its joints", frame.number));
  };
  for (std::size_t i = 0; i < header_.joints.size(); ++i) {
    if (!query.step() || query.integer(0) != static_cast<std::int64_t>(i)) fail();
    frame.joints.push_back({query.real(1), query.real(2), query.real(3)});
  }
  if (query.step()) fail();
  query.reset();
}

bool TrajectoryReader::hasContacts() const {
  return countTables(*session_->database, kContactTableNames) == 2;
}

std::vector<LastingContact> TrajectoryReader::contacts() const {
  Database& database = *session_->database;
  std::vector<LastingContact> contacts;
  if (!hasContacts()) return contacts;
  Statement query = database.prepare("SELECT id, a, b, begin, end FROM contact ORDER BY id");
  while (query.step()) {
    if (query.integer(0) != std::ssize(contacts)) database.failDamaged("a contact is missing");
    contacts.push_back({static_cast<long>(query.integer(0)), bodyAt(query, 1, header_, database, "a contact"),
                        bodyAt(query, 2, header_, database, "a contact"), query.real(3)});
    LastingContact& contact = contacts.back();
    if (!query.isNull(4)) contact.end = query.real(4);
    if (!(contact.begin >= 0 && contact.end.value_or(contact.begin) >= contact.begin &&
          contact.end.value_or(contact.begin) <= kLatestTime))
      database.failDamaged(fmt::format("contact {} lasts when none can", contact.id));
  }
  return contacts;
}

std::optional<TrajectoryReader::StoredCheckpoint> TrajectoryReader::checkpoint() const {
  Database& database = *session_->database;
  if (countTables(database, "('checkpoint')") < 1) return std::nullopt;
  Statement query = database.prepare("SELECT record, fingerprint, stateHash FROM checkpoint");
  if (!query.step()) return std::nullopt;
  const std::span<const std::byte> record = query.blob(0);
  return StoredCheckpoint{std::string(reinterpret_cast<const char*>(record.data()), record.size()), query.text(1),
                          query.text(2)};
}

std::vector<CameraPose> TrajectoryReader::cameras() const {
  Database& database = *session_->database;
  std::vector<CameraPose> cameras;
  if (countTables(database, kCameraTableNames) < 1) return cameras;
  Statement query =
      database.prepare("SELECT frame, px, py, pz, qw, qx, qy, qz, verticalFieldOfView FROM camera ORDER BY frame");
  while (query.step()) {
    const CameraPose camera{static_cast<long>(query.integer(0)), vectorAt(query, 1),
                            Quat(query.real(4), query.real(5), query.real(6), query.real(7)), query.real(8)};
    if (!isPossible({camera.position, camera.orientation, Vec3::Zero(), Vec3::Zero()}) ||
        !(camera.verticalFieldOfView > 0 && camera.verticalFieldOfView < std::numbers::pi))
      database.failDamaged(fmt::format("the camera of frame {} is none that can be", camera.frame));
    cameras.push_back(camera);
  }
  return cameras;
}

std::vector<ContactWrench> TrajectoryReader::contactsAt(long number) const {
  CRADLE_CHECK(number >= 0 && number < frameCount());
  Session::Forces& forces = session_->forces;
  if (!forces.contacts) forces.contacts = contacts();
  if (number < forces.nextFrame) forces = {std::move(forces.contacts), {}, 0};
  if (!forces.contacts->empty()) readForcesUntil(number);
  forces.nextFrame = number + 1;
  const double time = frameTimes_[static_cast<std::size_t>(number)];
  std::erase_if(forces.latest, [&](const auto& latest) {
    return (*forces.contacts)[static_cast<std::size_t>(latest.first)].end.value_or(time) < time;
  });
  std::vector<ContactWrench> now;
  for (const auto& [id, wrench] : forces.latest)
    if (!wrench.force.isZero(0)) now.push_back(wrench);
  return now;
}

/// Takes the rows of forces from the frame after the last one on up to a frame.
void TrajectoryReader::readForcesUntil(long number) const {
  Database& database = *session_->database;
  Session::Forces& forces = session_->forces;
  Statement query = database.prepare(
      "SELECT contact, fx, fy, fz, tx, ty, tz, x, y, z, nx, ny, nz, normal FROM contact_force "
      "WHERE frame BETWEEN ? AND ? ORDER BY frame");
  query.bind(1, forces.nextFrame);
  query.bind(2, number);
  while (query.step()) {
    const std::int64_t id = query.integer(0);
    if (id < 0 || id >= std::ssize(*forces.contacts))
      database.failDamaged("a force of a contact is of one that is not there");
    const LastingContact& contact = (*forces.contacts)[static_cast<std::size_t>(id)];
    const ContactWrench wrench{
        contact.id,         contact.bodyA,     contact.bodyB, vectorAt(query, 1), query.real(13) * vectorAt(query, 10),
        vectorAt(query, 4), vectorAt(query, 7)};
    for (const Vec3& vector : {wrench.force, wrench.normalForce, wrench.torque, wrench.point})
      if (!(vector.norm() < kLargestNumber))
        database.failDamaged(fmt::format("a force of contact {} is none that can be", id));
    forces.latest[contact.id] = wrench;
  }
}

std::vector<Event> TrajectoryReader::events() const {
  Database& database = *session_->database;
  Statement query = database.prepare("SELECT time, kind, a, b, x, y, z, nx, ny, nz, impulse FROM event ORDER BY rowid");
  const auto kind = [&](const std::string& name) {
    try {
      return eventKindFromName(name);
    } catch (const Error&) {
      database.failDamaged(fmt::format("it has an event of unknown kind \"{}\"", name));
    }
  };
  std::vector<Event> events;
  while (query.step()) {
    events.push_back({query.real(0), kind(query.text(1)), bodyAt(query, 2, header_, database, "an event"),
                      bodyOrWorldAt(query, 3, header_, database, "an event"), vectorAt(query, 4), vectorAt(query, 7),
                      query.real(10)});
    const Event& event = events.back();
    if (!isPossiblePlace(event.point) || !isPossiblePlace(event.normal) || std::abs(event.time) > kLatestTime)
      database.failDamaged(fmt::format("an event \"{}\" is where or when none can be", eventKindName(event.kind)));
  }
  return events;
}

std::optional<double> TrajectoryReader::horizon() const {
  const auto text = meta_.find(kHorizonKey);
  if (text == meta_.end()) return std::nullopt;
  for (std::size_t frame = 0; frame < frameTimes_.size(); ++frame)
    if (text->second == std::to_string(frame)) return frameTimes_[frame];
  return std::nullopt;
}

std::string TrajectoryReader::stateHash() const {
  const auto found = meta_.find("stateHash");
  return found == meta_.end() ? "" : found->second;
}

std::string TrajectoryReader::hashOfFrames() const {
  Hash hash;
  for (long number = 0; number < frameCount(); ++number) addFrame(readFrame(number), hash);
  if (isFinished() && hash.hex() != stateHash())
    session_->database->failDamaged("its frames are not those that were written (stateHash)");
  return hash.hex();
}

bool TrajectoryReader::hasFailed() const {
  const auto promise = meta_.find("promise");
  return promise != meta_.end() && promise->second.starts_with(kFailedRun);
}

RunCost TrajectoryReader::cost() const {
  Statement query = session_->database->prepare(
      "SELECT (SELECT value FROM meta WHERE key = 'cpuSeconds'), (SELECT value FROM meta WHERE key = 'evaluations')");
  if (!isFinished() || !query.step()) return {};
  return {query.real(0), query.integer(1)};
}

bool isDatabaseFile(const std::string& path) {
  return fileHeaderOf(path).starts_with(kMagic);
}

bool isTrajectoryFile(const std::string& path) {
  const std::string header = fileHeaderOf(path);
  if (!header.starts_with(kMagic) || header.size() < kHeaderSize) return false;
  std::uint32_t id = 0;
  for (std::size_t i = 0; i < 4; ++i) id = id << 8 | static_cast<unsigned char>(header[kApplicationIdAt + i]);
  return id == kApplicationId;
}

void requireNoOtherFile(const std::string& path) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed || size == 0 || isTrajectoryFile(path)) return;
  throw Error(ErrorKind::output, path, "is there, and is no trajectory: it is not replaced; give another name");
}

}  // namespace cradle
