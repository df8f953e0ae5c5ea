#include "mesh/load_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <filesystem>
#include <optional>

#include "core/error.h"
#include "core/output_path.h"
#include "mesh/assemble_model.h"
#include "mesh/fill_holes.h"
#include "mesh/import_mesh.h"
#include "mesh/mesh_library.h"
#include "mesh/solid.h"
#include "mesh/turn_parts.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxKept = 256 << 20;  // bytes, of triangles: those of more files are parsed for each model
constexpr double kSecondsForAnyFiles = 10;   // s: three files that take as long as they may
constexpr double kSecondsForFile = 0.3;      // s, of one of many: to begin a child process takes a tenth of that
constexpr double kSecondsPerByte = 1.0 / (1 << 20);  // s, as for each file

std::vector<std::string> namesOf(const std::vector<LoadedModel>& objects) {
  std::vector<std::string> names;
  for (const LoadedModel& object : objects) names.push_back("\"" + object.model.name + "\"");
  return names;
}

/// In metres. Finite numbers of the file may be too large for that.
void scaleBy(double scale, const std::string& path, std::vector<ImportedObject>& objects) {
  CRADLE_CHECK(scale > 0);
  for (ImportedObject& object : objects)
    for (MeshPiece& piece : object.pieces)
      for (Vec3& corner : piece.corners) {
        corner *= scale;
        if (!corner.allFinite())
          throw Error(ErrorKind::mesh, path,
                      fmt::format("a vertex of \"{}\" is not finite at scale {}", object.name, scale));
      }
}

/// Unit vectors of the world as a file with that axis up has them: rows x, y, z, of which y is the axis.
Mat3 worldFromFile(UpAxis up) {
  Mat3 turn = Mat3::Identity();
  if (up == UpAxis::x) turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  if (up == UpAxis::z) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return turn;
}

/// Turns objects that came out with the axis up that their format has.
void turnUp(UpAxis up, const std::string& path, std::vector<ImportedObject>& objects) {
  const UpAxis ofFormat = isNamed3ds(path) ? UpAxis::z : UpAxis::y;
  if (up == UpAxis::ofFormat || up == ofFormat) return;
  const Mat3 turn = worldFromFile(up) * worldFromFile(ofFormat).transpose();
  const Eigen::Matrix3f turnOfNormals = turn.cast<float>();
  for (ImportedObject& object : objects)
    for (MeshPiece& piece : object.pieces) {
      for (Vec3& corner : piece.corners) corner = turn * corner;
      for (Vec3f& normal : piece.normals) normal = turnOfNormals * normal;
    }
}

/// Vertices with coordinates on a texture that nobody draws would be more than there need be.
void dropUnusedCoordinates(std::vector<ImportedObject>& objects) {
  for (ImportedObject& object : objects)
    for (MeshPiece& piece : object.pieces)
      if (!piece.look.texture) piece.textureCoordinates.clear();
}

/// The objects of a file as they are wound there.
std::vector<LoadedModel> assembleObjects(const std::string& path, std::vector<ImportedObject> imported, double scale,
                                         ModelParts parts) {
  scaleBy(scale, path, imported);
  std::vector<LoadedModel> objects;
  for (ImportedObject& object : imported) {
    LoadedModel loaded = assembleModel(object.name, std::move(object.pieces), parts);
    if (!loaded.model.solid.triangles.empty()) objects.push_back(std::move(loaded));
  }
  if (objects.empty())
    throw Error(ErrorKind::mesh, path, "has no triangles; a body needs a surface (points and lines have none)");
  return objects;
}

void mend(bool fillsHoles, LoadedModel& loaded) {
  if (fillsHoles) fillHoles(loaded);
  turnPartsOutwards(loaded);
}

/// All objects as one model. Which way a part must face depends on those around it, of other objects too; objects that
/// do not make a closed surface together may still be closed each.
LoadedModel joinOutwards(const std::string& name, bool fillsHoles, std::vector<LoadedModel> objects) {
  LoadedModel joined = joinModels(name, objects);
  if (fillsHoles) fillHoles(joined);
  if (hasMatchingEdges(joined.model.solid)) {
    turnPartsOutwards(joined);
    return joined;
  }
  for (LoadedModel& object : objects) mend(fillsHoles, object);
  return joinModels(name, objects);
}

