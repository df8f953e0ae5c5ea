// A 3ds file is a tree of chunks: identifier (2 bytes), size with this header (4 bytes), data, child chunks; all
// numbers are little-endian (J. van Velsen, R. Fercoq, "3D Studio file format", 1997). Chunks not named here are passed
// over.

#include "mesh/check_3ds.h"

#include <fmt/format.h>
#include <strings.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/error.h"

namespace cradle {
namespace {

enum ChunkId : std::uint16_t {
  kMain = 0x4D4D,
  kEditor = 0x3D3D,
  kMaterial = 0xAFFF,
  kObject = 0x4000,
  kTriangleMesh = 0x4100,
  kVertices = 0x4110,
  kFaces = 0x4120,
  kFaceMaterial = 0x4130,
  kSmoothingGroups = 0x4150,
  kMeshMatrix = 0x4160,
  kKeyframer = 0xB000,
  kNodeName = 0xB010,
  kFirstTrackNode = 0xB001,  // ambient, object, camera, target, light, target, spot
  kLastTrackNode = 0xB007,
  kPositionTrack = 0xB020,
  kRotationTrack = 0xB021,
  kScaleTrack = 0xB022,
  kRollTrack = 0xB024
};

constexpr std::size_t kHeaderSize = 6;
constexpr std::size_t kTrackHeaderSize = 14;  // flags, unused, number of keys
constexpr std::size_t kSmallestKey = 6;       // frame number and flags
constexpr std::size_t kMaxNodes = 4096;       // the importer walks the tree recursively
constexpr std::size_t kMaxMaterials = 4096;   // it takes 1400 bytes for 7 of one, and compares all with all

struct Chunk {
  std::uint16_t id;
  std::size_t begin, end;  // bytes of its data and children
};

class Reader {
 public:
  Reader(const std::string& bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  Summary3ds read() {
    if (bytes_.size() < kHeaderSize) fail(0, "is too short for a 3ds file");
    if (get<std::uint16_t>(0, bytes_.size()) != kMain) fail(0, "does not start like a 3ds file");
    forEachChild(0, bytes_.size(), [&](const Chunk& main) {
      if (main.id != kMain) return;
      forEachChild(main.begin, main.end, [&](const Chunk& chunk) {
        if (chunk.id == kEditor) readEditor(chunk);
        if (chunk.id == kKeyframer) readKeyframer(chunk);
      });
    });
    return summary_;
  }

 private:
  [[noreturn]] void fail(std::size_t where, const std::string& what) const {
    throw Error(ErrorKind::mesh, path_,
                fmt::format("{} (byte {}); the file is damaged: export or copy it again", what, where));
  }

  template <typename T>
  T get(std::size_t where, std::size_t end) const {
    if (where + sizeof(T) > end) fail(where, "a chunk ends too early");
    T value;
    std::memcpy(&value, bytes_.data() + where, sizeof(T));
    return value;
  }

  std::string getText(std::size_t begin, std::size_t end) const {
    const std::size_t textEnd = bytes_.find('\0', begin);
    if (textEnd >= end) fail(begin, "a name does not end");
    return bytes_.substr(begin, textEnd - begin);
  }

  Chunk chunkAt(std::size_t where, std::size_t end) const {
    const auto id = get<std::uint16_t>(where, end);
    const auto size = get<std::uint32_t>(where + 2, end);
    if (size < kHeaderSize) fail(where, fmt::format("chunk {:04X} has the impossible size {}", id, size));
    if (size > end - where)
      fail(where, fmt::format("chunk {:04X} has {} bytes, but only {} are left", id, size, end - where));
    return {id, where + kHeaderSize, where + size};
  }

  template <typename Visit>
  void forEachChild(std::size_t begin, std::size_t end, Visit visit) const {
    while (end - begin >= kHeaderSize) {
      const Chunk chunk = chunkAt(begin, end);
      visit(chunk);
      begin = chunk.end;
    }
  }

  void readEditor(const Chunk& editor) {
    forEachChild(editor.begin, editor.end, [&](const Chunk& object) {
      if (object.id == kMaterial && ++materials_ > kMaxMaterials)
        fail(object.begin, fmt::format("has more than {} materials", kMaxMaterials));
      if (object.id != kObject) return;
      const std::string name = getText(object.begin, object.end);
      forEachChild(object.begin + name.size() + 1, object.end, [&](const Chunk& chunk) {
        if (chunk.id == kTriangleMesh) readMesh(chunk, name);
      });
    });
  }

  void readMesh(const Chunk& mesh, const std::string& name) {
    summary_.meshes.push_back({name, {}, {}, {}});
    if (summary_.meshes.size() > kMaxNodes) fail(mesh.begin, fmt::format("has more than {} objects", kMaxNodes));
    std::size_t vertexLists = 0, faceLists = 0, vertices = 0;
    forEachChild(mesh.begin, mesh.end, [&](const Chunk& chunk) {
      if (chunk.id == kVertices) {
        vertices = get<std::uint16_t>(chunk.begin, chunk.end);
        checkFloats(chunk.begin + 2, 3 * vertices, chunk.end, "vertex coordinate");
        ++vertexLists;
      }
      if (chunk.id == kMeshMatrix) checkFloats(chunk.begin, 12, chunk.end, "entry of a mesh matrix");
      if (chunk.id == kFaces) ++faceLists;
    });
    if (vertexLists > 1 || faceLists > 1)
      fail(mesh.begin, "object \"" + name + "\" has two lists of vertices or faces");
    forEachChild(mesh.begin, mesh.end, [&](const Chunk& chunk) {
      if (chunk.id == kFaces) readFaces(chunk, vertices, summary_.meshes.back());
    });
  }

  void checkFloats(std::size_t where, std::size_t count, std::size_t end, const char* what) const {
    for (std::size_t i = 0; i < count; ++i, where += sizeof(float))
      if (!std::isfinite(get<float>(where, end))) fail(where, fmt::format("a {} is not finite", what));
  }

  void readFaces(const Chunk& chunk, std::size_t vertices, Mesh3ds& mesh) const {
    constexpr std::size_t kFaceSize = 4 * sizeof(std::uint16_t);  // three corners and flags
    const std::size_t faces = get<std::uint16_t>(chunk.begin, chunk.end);
    const std::size_t begin = chunk.begin + 2, end = begin + faces * kFaceSize;
    if (end > chunk.end) fail(begin, "a list of faces ends too early");
    for (std::size_t face = 0; face < faces; ++face)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto index = get<std::uint16_t>(begin + face * kFaceSize + 2 * corner, end);
        if (index >= vertices)
          fail(begin + face * kFaceSize, fmt::format("face {} of \"{}\" names vertex {}, but there are only {}", face,
                                                     mesh.name, index, vertices));
      }
    mesh.materialOf.assign(faces, kNoMaterial);
    forEachChild(end, chunk.end, [&](const Chunk& list) {
      if (list.id == kSmoothingGroups) {
        mesh.smoothingGroups.assign(faces, 0);
        for (std::size_t face = 0; face < std::min(faces, (list.end - list.begin) / 4); ++face)
          mesh.smoothingGroups[face] = get<std::uint32_t>(list.begin + 4 * face, list.end);
      }
      if (list.id == kFaceMaterial) readMaterials(list, mesh);
    });
  }

