// One transaction is open at nearly all times: committed every half second, so that a killed run keeps what it had, and
// begun at once again, so that a second run on the same file notices.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "core/error.h"
#include "core/output_path.h"
#include "core/part_lock.h"
#include "mesh/number_distinct.h"
#include "trajectory/database.h"
#include "trajectory/trajectory_file.h"
#include "trajectory/trajectory_schema.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

static_assert(sizeof(Vec3) == 24 && sizeof(Vec3f) == 12 && sizeof(Vec2f) == 8 && sizeof(Triangle) == 12,
              "arrays are stored as they are");

/// Makes room for a new .part. (SQLite itself drops a journal that it finds beside an empty file.)
void removeOldPart(const std::string& part) {
  const auto status = fs::symlink_status(part);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(ErrorKind::output, part, "is in the way and is not a regular file; remove it or choose another name");
  if (isDatabaseFile(part) && isBeingWritten(part))
    throw Error(ErrorKind::output, part,
                fmt::format("is being written by another run ({}); wait for its end or choose another name",
                            lockHolderOf(part)));
  requireNoWriter(part);
  std::error_code failed;
  fs::remove(part, failed);
  if (failed) throw Error(ErrorKind::output, part, "is in the way and cannot be removed: " + failed.message());
}

std::string hexColor(const Vec3f& color) {
  const auto channel = [](float value) { return std::lround(255 * std::clamp(value, 0.0f, 1.0f)); };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(color.x()), channel(color.y()), channel(color.z()));
}

/// Those of a scene's materials, then those that meshes have besides.
std::vector<SharedTexture> texturesOf(const TrajectoryHeader& header) {
  std::vector<SharedTexture> textures = header.textures;
  for (const Model& mesh : header.meshes)
    for (const ModelMaterial& material : mesh.drawn.materials)
      if (material.texture && std::find(textures.begin(), textures.end(), material.texture) == textures.end())
        textures.push_back(material.texture);
  return textures;
}

void insertTextures(Database& database, const std::vector<SharedTexture>& textures, const std::vector<Model>& meshes) {
  if (textures.empty()) return;
  database.execute(kTextureTables);
  Statement insert = database.prepare("INSERT INTO texture VALUES (?, ?, ?)");
  for (std::size_t id = 0; id < textures.size(); ++id) {
    insert.bind(1, id);
    insert.bind(2, textures[id]->name);
    insert.bind(3, std::as_bytes(std::span(textures[id]->bytes)));
    insert.run();
  }
  Statement place = database.prepare("INSERT INTO texture_coordinates VALUES (?, ?)");
  for (std::size_t id = 0; id < meshes.size(); ++id) {
    if (meshes[id].drawn.textureCoordinates.empty()) continue;
    place.bind(1, id);
    place.bind(2, std::as_bytes(std::span(meshes[id].drawn.textureCoordinates)));
    place.run();
  }
}

std::string materialsAsJson(const std::vector<ModelMaterial>& materials, const std::vector<SharedTexture>& textures,
                            Database& database) {
  Statement object = database.prepare(  // a patch with null leaves the key out
      "SELECT json_patch(json_object('name', ?, 'baseColor', ?, 'firstTriangle', ?, 'triangleCount', ?), "
      "json_object('texture', ?))");
  std::string json;
  for (const ModelMaterial& material : materials) {
    object.bind(1, material.name);
    object.bind(2, hexColor(material.baseColor));
    object.bind(3, material.firstTriangle);
    object.bind(4, material.triangleCount);
    const auto texture = std::find(textures.begin(), textures.end(), material.texture);
    texture == textures.end() ? object.bindNull(5) : object.bind(5, texture - textures.begin());
    object.step();
    if (!json.empty()) json += ',';
    json += object.text(0);
    object.reset();
  }
  return "[" + json + "]";
}

void insertMeta(Database& database, const std::string& key, const auto& value) {
  Statement insert = database.prepare("INSERT INTO meta VALUES (?, ?)");
  insert.bind(1, key);
  insert.bind(2, value);
  insert.run();
}

