// Textures of mesh files, and what becomes of those that cannot be drawn.

#include "mesh/texture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "image/png.h"
#include "mesh/fill_holes.h"
#include "mesh/import_mesh.h"
#include "mesh/imported_bytes.h"
#include "test_files.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace cradle {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Smooth, and of no symmetry.
Image slope(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      image.at(x, y)[0] = static_cast<std::uint8_t>(4 * x);
      image.at(x, y)[1] = static_cast<std::uint8_t>(5 * y);
      image.at(x, y)[2] = static_cast<std::uint8_t>(250 - 2 * x);
    }
  return image;
}

std::string pngOf(const Image& image) {
  const std::vector<std::uint8_t> bytes = encodePng(image);
  return {bytes.begin(), bytes.end()};
}

std::string jpegOf(const Image& image) {
  std::string bytes;
  const auto append = [](void* to, void* from, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(from), static_cast<std::size_t>(size));
  };
  stbi_write_jpg_to_func(append, &bytes, image.width, image.height, 3, image.pixels.data(), 95);
  return bytes;
}

/// A folder of its own for the files of a test.
std::string folderOfTest() {
  const std::string folder =
      testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + "_textures/";
  std::filesystem::create_directories(folder);
  return folder;
}

void writeInto(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A tetrahedron as an .obj file that names a material of `mtl`, with texture coordinates unless `hasCoordinates` is
/// not set; the path.
std::string writeTetrahedron(const std::string& mtl, bool hasCoordinates = true) {
  const std::string folder = folderOfTest();
  writeInto(folder + "t.mtl", "newmtl m\n" + mtl);
  std::string text = "mtllib t.mtl\no t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  if (hasCoordinates) text += "vt 0.25 0.125\nvt 1.5 0\nvt 0 1\n";
  text += "usemtl m\n";
  text += hasCoordinates ? "f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n"
                         : "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  writeInto(folder + "t.obj", text);
  return folder + "t.obj";
}

TEST(Texture, OfAPngHasItsPixels) {
  const Image image = slope(40, 23);
  const TexturePixels pixels = decodeTexture({"a.png", pngOf(image)});
  EXPECT_EQ(pixels.width, 40);
  EXPECT_EQ(pixels.height, 23);
  EXPECT_EQ(pixels.rgb, image.pixels);
}

TEST(Texture, OfAJpegIsNearItsPixels) {
  const Image image = slope(40, 23);
  const TexturePixels pixels = decodeTexture({"a.jpg", jpegOf(image)});
  ASSERT_EQ(pixels.rgb.size(), image.pixels.size());
  for (std::size_t i = 0; i < pixels.rgb.size(); ++i)
    EXPECT_NEAR(pixels.rgb[i], image.pixels[i], 8) << i;  // quality 95: steps of a few levels
}

TEST(Texture, OfOtherFilesIsRefused) {
  const std::string png = pngOf(slope(40, 23));
  const std::string wide = pngOf(Image(kMaxTextureSide + 1, 1));
  EXPECT_EQ(textureFault(png), "");
  EXPECT_EQ(textureFault("BM, a bitmap"), "is neither a PNG nor a JPEG file");
  EXPECT_THAT(textureFault(png.substr(0, png.size() / 2)), HasSubstr("cannot be decoded"));
  EXPECT_THAT(textureFault(wide), AllOf(HasSubstr("is 8193x1 pixels"), HasSubstr("at most 8192")));
  const auto errorOfReading = [](const std::string& path) -> std::string {
    try {
      readTexture(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::mesh);
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(errorOfReading(writeFile("a.png", "GIF89a")), HasSubstr("is neither a PNG nor a JPEG file; save"));
  EXPECT_THAT(errorOfReading("nowhere.png"), HasSubstr("no such file"));
  EXPECT_EQ(errorOfReading(writeFile("b.png", png)), "");
}

// Only a trajectory can hold bytes that nobody has decoded before.
TEST(Texture, OfDamagedBytesIsTheTrajectorysFault) {
  try {
    decodeTexture({"a.png", "\x89PNG\r\n\x1a\n and no more"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("damaged texture of the trajectory"));
  }
}

TEST(Texture, OfAMaterialIsReadWithItsCoordinatesAndColour) {
  const std::string png = pngOf(slope(8, 8)), path = writeTetrahedron("Kd 0.5 0.25 1\nmap_Kd wood.png\n");
  writeInto(folderOfTest() + "wood.png", png);
  const LoadedModel loaded = loadModel({path, "", 1});
  const DrawnMesh& drawn = loaded.model.drawn;
  EXPECT_THAT(loaded.notes, IsEmpty());
  ASSERT_EQ(drawn.materials.size(), 1U);
  ASSERT_NE(drawn.materials[0].texture, nullptr);
  EXPECT_EQ(drawn.materials[0].texture->name, "wood.png");
  EXPECT_EQ(drawn.materials[0].texture->bytes, png);
  EXPECT_EQ(drawn.materials[0].baseColor, Vec3f(0.5f, 0.25f, 1));
  ASSERT_EQ(drawn.textureCoordinates.size(), drawn.vertices.size());
  // The first corner of the first three faces is vertex 0, of the last one vertex 1; each at the first coordinates.
  for (std::size_t face = 0; face < 4; ++face) {
    const std::uint32_t corner = drawn.triangles[face][0];
    EXPECT_EQ(drawn.textureCoordinates[corner], Vec2f(0.25f, 0.125f)) << face;
    EXPECT_EQ(drawn.vertices[corner], Vec3(face == 3 ? 1 : 0, 0, 0)) << face;
  }
}

// Programs on other machines write their own paths, and 3ds files capitals.
TEST(Texture, IsFoundBesideTheMeshUnderTheNamesThatFilesHave) {
  writeInto(folderOfTest() + "wood.png", pngOf(slope(8, 8)));
  for (const char* name : {"C:\\maps\\wood.png", "/home/somebody/wood.png", "WOOD.PNG", "../../wood.png"}) {
    const LoadedModel loaded = loadModel({writeTetrahedron(fmt::format("map_Kd {}\n", name)), "", 1});
    EXPECT_THAT(loaded.notes, IsEmpty()) << name;
    EXPECT_NE(loaded.model.drawn.materials.at(0).texture, nullptr) << name;
  }
}

TEST(Texture, ThatCannotBeDrawnIsANoteAndNoFault) {
  const std::string folder = folderOfTest();
  writeInto(folder + "wood.png", pngOf(slope(8, 8)));
  writeInto(folder + "wood.bmp", "BM");
  const auto notesOf = [](const std::string& mtl, bool hasCoordinates) {
    const LoadedModel loaded = loadModel({writeTetrahedron(mtl, hasCoordinates), "", 1});
    EXPECT_EQ(loaded.model.drawn.materials.at(0).texture, nullptr);
    EXPECT_THAT(loaded.model.drawn.textureCoordinates, IsEmpty());
    return loaded.notes;
  };
  EXPECT_THAT(notesOf("map_Kd oak.png\n", true), ElementsAre(HasSubstr("\"oak.png\" is not in the folder")));
  EXPECT_THAT(notesOf("map_Kd wood.bmp\n", true), ElementsAre(HasSubstr("\"wood.bmp\" is neither a PNG nor a JPEG")));
  EXPECT_THAT(notesOf("map_Kd wood.png\n", false), ElementsAre(HasSubstr("\"wood.png\" has no coordinates")));
}

// A seam of texture coordinates doubles vertices: not where nobody draws the texture.
TEST(Texture, CoordinatesAreKeptWhereSomebodyAsks) {
  const std::string path = writeTetrahedron("Kd 1 1 1\n");
  EXPECT_THAT(loadModel({path, "", 1}).model.drawn.textureCoordinates, IsEmpty());
  const Model textured = loadModel({path, "", 1, UpAxis::ofFormat, false, true}).model;
  EXPECT_EQ(textured.drawn.textureCoordinates.size(), textured.drawn.vertices.size());
  EXPECT_EQ(textured.solid.vertices.size(), 4U);
}

TEST(Texture, OfPiecesIsSharedAcrossTheBoundaryOfTheChild) {
  const auto texture = std::make_shared<const Texture>(Texture{"a.png", std::string("\0bytes", 6)});
  MeshPiece piece;
  piece.corners = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  piece.smoothing = {kSmoothingUnknown};
  piece.look.texture = texture;
  piece.textureCoordinates = {{0, 0}, {1, 0}, {0, 1}};
  MeshPiece plain = piece;
  plain.look.texture = nullptr;
  plain.textureCoordinates.clear();
  plain.textureFault = "its texture is left out";
  const auto objects = objectsFromBytes(bytesOf({{"a", {piece, plain}}, {"b", {piece}}}), "file");
  const MeshPiece& first = objects.at(0).pieces.at(0);
  EXPECT_EQ(first.look.texture->name, "a.png");
  EXPECT_EQ(first.look.texture->bytes, texture->bytes);
  EXPECT_EQ(first.textureCoordinates, piece.textureCoordinates);
  EXPECT_EQ(objects.at(0).pieces.at(1).look.texture, nullptr);
  EXPECT_EQ(objects.at(0).pieces.at(1).textureFault, plain.textureFault);
  EXPECT_EQ(objects.at(1).pieces.at(0).look.texture, first.look.texture);
}

}  // namespace
}  // namespace cradle
