#include "mesh/load_mesh.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cmath>
#include <filesystem>

#include "mesh/mass_properties.h"
#include "mesh/mesh_library.h"
#include "mesh/solid.h"
#include "sample_meshes.h"
#include "test_files.h"

namespace cradle {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// An L prism under a node with `matrix` (row by row), as Collada text: the plainest format with node transforms.
std::string colladaText(const std::string& matrix) {
  std::string positions, indices;
  const TriangleMesh mesh = lPrismMesh();
  for (const Vec3& v : mesh.vertices)
    positions += std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + " ";
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) indices += std::to_string(corner) + " ";
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh><source id="p"><float_array id="a" count="36">)" +
         positions + R"(</float_array><technique_common><accessor source="#a" count="12" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
</source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="20"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         indices + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="outer" name="outer"><translate>10 0 0</translate>
<node id="inner" name="inner"><matrix>)" +
         matrix + R"(</matrix><instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

void expectOutwardNormals(const DrawnMesh& drawn) {
  for (const auto& [a, b, c] : drawn.triangles) {
    const Vec3 face = (drawn.vertices[b] - drawn.vertices[a]).cross(drawn.vertices[c] - drawn.vertices[a]).normalized();
    for (const std::uint32_t corner : {a, b, c}) EXPECT_GT(face.dot(drawn.normals[corner].cast<double>()), 0.99);
  }
}

TEST(LoadMesh, SolidIsTheWeldedDrawnMesh) {
  // A trajectory file holds the drawn mesh only and welds it again.
  for (const char* name : {"ball.3ds", "gear.3ds", "cradle_frame.3ds"}) {
    const Model model = loadModel({asset(name), "", 0.1}).model;
    const TriangleMesh again = weld(model.drawn.vertices, model.drawn.triangles);
    EXPECT_EQ(again.vertices, model.solid.vertices);
    EXPECT_EQ(again.triangles, model.solid.triangles);
  }
}

TEST(LoadMesh, ZUpOf3dsBecomesYUp) {
  // The L prism in the file lies in x and z, up to 0.3 and 0.2, and reaches to -0.1 in y.
  const Model model = loadModel({asset("l_prism.3ds"), "", 1}).model;
  Bounds bounds;
  for (const Vec3& vertex : model.solid.vertices) bounds.extend(vertex);
  constexpr double kFloat = 3e-8;  // 6e-8 of half a metre
  EXPECT_LE((bounds.min() - Vec3(0, 0, 0)).norm(), kFloat);
  EXPECT_LE((bounds.max() - Vec3(0.3, 0.2, 0.1)).norm(), kFloat);
}

// The L prism's edges differ along all axes. An axis up is Y, and the solid stays right-handed.
TEST(LoadMesh, TheAxisThatPointsUpBecomesY) {
  const std::string path = writeFile("l.obj", objText(lPrismMesh(), "l"));
  const auto centerWith = [](const std::string& file, UpAxis up) {
    const TriangleMesh solid = loadModel({file, "", 1, up}).model.solid;
    EXPECT_GT(signedVolume(solid), 0);
    return computeMassProperties(solid, 1).centerOfMass;
  };
  const Vec3 inFile = centerWith(path, UpAxis::y);
  EXPECT_EQ(centerWith(path, UpAxis::ofFormat), inFile);
  EXPECT_LT((centerWith(path, UpAxis::z) - Vec3(inFile.x(), inFile.z(), -inFile.y())).norm(), 1e-15);
  EXPECT_LT((centerWith(path, UpAxis::x) - Vec3(-inFile.y(), inFile.x(), inFile.z())).norm(), 1e-15);
  const Vec3 of3ds = centerWith(asset("l_prism.3ds"), UpAxis::ofFormat);
  EXPECT_EQ(centerWith(asset("l_prism.3ds"), UpAxis::z), of3ds);
  EXPECT_LT((centerWith(asset("l_prism.3ds"), UpAxis::y) - Vec3(of3ds.x(), -of3ds.z(), of3ds.y())).norm(), 1e-15);
}

TEST(LoadMesh, ScaleMultipliesExactly) {
  const Model one = loadModel({asset("gear.3ds"), "", 1}).model,
              scaled = loadModel({asset("gear.3ds"), "", 1e-3}).model;
  ASSERT_EQ(one.solid.vertices.size(), scaled.solid.vertices.size());
  for (std::size_t v = 0; v < one.solid.vertices.size(); ++v)
    EXPECT_EQ(scaled.solid.vertices[v], Vec3(1e-3 * one.solid.vertices[v]));
  EXPECT_TRUE(checkSolid(scaled.solid).isSolid);
}

