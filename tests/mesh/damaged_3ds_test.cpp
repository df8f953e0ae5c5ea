#include <gmock/gmock.h>
#include <sys/resource.h>

#include <random>

#include "chunks_3ds.h"
#include "mesh/assemble_model.h"
#include "mesh/check_3ds.h"
#include "mesh/import_mesh.h"
#include "mesh/mass_properties.h"
#include "mesh/solid.h"
#include "mesh/turn_parts.h"
#include "test_files.h"

// The importer leaks when it gives up: the leak sanitizer asks this function.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp";
}

namespace cradle {
namespace {

using testing::HasSubstr;

// Where the data of the first chunk `id` begins: its identifier is searched for from `from` on.
std::size_t dataOf(const std::string& bytes, std::uint16_t id, std::size_t from = 0) {
  const std::string needle{static_cast<char>(id & 0xFF), static_cast<char>(id >> 8)};
  return bytes.find(needle, from) + 6;
}

constexpr std::uint16_t kPositionTrack = 0xB020, kRotationTrack = 0xB021, kScaleTrack = 0xB022, kRollTrack = 0xB024;

// A keyframer section that animates the object Box with one track.
std::string keyframer(std::uint16_t track, std::uint32_t keys, const std::string& data) {
  std::string header(14, '\0');
  put(header, 10, keys);
  const std::string name = std::string("Box") + '\0' + std::string(4, '\0') + "\xFF\xFF";
  return chunk(0xB000, chunk(0xB002, chunk(0xB010, name) + chunk(track, header + data)));
}

TEST(Damaged3ds, TruncationAnywhereIsAnError) {
  const std::string whole = bytesOf(asset("l_prism.3ds"));
  for (std::size_t size = 1; size < whole.size(); size += 7)
    EXPECT_THAT(loadingError({writeFile("cut.3ds", whole.substr(0, size)), "", 1}), HasSubstr("cut.3ds"));
}

TEST(Damaged3ds, FaceThatNamesNoVertexIsAnError) {
  std::string bytes = bytesOf(asset("box.3ds"));
  put(bytes, dataOf(bytes, 0x4120) + 2, std::uint16_t{8});  // there are 0 .. 7
  EXPECT_THAT(loadingError({writeFile("box.3ds", bytes), "", 1}),
              HasSubstr("face 0 of \"Box\" names vertex 8, but there are only 8"));
}

TEST(Damaged3ds, VertexThatIsNotFiniteIsAnError) {
  std::string bytes = bytesOf(asset("box.3ds"));
  put(bytes, dataOf(bytes, 0x4110) + 2 + 4 * 5, 0x7FC00000U);  // NaN
  EXPECT_THAT(loadingError({writeFile("box.3ds", bytes), "", 1}), HasSubstr("vertex coordinate is not finite"));
}

TEST(Damaged3ds, CountBeyondTheChunkIsAnError) {
  std::string bytes = bytesOf(asset("box.3ds"));
  put(bytes, dataOf(bytes, 0x4110), std::uint16_t{60000});
  EXPECT_THAT(loadingError({writeFile("box.3ds", bytes), "", 1}), HasSubstr("ends too early"));
}

TEST(Damaged3ds, SecondListOfFacesIsAnError) {
  // The importer would take the first list with the number of materials of the second.
  const std::string box = bytesOf(asset("box.3ds"));
  const std::size_t faces = dataOf(box, 0x4120) - 6, vertices = dataOf(box, 0x4110) - 6;
  const std::string mesh = box.substr(vertices) + box.substr(faces);
  const std::string object = chunk(0x4000, std::string("Box") + '\0' + chunk(0x4100, mesh));
  EXPECT_THAT(loadingError({writeFile("box.3ds", chunk(0x4D4D, chunk(0x3D3D, object))), "", 1}),
              HasSubstr("two lists of vertices or faces"));
}

TEST(Damaged3ds, FileWithoutSmoothingGroupsHasSharpEdges) {
  std::string bytes = bytesOf(asset("box.3ds"));
  put(bytes, dataOf(bytes, 0x4150) - 6, std::uint16_t{0x4151});  // a chunk that means nothing
  EXPECT_EQ(loadModel({writeFile("box.3ds", bytes), "", 1}).model.drawn.vertices.size(), 24U);
}

TEST(Damaged3ds, TrackCannotAskForMemoryThatTheFileDoesNotFill) {
  const std::string box = bytesOf(asset("box.3ds"));
  // 24 bytes a key: 96 GiB.
  for (const std::uint16_t track : {kPositionTrack, kRotationTrack, kScaleTrack, kRollTrack}) {
    const std::string bytes = appendedToMain(box, keyframer(track, 0xFFFFFFFF, std::string(18, '\0')));
    EXPECT_THAT(loadingError({writeFile("box.3ds", bytes), "", 1}), HasSubstr("promises 4294967295 keys"));
  }
}

TEST(Damaged3ds, KeyframerPlacesAnObjectAndKeepsItsName) {
  std::string key(18, '\0');  // frame 0, no flags, and the position
  put(key, 6, 1.0f);
  put(key, 10, 2.0f);
  put(key, 14, 3.0f);
  const std::string bytes = appendedToMain(bytesOf(asset("box.3ds")), keyframer(kPositionTrack, 1, key));
  const Model model = loadModel({writeFile("box.3ds", bytes), "Box", 1}).model;
  Bounds bounds;
  for (const Vec3& vertex : model.solid.vertices) bounds.extend(vertex);
  EXPECT_LE((bounds.center() - Vec3(1, 3, -2)).norm(), 1e-6);  // z up became y up
}

TEST(Damaged3ds, MeshThatTheKeyframerForgetsIsStillThere) {
  const std::string name = std::string("Camera") + '\0' + std::string(4, '\0') + "\xFF\xFF";
  const std::string camera = chunk(0xB000, chunk(0xB003, chunk(0xB010, name)));
  const std::string bytes = appendedToMain(bytesOf(asset("box.3ds")), camera);
  const Model model = loadModel({writeFile("box.3ds", bytes), "Box", 1}).model;
  EXPECT_EQ(model.solid.vertices, loadModel({asset("box.3ds"), "", 1}).model.solid.vertices);
}

// What loadObjects does, but the importer runs in this process: what the sanitizers find there ends the test, while a
// child that they end is a file refused; and no process need be forked, which takes longer than to load.
std::vector<LoadedModel> loadObjectsHere(const std::string& path) {
  std::vector<LoadedModel> objects;
  for (ImportedObject& imported : parseObjects(path)) {
    LoadedModel object = assembleModel(imported.name, std::move(imported.pieces), ModelParts::solidAndDrawn);
    if (object.model.solid.triangles.empty()) continue;
    turnPartsOutwards(object);
    objects.push_back(std::move(object));
  }
  if (objects.empty()) throw Error(ErrorKind::mesh, path, "has no triangles");
  return objects;
}

std::vector<LoadedModel> loadObjectsInAChild(const std::string& path) {
  return loadObjects(path, 1);
}

// Loads; true if that gave a finite model, false if a clean error.
bool loadsFinite(const std::string& path, std::vector<LoadedModel> (*load)(const std::string&)) {
  try {
    for (const LoadedModel& object : load(path)) {
      for (const Vec3& vertex : object.model.solid.vertices) EXPECT_TRUE(vertex.allFinite());
      for (const Vec3f& normal : object.model.drawn.normals) EXPECT_NEAR(normal.norm(), 1, 1e-3);
      for (const Triangle& triangle : object.model.solid.triangles)
        for (const std::uint32_t corner : triangle) EXPECT_LT(corner, object.model.solid.vertices.size());
      if (checkSolid(object.model.solid).isSolid) {
        const MassProperties properties = computeMassProperties(object.model.solid, 1);
        EXPECT_GT(properties.mass, 0);
        EXPECT_TRUE(properties.inertiaTensor.allFinite());
      }
    }
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mesh);
    EXPECT_THAT(error.what(), HasSubstr(path));
    return false;
  }
}

struct Results {
  int loaded = 0, refused = 0;
};

// Of files that are loaded here, and, every tenth, by the whole program, which comes to the same result. Children are
// first: to fork takes long once much memory is in use.
Results loadAll(const std::vector<std::string>& files) {
  constexpr std::size_t kChildEvery = 10;
  std::vector<bool> inChild;
  for (std::size_t i = 0; i < files.size(); i += kChildEvery)
    inChild.push_back(loadsFinite(writeFile("flipped.3ds", files[i]), loadObjectsInAChild));
  Results results;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const bool isLoaded = loadsFinite(writeFile("flipped.3ds", files[i]), loadObjectsHere);
    if (i % kChildEvery == 0) {
      EXPECT_EQ(inChild[i / kChildEvery], isLoaded) << i;
    }
    ++(isLoaded ? results.loaded : results.refused);
  }
  return results;
}