  void readMaterials(const Chunk& list, Mesh3ds& mesh) const {
    const std::string name = getText(list.begin, list.end);
    std::size_t where = list.begin + name.size() + 1;
    const std::size_t count = get<std::uint16_t>(where, list.end);
    if (mesh.materials.size() == kNoMaterial) fail(list.begin, "an object has too many materials");
    mesh.materials.push_back(name);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t face = get<std::uint16_t>(where += 2, list.end);
      if (face < mesh.materialOf.size()) mesh.materialOf[face] = static_cast<std::uint16_t>(mesh.materials.size() - 1);
    }
  }

  void readKeyframer(const Chunk& keyframer) const {
    std::size_t nodes = 0;
    forEachChild(keyframer.begin, keyframer.end, [&](const Chunk& node) {
      if (node.id < kFirstTrackNode || node.id > kLastTrackNode) return;
      if (++nodes > kMaxNodes) fail(node.begin, fmt::format("has more than {} animated nodes", kMaxNodes));
      std::size_t names = 0;
      forEachChild(node.begin, node.end, [&](const Chunk& track) {
        if (track.id == kNodeName && ++names > 1) fail(track.begin, "an animated node has two names");
        const bool isRead = track.id == kPositionTrack || track.id == kRotationTrack || track.id == kScaleTrack ||
                            track.id == kRollTrack;  // by the importer; others have keys too
        if (!isRead) return;
        const std::size_t keys = get<std::uint32_t>(track.begin + kTrackHeaderSize - 4, track.end);
        if (keys > (track.end - track.begin - kTrackHeaderSize) / kSmallestKey)
          fail(track.begin,
               fmt::format("an animation track promises {} keys in {} bytes", keys, track.end - track.begin));
      });
    });
  }

  const std::string& bytes_;
  const std::string& path_;
  Summary3ds summary_;
  std::size_t materials_ = 0;
};

}  // namespace

std::vector<std::uint32_t> Summary3ds::smoothingOfPiece(std::size_t mesh, const std::vector<std::string>& names,
                                                        std::size_t material, std::size_t faceCount) const {
  const Mesh3ds& of = meshes[mesh];
  std::vector<std::size_t> importersIndex;  // the first material of that name, ignoring case
  for (const std::string& wanted : of.materials) {
    const auto known = std::find_if(names.begin(), names.end(),
                                    [&](const auto& name) { return strcasecmp(name.c_str(), wanted.c_str()) == 0; });
    importersIndex.push_back(static_cast<std::size_t>(known - names.begin()));
  }
  // Faces without a material share one that the importer chooses: perhaps this.
  std::vector<std::uint32_t> named, namedOrNone;
  for (std::size_t face = 0; face < of.smoothingGroups.size(); ++face) {
    const std::size_t index = of.materialOf[face] == kNoMaterial ? names.size() : importersIndex[of.materialOf[face]];
    if (index == material) named.push_back(of.smoothingGroups[face]);
    if (index == material || index == names.size()) namedOrNone.push_back(of.smoothingGroups[face]);
  }
  if (named.size() == faceCount) return named;
  if (namedOrNone.size() == faceCount) return namedOrNone;
  return {};
}

Summary3ds check3ds(const std::string& bytes, const std::string& path) {
  return Reader(bytes, path).read();
}

}  // namespace cradle