/// The object that `reference` names, or all as one.
LoadedModel chosenModel(const MeshReference& reference, std::vector<ImportedObject> imported) {
  turnUp(reference.upAxis, reference.path, imported);
  if (!reference.isTextured) dropUnusedCoordinates(imported);
  std::vector<LoadedModel> objects =
      assembleObjects(reference.path, std::move(imported), reference.scale, ModelParts::solidAndDrawn);
  if (reference.object.empty() && objects.size() > 1)
    return joinOutwards(fs::path(reference.path).stem().string(), reference.fillsHoles, std::move(objects));
  if (reference.object.empty()) {
    mend(reference.fillsHoles, objects.front());
    return std::move(objects.front());
  }
  for (LoadedModel& object : objects)
    if (object.model.name == reference.object) {
      mend(reference.fillsHoles, object);
      return std::move(object);
    }
  throw Error(ErrorKind::mesh, reference.path,
              fmt::format("has no object \"{}\"; it has {}", reference.object, fmt::join(namesOf(objects), ", ")));
}

std::size_t sizeOf(const std::vector<ImportedObject>& objects) {
  std::size_t bytes = 0;
  for (const ImportedObject& object : objects)
    for (const MeshPiece& piece : object.pieces)
      bytes += piece.corners.size() * sizeof(Vec3) + piece.normals.size() * sizeof(Vec3f) +
               piece.textureCoordinates.size() * sizeof(Vec2f) + sizeof(MeshPiece) +
               (piece.look.texture ? piece.look.texture->bytes.size() : 0);
  return bytes;
}

/// Of computing, by child processes that have ended.
double secondsOfChildren() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// One for all ways to write a path; the name stays, because objects without one have it.
std::string keyOf(const std::string& path) {
  std::error_code ignored;  // of a folder that is not there
  return (fs::weakly_canonical(parentOf(path), ignored) / fs::path(path).filename()).string();
}

}  // namespace

std::vector<LoadedModel> loadObjects(const std::string& path, double scale, ModelParts parts) {
  std::vector<ImportedObject> imported = importObjects(path);
  dropUnusedCoordinates(imported);
  std::vector<LoadedModel> objects = assembleObjects(path, std::move(imported), scale, parts);
  for (LoadedModel& object : objects) mend(true, object);
  return objects;
}

LoadedModel loadModel(const MeshReference& reference) {
  return chosenModel(reference, importObjects(reference.path));
}

struct MeshLibrary::File {
  std::vector<ImportedObject> objects;  // empty if they are not kept
  std::optional<Error> fault;
};

MeshLibrary::MeshLibrary() : secondsAllowed_(kSecondsForAnyFiles) {}
MeshLibrary::~MeshLibrary() = default;

LoadedModel MeshLibrary::load(const MeshReference& reference) {
  std::unique_ptr<File>& file = files_[keyOf(reference.path)];
  if (file && file->fault) throw *file->fault;
  if (file && !file->objects.empty()) return chosenModel(reference, file->objects);
  if (!file) {
    file = std::make_unique<File>();
    std::error_code failed;
    const std::uint64_t size = fs::file_size(reference.path, failed);
    secondsAllowed_ += kSecondsForFile + (failed ? 0 : kSecondsPerByte * static_cast<double>(size));
  }
  try {
    std::vector<ImportedObject> objects = parse(reference.path);
    const std::size_t size = sizeOf(objects);
    if (kept_ + size > kMaxKept) return chosenModel(reference, std::move(objects));
    kept_ += size;
    file->objects = std::move(objects);
  } catch (const Error& error) {
    file->fault = error;
    throw;
  }
  return chosenModel(reference, file->objects);
}

std::vector<ImportedObject> MeshLibrary::parse(const std::string& path) {
  if (secondsUsed_ > secondsAllowed_)
    throw Error(ErrorKind::mesh, path,
                fmt::format("is not read: the mesh files before it took {:.0f} s, and {:.0f} s are allowed for all of "
                            "them; simplify them",
                            secondsUsed_, secondsAllowed_));
  const double before = secondsOfChildren();
  const auto note = [&] { secondsUsed_ += secondsOfChildren() - before; };
  try {
    std::vector<ImportedObject> objects = importObjects(path);
    note();
    return objects;
  } catch (...) {
    note();
    throw;
  }
}

}  // namespace cradle