TEST(LoadMesh, MaterialsAreRangesWithTheirColours) {
  const DrawnMesh drawn = loadModel({asset("cradle_frame.3ds"), "", 1}).model.drawn;
  ASSERT_EQ(drawn.materials.size(), 3U);
  std::uint32_t next = 0;
  for (const ModelMaterial& material : drawn.materials) {
    EXPECT_EQ(material.firstTriangle, next);
    next += material.triangleCount;
  }
  EXPECT_EQ(next, drawn.triangles.size());
  EXPECT_EQ(drawn.materials[2].name, "Walnut");
  EXPECT_TRUE(drawn.materials[2].baseColor.isApprox(Vec3f(92, 58, 38) / 255));
}

TEST(LoadMesh, PiecesOfOneObjectAreOneSolid) {
  // Six sides in two materials: no piece is closed.
  const std::string materials = writeFile("two.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  std::string text = objText(boxMesh({1, 2, 3}), "box");
  text.insert(text.rfind("f ", text.size() - 40), "usemtl red\n");
  text.insert(text.find("f "), "mtllib " + std::filesystem::path(materials).filename().string() + "\nusemtl blue\n");
  const auto objects = loadObjects(writeFile("box.obj", text), 1);
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].model.drawn.materials.size(), 2U);
  EXPECT_TRUE(checkSolid(objects[0].model.solid).isSolid);
  EXPECT_EQ(objects[0].model.solid.vertices.size(), 8U);
}

TEST(LoadMesh, ObjectsAreFoundByName) {
  EXPECT_EQ(loadModel({asset("cradle_frame.3ds"), "Board", 1}).model.solid.vertices.size(), 12U);
  EXPECT_THAT(loadingError({asset("cradle_frame.3ds"), "Bord", 1}),
              AllOf(HasSubstr("cradle_frame.3ds"), HasSubstr("no object \"Bord\""),
                    HasSubstr("\"RailFront\", \"RailBack\", \"Board\"")));
}

TEST(LoadMesh, SolidAloneIsTheSolidOfTheWholeModel) {
  const auto whole = loadObjects(asset("cradle_frame.3ds"), 0.5);
  const auto alone = loadObjects(asset("cradle_frame.3ds"), 0.5, ModelParts::solidAlone);
  ASSERT_EQ(alone.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(alone[i].model.solid.vertices, whole[i].model.solid.vertices);
    EXPECT_EQ(alone[i].model.solid.triangles, whole[i].model.solid.triangles);
    EXPECT_TRUE(alone[i].model.drawn.vertices.empty());
  }
}

TEST(LoadMesh, WithoutObjectAllAreOneBody) {
  double sum = 0;
  for (const LoadedModel& object : loadObjects(asset("cradle_frame.3ds"), 1)) sum += signedVolume(object.model.solid);
  const LoadedModel all = loadModel({asset("cradle_frame.3ds"), "", 1});
  EXPECT_EQ(all.model.name, "cradle_frame");
  EXPECT_NEAR(signedVolume(all.model.solid), sum, 1e-14 * sum);
}

TEST(LoadMesh, SmoothingGroupsAreKept) {
  // Around the hole of the gear the wall is smooth, everything else sharp: 48 corners of the outline in 2 x 3 normals,
  // 48 of the hole in 2 x 2.
  const DrawnMesh drawn = loadModel({asset("gear.3ds"), "", 1}).model.drawn;
  EXPECT_EQ(drawn.vertices.size(), 48U * 6 + 48U * 4);
  for (std::size_t v = 0; v < drawn.vertices.size(); ++v) {
    const Vec3 p = drawn.vertices[v], n = drawn.normals[v].cast<double>();
    const Vec3 inward = -Vec3(p.x(), 0, p.z()).normalized();
    const bool isWallOfHole = std::hypot(p.x(), p.z()) < 0.06 && std::abs(n.y()) < 0.5;
    const bool isEnd = !isWallOfHole && std::abs(n.y()) > 1e-6;
    EXPECT_TRUE(!isWallOfHole || n.dot(inward) > std::cos(1e-3)) << n.transpose();
    EXPECT_TRUE(!isEnd || std::abs(n.y()) > 1 - 1e-6) << n.transpose();
  }
}

