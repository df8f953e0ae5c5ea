// Bytes as a trajectory file, or, as hardly any of those is one, as changes to the tables of a good one: what is read
// is what pictures believe.

#include <fmt/format.h>
#include <fuzzer/FuzzedDataProvider.h>
#include <sqlite3.h>

#include <array>
#include <cmath>
#include <memory>

#include "../trajectory/sample_trajectory.h"
#include "fuzz_target.h"
#include "trajectory/compare_trajectories.h"

namespace cradle {
namespace {

using Connection = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Query = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

constexpr std::size_t kMaxChanges = 8, kMaxBytes = 16, kLongestValue = 64;
constexpr int kMaxRows = 16;

struct Table {
  const char *name, *key;
};
constexpr std::array kTables{Table{"meta", "key"},           Table{"mesh", "id"},     Table{"body", "id"},
                             Table{"frame", "id"},           Table{"event", "rowid"}, Table{"energy", "frame"},
                             Table{"state", "(frame, body)"}};

std::string contentOfSample() {
  const ScratchFile file("sample.sqlite");
  writeSample(file.path(), 3);
  return contentOf(file.path());
}

/// The columns of a table.
std::vector<std::string> columnsOf(sqlite3* database, const Table& table) {
  std::vector<std::string> columns;
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, fmt::format("SELECT name FROM pragma_table_info('{}')", table.name).c_str(), -1,
                     &statement, nullptr);
  const Query query(statement, sqlite3_finalize);
  while (sqlite3_step(statement) == SQLITE_ROW)
    columns.emplace_back(reinterpret_cast<const char*>(sqlite3_column_text(statement, 0)));
  return columns;
}

void bindValue(sqlite3_stmt* statement, FuzzedDataProvider& bytes) {
  enum class Kind { null, integer, real, text, blob, kMaxValue = blob };
  const Kind kind = bytes.ConsumeEnum<Kind>();
  if (kind == Kind::integer) sqlite3_bind_int64(statement, 1, bytes.ConsumeIntegral<std::int64_t>());
  if (kind == Kind::real) sqlite3_bind_double(statement, 1, bytes.ConsumeFloatingPoint<double>());
  const std::string value = kind < Kind::text ? "" : bytes.ConsumeRandomLengthString(kLongestValue);
  const int size = static_cast<int>(value.size());
  if (kind == Kind::text) sqlite3_bind_text(statement, 1, value.data(), size, SQLITE_TRANSIENT);
  if (kind == Kind::blob) sqlite3_bind_blob(statement, 1, value.data(), size, SQLITE_TRANSIENT);
}

/// A value is replaced, some bytes of one are, or a row is left out.
void change(sqlite3* database, FuzzedDataProvider& bytes) {
  enum class Change { value, bytes, row, kMaxValue = row };
  const Table& table = bytes.PickValueInArray(kTables);
  const std::vector<std::string> columns = columnsOf(database, table);
  const std::string& column = columns[bytes.ConsumeIntegralInRange<std::size_t>(0, columns.size() - 1)];
  const Change kind = bytes.ConsumeEnum<Change>();
  const int row = bytes.ConsumeIntegralInRange(0, kMaxRows);
  const std::string where = fmt::format("WHERE {0} = (SELECT {1} FROM {2} LIMIT 1 OFFSET {3})", table.key,
                                        table.key[0] == '(' ? "frame, body" : table.key, table.name, row);
  const std::string patched = fmt::format("CAST(substr({0}, 1, ?2) || ?1 || substr({0}, ?2 + 1 + length(?1)) AS {1})",
                                          column, column == "material" || column == "value" ? "TEXT" : "BLOB");
  sqlite3_stmt* statement = nullptr;
  const std::string sql = kind == Change::row ? fmt::format("DELETE FROM {} {}", table.name, where)
                                              : fmt::format("UPDATE {} SET {} = {} {}", table.name, column,
                                                            kind == Change::bytes ? patched : "?1", where);
  sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr);
  const Query query(statement, sqlite3_finalize);
  if (kind != Change::row) bindValue(statement, bytes);
  if (kind == Change::bytes) sqlite3_bind_int(statement, 2, bytes.ConsumeIntegralInRange(0, 400));
  sqlite3_step(statement);
}

/// A good trajectory with changes of its tables and, where bytes are left, of the file itself that `bytes` ask for.
std::string changedSample(FuzzedDataProvider bytes) {
  static const std::string sample = contentOfSample();
  sqlite3* handle = nullptr;
  sqlite3_open(":memory:", &handle);
  const Connection database(handle, sqlite3_close);
  const auto size = static_cast<sqlite3_int64>(sample.size());
  auto* copy = static_cast<unsigned char*>(sqlite3_malloc64(sample.size()));
  std::copy(sample.begin(), sample.end(), copy);
  HOLDS(sqlite3_deserialize(handle, "main", copy, size, size,
                            SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE) == SQLITE_OK);
  for (std::size_t i = 0; i < kMaxChanges && bytes.remaining_bytes() > 0; ++i) change(handle, bytes);
  sqlite3_int64 changedSize = 0;
  unsigned char* changed = sqlite3_serialize(handle, "main", &changedSize, 0);
  HOLDS(changed != nullptr);
  std::string file(reinterpret_cast<const char*>(changed), static_cast<std::size_t>(changedSize));
  sqlite3_free(changed);
  for (std::size_t i = 0; i < kMaxBytes && bytes.remaining_bytes() > 0; ++i)
    file[bytes.ConsumeIntegralInRange<std::size_t>(0, file.size() - 1)] = bytes.ConsumeIntegral<char>();
  return file;
}

void checkMesh(const DrawnMesh& mesh) {
  HOLDS(mesh.vertices.size() == mesh.normals.size());
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) HOLDS(vertex < mesh.vertices.size());
  for (const Vec3& vertex : mesh.vertices) HOLDS(vertex.allFinite());
  std::size_t covered = 0;
  for (const ModelMaterial& material : mesh.materials) {
    HOLDS(material.firstTriangle == covered);
    covered += material.triangleCount;
  }
  HOLDS(mesh.materials.empty() || covered == mesh.triangles.size());  // without, the body's material is all over
}

void check(const TrajectoryReader& reader) {
  const TrajectoryHeader& header = reader.header();
  for (const Model& model : header.meshes) checkMesh(model.drawn);
  for (const BodyRecord& body : header.bodies) {
    HOLDS(body.mesh >= -1 && body.mesh < std::ssize(header.meshes) && (body.mesh >= 0 || !body.shape.empty()));
    HOLDS(!body.isDynamic || body.massProperties.mass > 0);
  }
  double last = -1;
  for (long number = 0; number < reader.frameCount(); ++number) {
    const Frame frame = reader.readFrame(number);
    HOLDS(std::isfinite(frame.time) && frame.time > last);
    last = frame.time;
    for (const BodyState& state : frame.states) HOLDS(isPossible(state));
  }
  for (const Event& event : reader.events())
    HOLDS(event.bodyA >= 0 && event.bodyA < std::ssize(header.bodies) && event.bodyB >= -1 &&
          event.bodyB < std::ssize(header.bodies));
  reader.cost();
  HOLDS(compareTrajectories(reader, reader, 0).equal);
}

}  // namespace
}  // namespace cradle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  static const ScratchFile file("film.sqlite");
  const std::string bytes = textOf(data, size);
  file.write(bytes.starts_with("SQLite format 3") ? bytes : changedSample(FuzzedDataProvider(data, size)));
  acceptOrRefuse([] { check(TrajectoryReader(file.path())); });
  return 0;
}
