#include <gmock/gmock.h>
#include <sys/resource.h>

#include <array>
#include <filesystem>
#include <random>

#include "chunks_3ds.h"
#include "mesh/imported_bytes.h"
#include "test_files.h"

// Meshes that a stranger made: they read no files but those below their folder, and what parses them has little memory
// and time.

namespace cradle {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A folder of the user's with a secret, and in it the stranger's folder with its meshes.
class StrangersMesh : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "meshes/deeper");
    write("secret.bin", std::string(36, 's'));
    write("secret.mtl", "newmtl hidden\nKd 1 0 0\n");
    write("meshes/near.bin", triangle());
    write("meshes/deeper/far.bin", triangle());
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }

  static std::string triangle() {
    const std::array<float, 9> corners{0, 0, 0, 1, 0, 0, 0, 1, 0};
    return {reinterpret_cast<const char*>(corners.data()), sizeof corners};
  }

  /// A triangle whose corners are in another file.
  std::string gltf(const std::string& uri) const {
    return write("meshes/t.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"name": "t", "mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": ")" +
                                      uri + "\"}]}");
  }

  std::string obj(const std::string& library) const {
    return write("meshes/t.obj",
                 "mtllib " + library + "\nusemtl hidden\n" + "o t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("strangers_" + std::to_string(getpid()));
};

TEST_F(StrangersMesh, ReadsFilesBelowItsFolder) {
  for (const std::string uri : {"near.bin", "./near.bin", "deeper/far.bin", "deeper/../near.bin"})
    EXPECT_EQ(loadModel({gltf(uri), "", 1}).model.solid.triangles.size(), 1u) << uri;
}

TEST_F(StrangersMesh, ReadsNoFileOutsideOfItsFolder) {
  fs::create_symlink(folder_ / "secret.bin", folder_ / "meshes/link.bin");
  fs::create_symlink(folder_, folder_ / "meshes/up");
  for (const std::string uri : {"../secret.bin", "deeper/../../secret.bin", "link.bin", "up/secret.bin"})
    EXPECT_THAT(loadingError({gltf(uri), "", 1}), HasSubstr("not below its folder")) << uri;
  // A whole path is put behind the folder that the mesh is named with, or stands alone if there is none.
  const std::string whole = gltf((folder_ / "secret.bin").string());
  EXPECT_THAT(loadingError({whole, "", 1}), HasSubstr("could not open"));
  const fs::path before = fs::current_path();
  fs::current_path(folder_ / "meshes");
  EXPECT_THAT(loadingError({"t.gltf", "", 1}), HasSubstr("not below its folder"));
  fs::current_path(before);
  EXPECT_THAT(loadingError({obj("../secret.mtl"), "", 1}), AllOf(HasSubstr("not below"), Not(HasSubstr("hidden"))));
  // The importer takes all names of libraries for relative ones.
  const LoadedModel loaded = loadModel({obj((folder_ / "secret.mtl").string()), "", 1});
  EXPECT_NE(loaded.model.drawn.materials.at(0).baseColor, Vec3f(1, 0, 0));
}

// Files that came from elsewhere name materials of elsewhere: one that is not there gives nothing away.
TEST_F(StrangersMesh, NeedsNoMaterialsThatAreMissing) {
  EXPECT_EQ(loadModel({obj("/no/such/folder/t.mtl"), "", 1}).model.solid.triangles.size(), 1u);
}

TEST_F(StrangersMesh, MayBeALinkOfTheUsers) {
  write("t.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
        "face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  fs::create_symlink(folder_ / "t.ply", folder_ / "meshes/link.ply");
  EXPECT_EQ(loadModel({(folder_ / "meshes/link.ply").string(), "", 1}).model.solid.triangles.size(), 1u);
}

// The importer walks the names of a node one in the other until the stack ends.
TEST(Strangers3ds, WithNodesOfManyNamesIsRefused) {
  const std::string box = std::string("Box") + '\0' + std::string(4, '\0') + "\xFF\xFF";
  for (const int count : {2, 20'000}) {
    std::string names;
    for (int i = 0; i < count; ++i) names += chunk(0xB010, box);
    const std::string track = chunk(0xB000, chunk(0xB002, names));
    const std::string path = writeFile("names.3ds", appendedToMain(bytesOf(asset("box.3ds")), track));
    EXPECT_THAT(loadingError({path, "", 1}), HasSubstr("two names")) << count;
    fs::remove(path);
  }
}

// 1400 bytes of memory for 7 of the file.
TEST(Strangers3ds, WithAMillionMaterialsIsRefused) {
  for (const int count : {4097, 100'000, 1'000'000}) {
    std::string materials;
    for (int i = 0; i < count; ++i) materials += chunk(0xAFFF, "m");
    const std::string path = writeFile("materials.3ds", chunk(0x4D4D, chunk(0x3D3D, materials)));
    EXPECT_THAT(loadingError({path, "", 1}), HasSubstr("more than 4096 materials")) << count;
    fs::remove(path);
  }
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  EXPECT_LT(usage.ru_maxrss, 1L << 20) << "KiB at most in use";
}

std::vector<ImportedObject> sampleObjects() {
  MeshPiece piece;
  piece.corners = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  piece.normals = {Vec3f(0, 0, 1), Vec3f(0, 0, 1), Vec3f(0, 0, 1)};
  piece.smoothing = {7};
  piece.material = 3;
  piece.look = {"brass", Vec3f(1, 0.5f, 0), 0, 0};
  MeshPiece plain = piece;
  plain.normals.clear();
  return {{"a", {piece, plain}}, {"", {}}};
}

TEST(ImportedBytes, GiveTheObjectsBack) {
  const std::string bytes = bytesOf(sampleObjects());
  const std::vector<ImportedObject> objects = objectsFromBytes(bytes, "a.obj");
  ASSERT_EQ(objects.size(), 2u);
  EXPECT_EQ(objects[0].name, "a");
  ASSERT_EQ(objects[0].pieces.size(), 2u);
  EXPECT_EQ(objects[0].pieces[0].look.name, "brass");
  EXPECT_EQ(bytesOf(objects), bytes);
}

// The process that parsed a file may be the file's by then.
TEST(ImportedBytes, ThatAreNoneAreRefused) {
  const std::string whole = bytesOf(sampleObjects());
  const auto isRefused = [](const std::string& bytes) {
    try {
      bytesOf(objectsFromBytes(bytes, "a.obj"));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::mesh);
      EXPECT_THAT(error.what(), HasSubstr("a.obj"));
      return true;
    }
    return false;
  };
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_TRUE(isRefused(whole.substr(0, size))) << size;
  EXPECT_TRUE(isRefused(whole + '\0'));
  int refused = 0;
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = whole;
    for (unsigned flips = 1 + random() % 4; flips > 0; --flips)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    refused += isRefused(bytes);
  }
  EXPECT_GT(refused, 5000);
}

}  // namespace
}  // namespace cradle