TEST(LoadMesh, MissingNormalsAreSmoothOnRoundThingsAndSharpAtEdges) {
  const Model cylinder = loadModel({writeFile("c.obj", objText(prismMesh(32, 1, 2), "c")), "", 1}).model;
  // Rims have a normal for the end and one for the side; the middles of the ends one.
  EXPECT_EQ(cylinder.drawn.vertices.size(), 4U * 32 + 2);
  expectOutwardNormals(cylinder.drawn);
  EXPECT_EQ(loadModel({writeFile("l.obj", objText(lPrismMesh(), "l")), "", 1}).model.drawn.vertices.size(), 36U);
}

TEST(LoadMesh, InsideOutMeshIsTurnedWithItsNormals) {
  const LoadedModel loaded = loadModel({writeFile("l.obj", objText(insideOut(lPrismMesh()), "l")), "", 1});
  EXPECT_THAT(loaded.notes, ElementsAre(HasSubstr("inside-out")));
  EXPECT_DOUBLE_EQ(signedVolume(loaded.model.solid), 4);
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid);
  expectOutwardNormals(loaded.model.drawn);
  const TriangleMesh again = weld(loaded.model.drawn.vertices, loaded.model.drawn.triangles);
  EXPECT_EQ(again.vertices, loaded.model.solid.vertices);
  EXPECT_EQ(again.triangles, loaded.model.solid.triangles);
}

// The L prism of volume 4 below, a box of volume 1 above it, inside-out.
TriangleMesh prismAndTurnedBox() {
  return joined(lPrismMesh(),
                insideOut(moved(boxMesh({1, 1, 1}), [](const Vec3& v) { return Vec3(v + Vec3(0.5, 5, 0)); })));
}

TEST(LoadMesh, APartThatIsInsideOutIsTurnedAlone) {
  for (const ModelParts parts : {ModelParts::solidAlone, ModelParts::solidAndDrawn}) {
    const LoadedModel loaded = loadObjects(writeFile("two.obj", objText(prismAndTurnedBox(), "two")), 1, parts).at(0);
    EXPECT_THAT(loaded.notes, ElementsAre("part 2 of 2 (12 triangles around (0.5, 5, 0)) was inside-out: turned"));
    EXPECT_NEAR(signedVolume(loaded.model.solid), 5, 1e-14);
    EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid);
    expectOutwardNormals(loaded.model.drawn);
  }
}

TEST(LoadMesh, EqualPartsOfWhichOneIsInsideOutHaveBothVolumes) {
  const TriangleMesh both =
      joined(lPrismMesh(), insideOut(moved(lPrismMesh(), [](const Vec3& v) { return Vec3(v + Vec3(0, 5, 0)); })));
  const LoadedModel loaded = loadModel({writeFile("two.obj", objText(both, "two")), "", 1});
  EXPECT_NEAR(signedVolume(loaded.model.solid), 8, 1e-14);
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid);
}

TEST(LoadMesh, ACavityStaysInItsObjectAndAmongObjects) {
  const TriangleMesh outer = boxMesh({4, 4, 4}), cavity = insideOut(boxMesh({1, 2, 3}));
  const LoadedModel one = loadModel({writeFile("one.obj", objText(joined(outer, cavity), "one")), "", 1});
  EXPECT_THAT(one.notes, IsEmpty());
  EXPECT_NEAR(signedVolume(one.model.solid), 64 - 6, 1e-13);
  EXPECT_TRUE(checkSolid(one.model.solid).isSolid);
  // A cavity as an object of its own is one in what holds it, and a box that is inside-out by itself.
  std::string second = "o cavity\n" + objText(cavity, "cavity").substr(9);
  for (const auto& [a, b, c] : cavity.triangles) {
    const std::string was =
        "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
    second.replace(second.find(was), was.size(),
                   "f " + std::to_string(a + 9) + " " + std::to_string(b + 9) + " " + std::to_string(c + 9) + "\n");
  }
  const std::string path = writeFile("apart.obj", objText(outer, "outer") + second);
  const LoadedModel whole = loadModel({path, "", 1});
  EXPECT_NEAR(signedVolume(whole.model.solid), 64 - 6, 1e-13);
  EXPECT_TRUE(checkSolid(whole.model.solid).isSolid);
  const TriangleMesh again = weld(whole.model.drawn.vertices, whole.model.drawn.triangles);
  EXPECT_EQ(again.triangles, whole.model.solid.triangles);
  EXPECT_NEAR(signedVolume(loadModel({path, "cavity", 1}).model.solid), 6, 1e-14);
}