TEST(Damaged3ds, FlippedBytesGiveAnErrorOrAFiniteModelInBoundedMemory) {
  std::vector<std::string> files;
  for (const char* name : {"l_prism.3ds", "t_handle.3ds", "cradle_frame.3ds"}) {
    std::string whole = bytesOf(asset(name));
    if (whole.size() < 1000) whole = appendedToMain(whole, keyframer(kPositionTrack, 1, std::string(18, '\0')));
    for (unsigned seed = 0; seed < 200; ++seed) {
      std::mt19937 random(seed);
      std::string bytes = whole;
      for (int flip = 0; flip < 1 + static_cast<int>(seed % 8); ++flip)
        bytes[random() % bytes.size()] = static_cast<char>(random());
      files.push_back(std::move(bytes));
    }
  }
  const Results results = loadAll(files);
  EXPECT_GT(results.loaded, 50);
  EXPECT_GT(results.refused, 50);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 1L << 20) << "KiB at most in use";
}

TEST(Damaged3ds, FlippedHeadersGiveAnErrorOrAFiniteModel) {
  // The first bytes hold most of the identifiers, sizes and counts.
  const std::string whole = bytesOf(asset("box.3ds"));
  std::vector<std::string> files;
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    std::string bytes = whole;
    bytes[random() % 160] ^= static_cast<char>(1 << random() % 8);
    files.push_back(std::move(bytes));
  }
  loadAll(files);
}

}  // namespace
}  // namespace cradle