void insertMeshes(Database& database, const std::vector<Model>& meshes, const std::vector<SharedTexture>& textures) {
  Statement insert = database.prepare("INSERT INTO mesh VALUES (?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t id = 0; id < meshes.size(); ++id) {
    const DrawnMesh& drawn = meshes[id].drawn;
    CRADLE_CHECK(drawn.normals.size() == drawn.vertices.size());
    insert.bind(1, id);
    insert.bind(2, meshes[id].name);
    insert.bind(3, std::as_bytes(std::span(drawn.vertices)));
    insert.bind(4, std::as_bytes(std::span(drawn.normals)));
    insert.bind(5, std::as_bytes(std::span(drawn.triangles)));
    insert.bind(6, materialsAsJson(drawn.materials, textures, database));
    const Numbering welded = numberPositions(drawn.vertices);
    insert.bind(7, std::as_bytes(std::span(welded.numberOf)));
    insert.run();
  }
}

template <std::size_t N>
void bindNumbers(Statement& statement, int firstParameter, const std::array<double, N>& numbers) {
  for (std::size_t i = 0; i < N; ++i) statement.bind(firstParameter + static_cast<int>(i), numbers[i]);
}

void insertBodies(Database& database, const TrajectoryHeader& header) {
  Statement insert = database.prepare("INSERT INTO body VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t id = 0; id < header.bodies.size(); ++id) {
    const BodyRecord& body = header.bodies[id];
    const bool hasMesh = body.mesh >= 0;
    CRADLE_CHECK(hasMesh ? static_cast<std::size_t>(body.mesh) < header.meshes.size() : !body.shape.empty());
    insert.bind(1, id);
    insert.bind(2, body.name);
    insert.bind(3, body.isDynamic ? "dynamic" : body.isDriven ? "driven" : "static");
    hasMesh ? insert.bind(4, body.mesh) : insert.bindNull(4);
    hasMesh ? insert.bindNull(5) : insert.bind(5, body.shape);
    const MassProperties& m = body.massProperties;
    const Mat3& inertia = m.inertiaTensor;
    bindNumbers(insert, 6,
                std::array{m.mass, m.centerOfMass.x(), m.centerOfMass.y(), m.centerOfMass.z(), inertia(0, 0),
                           inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2)});
    insert.run();
  }
}

/// The world is null.
void bindBody(Statement& statement, int parameter, int body) {
  body < 0 ? statement.bindNull(parameter) : statement.bind(parameter, body);
}

void insertJoints(Database& database, const TrajectoryHeader& header) {
  Statement insert = database.prepare("INSERT INTO joint VALUES (?, ?, ?, ?, ?)");
  for (std::size_t id = 0; id < header.joints.size(); ++id) {
    const JointRecord& joint = header.joints[id];
    insert.bind(1, id);
    insert.bind(2, joint.name);
    insert.bind(3, joint.kind);
    insert.bind(4, joint.bodyA);
    bindBody(insert, 5, joint.bodyB);
    insert.run();
  }
}

void insertHeader(Database& database, const TrajectoryHeader& header) {
  insertMeta(database, "scene", header.scene);
  insertMeta(database, "sceneHash", textHash(header.scene));
  insertMeta(database, "scenePath", header.scenePath);
  insertMeta(database, "version", header.version);
  insertMeta(database, "plan", header.plan);
  insertMeta(database, "accuracy", header.accuracy);
  insertMeta(database, "method", header.method);
  const std::vector<SharedTexture> textures = texturesOf(header);
  insertTextures(database, textures, header.meshes);
  insertMeshes(database, header.meshes, textures);
  insertBodies(database, header);
  insertJoints(database, header);
}

/// {"name": count, ...}; names are plain words.
std::string countsAsJson(const std::map<std::string, long>& counts) {
  std::string json;
  for (const auto& [name, count] : counts) json += fmt::format("{}\"{}\": {}", json.empty() ? "" : ", ", name, count);
  return "{" + json + "}";
}