TEST(LoadMesh, OpenMeshIsNotTurned) {
  TriangleMesh open = insideOut(lPrismMesh());
  open.triangles.pop_back();
  const LoadedModel loaded = loadModel({writeFile("l.obj", objText(open, "l")), "", 1});
  EXPECT_THAT(loaded.notes, IsEmpty());
  EXPECT_LT(signedVolume(loaded.model.solid), 0);
}

TEST(LoadMesh, NodeTransformsAreChained) {
  const LoadedModel loaded =
      loadModel({writeFile("l.dae", colladaText("0 -2 0 1  2 0 0 2  0 0 2 3  0 0 0 1")), "inner", 1});
  EXPECT_DOUBLE_EQ(signedVolume(loaded.model.solid), 32);
  // Centre of mass (5/4, 3/4, 1/2), turned by 90 degrees about z, doubled, shifted by (1, 2, 3) and (10, 0, 0).
  const Vec3 expected(11 - 1.5, 2 + 2.5, 3 + 1);
  EXPECT_LE((computeMassProperties(loaded.model.solid, 1).centerOfMass - expected).norm(), 1e-14 * expected.norm());
  expectOutwardNormals(loaded.model.drawn);
}

TEST(LoadMesh, MirroringNodeDoesNotTurnInsideOut) {
  const LoadedModel loaded = loadModel({writeFile("l.dae", colladaText("-1 0 0 0  0 1 0 0  0 0 3 0  0 0 0 1")), "", 1});
  EXPECT_THAT(loaded.notes, IsEmpty());  // it never was inside-out
  EXPECT_DOUBLE_EQ(signedVolume(loaded.model.solid), 12);
  EXPECT_DOUBLE_EQ(computeMassProperties(loaded.model.solid, 1).centerOfMass.x(), 10 - 1.25);
  expectOutwardNormals(loaded.model.drawn);
}

TEST(LoadMesh, DegenerateTrianglesAreDroppedAndCounted) {
  const std::string text = objText(lPrismMesh(), "l") + "f 1 1 2\nf 3 4 4\n";
  const LoadedModel loaded = loadModel({writeFile("l.obj", text), "", 1});
  EXPECT_THAT(loaded.notes, ElementsAre("2 degenerate triangles dropped"));
  EXPECT_EQ(loaded.model.drawn.triangles.size(), 20U);
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid);
}

TEST(LoadMesh, PolygonsAreCutIntoTriangles) {
  const std::string text =
      "o l\nv 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 3 0 1\nv 3 1 1\nv 1 1 1\n"
      "v 1 2 1\nv 0 2 1\nf 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\n"
      "f 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";
  const LoadedModel loaded = loadModel({writeFile("l.obj", text), "", 1});
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid);
  EXPECT_DOUBLE_EQ(signedVolume(loaded.model.solid), 4);
}

TEST(LoadMesh, SideFilesAreFoundBesideTheMesh) {
  const std::string materials = writeFile("side.mtl", "newmtl red\nKd 0.8 0.1 0.2\n");
  const std::string text = "mtllib " + std::filesystem::path(materials).filename().string() + "\nusemtl red\n";
  const LoadedModel loaded = loadModel({writeFile("l.obj", text + objText(lPrismMesh(), "l")), "", 1});
  EXPECT_TRUE(loaded.model.drawn.materials.at(0).baseColor.isApprox(Vec3f(0.8f, 0.1f, 0.2f)));
  // Without them the mesh is the same, in the colour of bodies that have none.
  const LoadedModel plain = loadModel({writeFile("p.obj", "mtllib none.mtl\n" + objText(lPrismMesh(), "l")), "", 1});
  EXPECT_EQ(plain.model.solid.vertices, loaded.model.solid.vertices);
  EXPECT_EQ(plain.model.drawn.materials.at(0).baseColor, ModelMaterial{}.baseColor);
}

TEST(LoadMesh, LinearColoursOfGltfBecomeSrgb) {
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string buffer = writeFile("t.bin", {reinterpret_cast<const char*>(corners), sizeof corners});
  const std::string text = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"name": "t", "mesh": 0}], "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0, 0.2140411, 1, 1]}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}], "accessors": [{"bufferView": 0,
"componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": ")" +
                           std::filesystem::path(buffer).filename().string() + "\"}]}";
  const DrawnMesh drawn = loadModel({writeFile("t.gltf", text), "t", 1}).model.drawn;
  EXPECT_LE((drawn.materials.at(0).baseColor - Vec3f(0, 0.5f, 1)).norm(), 1e-6f);  // 0.2140411 is sRGB 0.5
}

