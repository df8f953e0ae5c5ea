// Real files of the Debian packages assimp-testmodels and glmark2-data.

#include <gmock/gmock.h>

#include <filesystem>
#include <set>

#include "mesh/mass_properties.h"
#include "mesh/recognise_shape.h"
#include "mesh/solid.h"
#include "test_files.h"

namespace cradle {
namespace {

using testing::HasSubstr;

const std::string kModels = "/usr/share/assimp/models/";
const std::string kAsteroid = "/usr/share/glmark2/models/asteroid-high.3ds";

struct KnownVolume {
  std::string file, object;
  double volume;  // of the file's raw vertices, summed as rational numbers by a program that shares no code with this
};

// Objects that the file animates are moved back by the inverse of their mesh matrix, and to their first key, all in
// floats: each coordinate is off by some 6e-8 of its distance from the origin, up to six times the size of the object.
constexpr double kMovedInFloats = 3e-6;

void expectSolid(const KnownVolume& known, double tolerance, const std::string& shape) {
  ASSERT_TRUE(std::filesystem::exists(known.file))
      << "install the packages assimp-testmodels and glmark2-data (./run packages)";
  const LoadedModel loaded = loadModel({known.file, known.object, 1});
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid) << known.file << " " << known.object;
  EXPECT_NEAR(signedVolume(loaded.model.solid), known.volume, tolerance * known.volume) << known.file << known.object;
  EXPECT_EQ(shapeName(recogniseShape(loaded.model.solid)), shape) << known.file << " " << known.object;
}

TEST(PackageModels, AnimatedCubesOf3dsAreBoxesOfTheirVolume) {
  const std::string folder = kModels + "3DS/";
  for (const KnownVolume& known :
       std::vector<KnownVolume>{{"CameraRollAnim.3ds", "Box01", 131032.35481360482},
                                {"CameraRollAnimWithChildObject.3ds", "Box01", 131032.35481360482},
                                {"CameraRollAnimWithChildObject.3ds", "Box02", 95904.8212818726},
                                {"RotatingCube.3DS", "Box01", 174890.3106560627},
                                {"TargetCameraAnim.3ds", "Box01", 131032.35481360482},
                                {"cube_with_diffuse_texture.3DS", "Quader01", 125000.0015280087},
                                {"cube_with_specular_texture.3DS", "Quader01", 125000.0015280087},
                                {"cubes_with_alpha.3DS", "Quader01", 999999.9856948893},
                                {"cubes_with_alpha.3DS", "Quader02", 7999999.694824219},
                                {"cubes_with_alpha.3DS", "Quader03", 27000000.0},
                                {"cubes_with_alpha.3DS", "Quader04", 64000002.44140625},
                                {"cubes_with_alpha.3DS", "Quader05", 125000007.62939453},
                                {"test1.3ds", "Box01", 80.67241813769806},
                                {"test1.3ds", "Box02", 76.80752979441367},
                                {"test1.3ds", "Box04", 80.68323435558784},
                                {"test1.3ds", "Box05", 8.349801137664857},
                                {"test1.3ds", "Box06", 8.349797995888565},
                                {"test1.3ds", "Box07", 8.349806893029935},
                                {"test1.3ds", "Box08", 76.80760065218415},
                                {"test1.3ds", "Box09", 80.74082063950652},
                                {"test1.3ds", "Box10", 80.67246228494467}})
    expectSolid({folder + known.file, known.object, known.volume}, kMovedInFloats, "box");
}

TEST(PackageModels, Plain3dsFilesHaveTheirExactVolume) {
  expectSolid({kModels + "3DS/fels.3ds", "Default", 37.21471328258812}, 1e-14, "mesh");
  expectSolid({kAsteroid, "Icosphere.00", 3.632410376803803}, 1e-14, "mesh");
}

TEST(PackageModels, All3dsFilesAreSolidsAsAWholeUnlessTheirBoxesOverlap) {
  // By sizes and centres of their boxes alone: those of the first overlap by 14 to 30 units of 100 and more in all
  // three axes, the walls of the second by up to 0.4 x 20 x 0.06 at their corners.
  const std::set<std::string> overlapping = {"cubes_with_alpha.3DS", "test1.3ds"};
  const std::string folder = kModels + "3DS";
  ASSERT_TRUE(std::filesystem::exists(folder)) << "install the package assimp-testmodels (./run packages)";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension != ".3ds" && extension != ".3DS") continue;
    ++files;
    const SolidReport report = checkSolid(loadModel({entry.path(), "", 1}).model.solid);
    EXPECT_TRUE(report.isClosed) << entry.path();
    EXPECT_EQ(report.isSolid, !overlapping.contains(entry.path().filename())) << entry.path();
  }
  EXPECT_EQ(files, 9);
}

TEST(PackageModels, OtherFormatsLoadToo) {
  expectSolid({kModels + "OBJ/box.obj", "", 1}, 1e-14, "box");
  expectSolid({kModels + "OBJ/cube_usemtl.obj", "", 1}, 1e-14, "box");  // a material a side
  expectSolid({kModels + "PLY/cube.ply", "", 1}, 1e-14, "box");
  expectSolid({kModels + "PLY/cube_binary.ply", "", 1}, 1e-14, "box");
  expectSolid({kModels + "glTF2/BoxTextured-glTF/BoxTextured.gltf", "", 1}, 1e-14, "box");  // vertices in a .bin file
  expectSolid({kModels + "glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", "", 1}, 1e-14, "box");
}

TEST(PackageModels, HoleIsFoundInStl) {
  const std::string path = kModels + "STL/sphereWithHole.stl";
  ASSERT_TRUE(std::filesystem::exists(path)) << "install the package assimp-testmodels (./run packages)";
  const SolidReport report = checkSolid(loadModel({path, "", 1}).model.solid);
  EXPECT_FALSE(report.isSolid);
  EXPECT_THAT(report.problems.at(0), HasSubstr("9 edges open"));
}

TEST(PackageModels, InfiniteVerticesAreRefused) {
  const std::string path = kModels + "glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb";
  ASSERT_TRUE(std::filesystem::exists(path)) << "install the package assimp-testmodels (./run packages)";
  EXPECT_THAT(loadingError({path, "", 1}), HasSubstr("not finite"));
}

}  // namespace
}  // namespace cradle