std::array<double, 14> energyNumbers(const EnergyBalance& energy) {
  const Vec3 &p = energy.momentum, &l = energy.angularMomentum;
  return {
      energy.kinetic, energy.potential, energy.dissipated, energy.work,    p.x(),           p.y(), p.z(), l.x(), l.y(),
      l.z(),          energy.impact,    energy.friction,   energy.damping, energy.numerical};
}

std::array<double, 14> forceNumbers(const ContactWrench& wrench) {
  const Vec3 &f = wrench.force, &t = wrench.torque, &at = wrench.point;
  const Vec3 n = wrench.normalForce.stableNormalized();
  const double normal = wrench.normalForce.norm(), friction = (f - wrench.normalForce).norm();
  return {f.x(), f.y(), f.z(), t.x(), t.y(), t.z(), at.x(), at.y(), at.z(), n.x(), n.y(), n.z(), normal, friction};
}

template <std::size_t N>
bool allPossible(const std::array<double, N>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::abs(number) < kLargestNumber; });
}

[[noreturn]] void failNotFinite(double time, const std::string& whose) {
  throw Error(ErrorKind::unstable, "", fmt::format("at {} s, the {} is no longer a finite number", time, whose));
}

/// Begins the transaction that holds the empty tables.
void createTables(Database& database) {
  database.execute("BEGIN IMMEDIATE");
  database.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId, kSchemaVersion));
  database.execute(kTables);
}

std::string listOf(const std::vector<long>& numbers) {
  return fmt::format("{}", fmt::join(numbers, ","));
}

}  // namespace

struct TrajectoryWriter::Session {
  /// Of a database that has the tables.
  explicit Session(std::unique_ptr<Database> empty)
      : database(std::move(empty)),
        frame(database->prepare("INSERT INTO frame VALUES (?, ?)")),
        state(database->prepare("INSERT INTO state VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")),
        energy(database->prepare("INSERT INTO energy VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")),
        joint(database->prepare("INSERT INTO joint_state VALUES (?, ?, ?, ?, ?)")),
        contact(database->prepare("INSERT OR REPLACE INTO contact VALUES (?, ?, ?, ?, ?)")),
        force(database->prepare("INSERT INTO contact_force VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")),
        camera(database->prepare("INSERT INTO camera VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")),
        event(database->prepare("INSERT INTO event VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")),
        checkpoint(database->prepare("INSERT INTO checkpoint VALUES (?, ?, ?, ?)")) {}

  std::unique_ptr<Database> database;
  Statement frame, state, energy, joint, contact, force, camera, event, checkpoint;
};

TrajectoryWriter::TrajectoryWriter(const std::string& path, const TrajectoryHeader& header,
                                   std::chrono::milliseconds commitInterval)
    : path_(path), part_(partPath(path)), commitInterval_(commitInterval) {
  requireWritableFile(path_);
  removeOldPart(part_);
  try {
    begin(std::make_unique<Database>(part_, DatabaseAccess::create), header);
  } catch (...) {
    endUnfinished();
    throw;
  }
}

TrajectoryWriter::TrajectoryWriter(const TrajectoryHeader& header) : commitInterval_(kCommitInterval) {
  begin(std::make_unique<Database>("", DatabaseAccess::unnamed), header);
}

TrajectoryWriter::TrajectoryWriter(const std::string& path, const TrajectoryHeader& header,
                                   const Checkpoint& checkpoint)
    : path_(path), part_(partPath(path)), commitInterval_(kCommitInterval) {
  requireWritableFile(path_);
  nameColumns(header);
  session_ = std::make_unique<Session>(std::make_unique<Database>(part_, DatabaseAccess::extend));
  beginTransaction();
  dropBehind(checkpoint);
  readUntil(checkpoint);
  framesAppended_ = framesCommitted_ = checkpoint.frame + 1;
}