TEST(LoadMesh, FilesThatAreNoneAreNamed) {
  EXPECT_THAT(loadingError({"no/such/mesh.3ds", "", 1}),
              AllOf(HasSubstr("no/such/mesh.3ds"), HasSubstr("no such file")));
  EXPECT_THAT(loadingError({testing::TempDir(), "", 1}), HasSubstr("is a directory"));
  EXPECT_THAT(loadingError({"/dev/zero", "", 1}), HasSubstr("not a regular file"));
  EXPECT_THAT(loadingError({writeFile("empty.3ds", ""), "", 1}), HasSubstr("is empty"));
  EXPECT_THAT(loadingError({writeFile("noise.obj", "what is this\n"), "", 1}), HasSubstr("noise.obj"));
  EXPECT_THAT(loadingError({writeFile("noise.xyz", "what is this\n"), "", 1}), HasSubstr("cannot be read as a mesh"));
}

TEST(LoadMesh, FileOverTheSizeLimitIsRefusedUnread) {
  const std::string path = writeFile("large.obj", "o l\n");
  std::filesystem::resize_file(path, (256U << 20) + 1);  // sparse
  EXPECT_THAT(loadingError({path, "", 1}), HasSubstr("more than the 256 MB allowed"));
  std::filesystem::remove(path);
}

TEST(LoadMesh, PointsAndLinesAreNoMesh) {
  EXPECT_THAT(loadingError({writeFile("points.obj", "v 0 0 0\nv 1 0 0\np 1 2\nl 1 2\n"), "", 1}), HasSubstr("points"));
}

TEST(LoadMesh, VerticesThatAreNotFiniteAreRefused) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n";
  EXPECT_THAT(loadingError({writeFile("nan.ply", ply), "", 1}), AllOf(HasSubstr("nan.ply"), HasSubstr("not finite")));
}

TEST(LoadMesh, ImporterThatNeverReturnsIsAnError) {
  // Without an end of its header a .ply file is searched for ever.
  const std::string ply =
      "ply\nformat ascii 1\nelement vertex 3\nproperty float x\nelement face 1\nproperty list uchar int "
      "vertex_indices\nen_header\n0\n0\n1\n3 0 1 2\n";
  EXPECT_THAT(loadingError({writeFile("endless.ply", ply), "", 1}), HasSubstr("endless.ply"));
}

TEST(LoadMesh, CountsThatTheFileCannotHoldDoNotTakeTheMachinesMemory) {
  // 48 GB of vertices, promised by 200 bytes.
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_THAT(loadingError({writeFile("large.ply", ply), "", 1}), HasSubstr("large.ply"));
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  EXPECT_LT(usage.ru_maxrss, 5L << 18) << "KiB at most in use";  // the limit is a GiB
}

TEST(MeshLibrary, ParsesAFileOnceForAllScalesAndObjects) {
  const std::string path = writeFile("l.obj", objText(lPrismMesh(), "l"));
  MeshLibrary library;
  const Model once = library.load({path, "", 1}).model;
  std::filesystem::remove(path);  // what is read again is missed
  const std::string detour = std::filesystem::path(path).parent_path() / "." / std::filesystem::path(path).filename();
  const Model twice = library.load({detour, "l", 0.1}).model;
  ASSERT_EQ(twice.solid.vertices.size(), once.solid.vertices.size());
  for (std::size_t i = 0; i < once.solid.vertices.size(); ++i)
    EXPECT_EQ(twice.solid.vertices[i], 0.1 * once.solid.vertices[i]);
}

TEST(MeshLibrary, DoesNotTryAgainWhatCannotBeRead) {
  const std::string path = writeFile("l.obj", "nothing");
  MeshLibrary library;
  EXPECT_THROW(library.load({path, "", 1}), Error);
  writeFile("l.obj", objText(lPrismMesh(), "l"));
  EXPECT_THROW(library.load({path, "", 2}), Error);
}

TEST(LoadMesh, ObjFilesOfTooManyPartsAreRefusedBeforeTheyTakeMemory) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i <= 100'000; ++i) text += fmt::format("{} {}\n", i % 2 == 0 ? "g" : "usemtl", i);
  EXPECT_THAT(loadingError({writeFile("parts.obj", text + "f 1 2 3\n"), "", 1}),
              HasSubstr("100001 objects, groups and changes of material; at most 100000"));
}

}  // namespace
}  // namespace cradle