/// Drops the rows that the run has told after its checkpoint, and all cameras.
void TrajectoryWriter::dropBehind(const Checkpoint& checkpoint) {
  Database& database = *session_->database;
  database.execute(fmt::format("DELETE FROM event WHERE rowid > {}", checkpoint.eventCount));
  database.execute(fmt::format("DELETE FROM frame WHERE id > {}", checkpoint.frame));
  database.execute("DELETE FROM camera");
  for (const char* table : {"state", "energy", "joint_state", "contact_force"})
    database.execute(fmt::format("DELETE FROM {} WHERE frame > {}", table, checkpoint.frame));
  database.execute(fmt::format("DELETE FROM contact WHERE id >= {}", checkpoint.contactCount));
  database.execute(fmt::format("UPDATE contact SET end = NULL WHERE id IN ({})", listOf(checkpoint.goingOn)));
}

/// Takes hash, time and last forces from the rows up to the checkpoint.
void TrajectoryWriter::readUntil(const Checkpoint& checkpoint) {
  Database& database = *session_->database;
  Statement times = database.prepare("SELECT id, time FROM frame ORDER BY id");
  Statement states = database.prepare(
      "SELECT px, py, pz, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz FROM state WHERE frame = ? ORDER BY body");
  while (times.step()) {
    Frame frame{times.integer(0), times.real(1), {}, {}};
    states.bind(1, frame.number);
    while (states.step()) {
      const auto number = [&](int column) { return states.real(column); };
      frame.states.push_back({Vec3(number(0), number(1), number(2)), Quat(number(3), number(4), number(5), number(6)),
                              Vec3(number(7), number(8), number(9)), Vec3(number(10), number(11), number(12))});
    }
    states.reset();
    addFrame(frame, stateHash_);
    lastTime_ = frame.time;
  }
  Statement forces =
      database.prepare(fmt::format("SELECT contact, fx, fy, fz, tx, ty, tz, x, y, z, nx, ny, nz, normal, friction FROM "
                                   "contact_force WHERE contact IN "
                                   "({}) ORDER BY frame",
                                   listOf(checkpoint.goingOn)));
  while (forces.step()) {
    ForceNumbers& numbers = lastForces_[forces.integer(0)];
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = forces.real(static_cast<int>(i) + 1);
  }
}

void TrajectoryWriter::nameColumns(const TrajectoryHeader& header) {
  for (std::size_t id = 0; id < header.bodies.size(); ++id) {
    bodyNames_.push_back(header.bodies[id].name);
    if (header.bodies[id].hasStates()) movingBodies_.push_back(static_cast<int>(id));
  }
  for (const JointRecord& joint : header.joints) jointNames_.push_back(joint.name);
}

void TrajectoryWriter::begin(std::unique_ptr<Database> database, const TrajectoryHeader& header) {
  nameColumns(header);
  createTables(*database);
  session_ = std::make_unique<Session>(std::move(database));
  insertHeader(*session_->database, header);
  session_->database->commit();
  beginTransaction();
}

void TrajectoryWriter::beginTransaction() {
  session_->database->execute("BEGIN IMMEDIATE");
  lastCommit_ = std::chrono::steady_clock::now();
}

TrajectoryWriter::~TrajectoryWriter() {
  endUnfinished();
}

void TrajectoryWriter::append(const Frame& frame) {
  CRADLE_CHECK(session_ && transactionWhole_);
  CRADLE_CHECK(frame.number == framesAppended_ && (frame.number == 0 || frame.time > lastTime_));
  CRADLE_CHECK(frame.states.size() == movingBodies_.size() && frame.joints.size() == jointNames_.size());
  requireFinite(frame);
  transactionWhole_ = false;
  writeFrame(frame);
  transactionWhole_ = true;
  addFrame(frame, stateHash_);
  lastTime_ = frame.time;
  ++framesAppended_;
  commitIfDue();
}

void TrajectoryWriter::requireFinite(const Frame& frame) const {
  for (std::size_t i = 0; i < frame.states.size(); ++i)
    if (!isPossible(frame.states[i]))
      failNotFinite(frame.time, "state of body " + bodyNames_[static_cast<std::size_t>(movingBodies_[i])]);
  for (std::size_t i = 0; i < frame.joints.size(); ++i)
    if (!isPossible(frame.joints[i])) failNotFinite(frame.time, "state of joint " + jointNames_[i]);
  for (const ContactWrench& wrench : frame.contacts)
    if (!allPossible(forceNumbers(wrench)))
      failNotFinite(frame.time,
                    fmt::format("contact force on body {}", bodyNames_[static_cast<std::size_t>(wrench.bodyB)]));
  if (!allPossible(energyNumbers(frame.energy))) failNotFinite(frame.time, "energy or momentum of the scene");
}

void TrajectoryWriter::writeFrame(const Frame& frame) {
  Session& session = *session_;
  session.frame.bind(1, frame.number);
  session.frame.bind(2, frame.time);
  session.frame.run();
  for (std::size_t i = 0; i < frame.states.size(); ++i) {
    session.state.bind(1, frame.number);
    session.state.bind(2, movingBodies_[i]);
    bindNumbers(session.state, 3, stateNumbers(frame.states[i]));
    session.state.run();
  }
  session.energy.bind(1, frame.number);
  bindNumbers(session.energy, 2, energyNumbers(frame.energy));
  session.energy.run();
  writeContacts(frame);
  for (std::size_t i = 0; i < frame.joints.size(); ++i) {
    const JointState& joint = frame.joints[i];
    session.joint.bind(1, frame.number);
    session.joint.bind(2, i);
    bindNumbers(session.joint, 3, std::array{joint.coordinate, joint.velocity, joint.force});
    session.joint.run();
  }
}

/// A contact has a row where that differs from its last one. One that has just ended, at the instant of a frame, has
/// none of its forces there.
void TrajectoryWriter::writeContacts(const Frame& frame) {
  const auto write = [&](long contact, const ForceNumbers& numbers) {
    session_->force.bind(1, frame.number);
    session_->force.bind(2, contact);
    bindNumbers(session_->force, 3, numbers);
    session_->force.run();
  };
  for (const LastingContact& ended : std::exchange(ended_, {}))
    if (lastForces_.erase(ended.id) > 0 && *ended.end >= frame.time) write(ended.id, ForceNumbers{});
  for (const ContactWrench& wrench : frame.contacts) {
    const ForceNumbers numbers = forceNumbers(wrench);
    const auto [last, isNew] = lastForces_.try_emplace(wrench.contact, numbers);
    if (!isNew && last->second == numbers) continue;
    last->second = numbers;
    write(wrench.contact, numbers);
  }
}

void TrajectoryWriter::append(const LastingContact& contact) {
  CRADLE_CHECK(session_ && transactionWhole_);
  Statement& insert = session_->contact;
  insert.bind(1, contact.id);
  insert.bind(2, contact.bodyA);
  insert.bind(3, contact.bodyB);
  insert.bind(4, contact.begin);
  contact.end ? insert.bind(5, *contact.end) : insert.bindNull(5);
  insert.run();
  if (contact.end) ended_.push_back(contact);
}

void TrajectoryWriter::append(const CameraPose& camera) {
  CRADLE_CHECK(session_ && transactionWhole_);
  const Vec3& p = camera.position;
  const Quat& q = camera.orientation;
  session_->camera.bind(1, camera.frame);
  bindNumbers(session_->camera, 2,
              std::array{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), camera.verticalFieldOfView});
  session_->camera.run();
}

void TrajectoryWriter::append(const Checkpoint& checkpoint) {
  CRADLE_CHECK(session_ && transactionWhole_ && checkpoint.frame == framesAppended_ - 1);
  session_->database->execute("DELETE FROM checkpoint");
  Statement& insert = session_->checkpoint;
  insert.bind(1, checkpoint.frame);
  insert.bind(2, std::as_bytes(std::span(checkpoint.record)));
  insert.bind(3, checkpoint.fingerprint);
  insert.bind(4, stateHash_.hex());
  insert.run();
}

void TrajectoryWriter::append(const Event& event) {
  const auto isBody = [&](int body) { return body >= 0 && static_cast<std::size_t>(body) < bodyNames_.size(); };
  CRADLE_CHECK(session_ && transactionWhole_);
  CRADLE_CHECK(isBody(event.bodyA) && (event.bodyB < 0 || isBody(event.bodyB)));
  const Vec3 &point = event.point, &normal = event.normal;
  const std::array numbers{point.x(), point.y(), point.z(), normal.x(), normal.y(), normal.z(), event.impulse};
  if (!std::isfinite(event.time) || !allPossible(numbers))
    failNotFinite(event.time, fmt::format("event \"{}\" of body {}", eventKindName(event.kind),
                                          bodyNames_[static_cast<std::size_t>(event.bodyA)]));
  Statement& insert = session_->event;
  insert.bind(1, event.time);
  insert.bind(2, eventKindName(event.kind));
  insert.bind(3, event.bodyA);
  bindBody(insert, 4, event.bodyB);
  bindNumbers(insert, 5, numbers);
  insert.run();
}

void TrajectoryWriter::commitIfDue() {
  const auto now = std::chrono::steady_clock::now();
  if (now - lastCommit_ < commitInterval_ || !session_->database->tryCommit()) return;
  framesCommitted_ = framesAppended_;
  beginTransaction();
}

void TrajectoryWriter::flush() {
  CRADLE_CHECK(session_ && transactionWhole_);
  session_->database->commit();
  framesCommitted_ = framesAppended_;
  beginTransaction();
}

void TrajectoryWriter::finish(const RunCost& cost) {
  CRADLE_CHECK(session_);
  insertMeta(*session_->database, "cpuSeconds", cost.cpuSeconds);
  insertMeta(*session_->database, "evaluations", cost.evaluations);
  insertMeta(*session_->database, "corrections", countsAsJson(cost.corrections));
  insertMeta(*session_->database, "promise", cost.promise);
  complete();
}

void TrajectoryWriter::finishAs(const TrajectoryReader& copied) {
  CRADLE_CHECK(session_ && copied.isFinished());
  const RunCost cost = copied.cost();
  insertMeta(*session_->database, "cpuSeconds", cost.cpuSeconds);
  insertMeta(*session_->database, "evaluations", cost.evaluations);
  for (const char* key : {"corrections", "promise", kHorizonKey})
    if (const auto known = copied.meta().find(key); known != copied.meta().end())
      insertMeta(*session_->database, key, known->second);
  complete();
}

void TrajectoryWriter::complete() {
  CRADLE_CHECK(transactionWhole_ && framesAppended_ > 0);
  session_->database->execute("DELETE FROM checkpoint");
  insertMeta(*session_->database, "stateHash", stateHash_.hex());
  session_->database->commit();
  framesCommitted_ = framesAppended_;
  if (path_.empty()) return;
  session_.reset();
  // What stands in the way may have changed since the start; rename itself would replace a device.
  requireWritableFile(path_);
  std::error_code failed;
  fs::rename(part_, path_, failed);
  if (failed)
    throw Error(ErrorKind::output, path_,
                fmt::format("cannot be put in place ({}); the result is in {}", failed.message(), part_));
  isFinished_ = true;
  flushFolderOf(path_);
}

/// The database of a file without a name.
std::unique_ptr<Database> TrajectoryWriter::release() {
  CRADLE_CHECK(session_ && path_.empty());
  std::unique_ptr<Database> database = std::move(session_->database);
  session_.reset();
  return database;
}

std::string TrajectoryWriter::keptPath() {
  endUnfinished();
  return isFinished_ || framesCommitted_ == 0 ? "" : part_;
}

void TrajectoryWriter::endUnfinished() noexcept {
  if (session_ && framesAppended_ > 0) {
    try {
      if (transactionWhole_) session_->database->commit();
      framesCommitted_ = transactionWhole_ ? framesAppended_ : framesCommitted_;
    } catch (const std::exception&) {
      // The run is over already for another reason, which is the one to tell; the frames since the last commit go.
    }
    session_->database->rollback();
  }
  session_.reset();
  std::error_code ignored;
  if (framesCommitted_ > 0 || part_.empty()) return;
  fs::remove(part_, ignored);
  fs::remove(part_ + "-journal", ignored);  // where the disk was too full to take back what was half-written
}

void addToMeta(const std::string& path, const std::string& key, const std::string& text) {
  Database database(path, DatabaseAccess::extend);
  insertMeta(database, key, text);
}

}  // namespace cradle
