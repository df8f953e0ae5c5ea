// Bodies whose shape is a mesh: what only the mesh can show. The models are those of cubeModel.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// A scene with one body "a" of a mesh; `members` follow the shape, and may close the body and go on.
std::string meshScene(const std::string& mesh, const std::string& members) {
  return sceneWith("\"bodies\": [{\"name\": \"a\", \"shape\": {\"mesh\": \"models/" + mesh + "\"}" + members + "}]");
}

TEST(MeshBody, MassIsDensityTimesVolume) {
  const std::string text = sceneWith(R"("materials": {"m": {"density": 500}}, "bodies": [
    {"name": "a", "material": "m", "shape": {"mesh": "models/cube.3ds", "scale": 2}}])");
  const MassProperties properties = parse(text).scene.bodies.at(0).massProperties;
  // The cube [0, 2]^3: 8 m^3, each moment m s^2 / 6.
  EXPECT_NEAR(properties.mass, 4000, 1e-10);
  EXPECT_TRUE(properties.centerOfMass.isApprox(Vec3(1, 1, 1), 1e-14));
  EXPECT_TRUE(properties.inertiaTensor.isApprox(4000.0 * 4 / 6 * Mat3::Identity(), 1e-14));
}

TEST(MeshBody, MassAloneScalesTheUniformSolid) {
  const MassProperties properties = parse(meshScene("cube.3ds", R"(, "mass": 6)")).scene.bodies.at(0).massProperties;
  EXPECT_EQ(properties.mass, 6);
  EXPECT_TRUE(properties.centerOfMass.isApprox(Vec3(0.5, 0.5, 0.5), 1e-14));
  EXPECT_TRUE(properties.inertiaTensor.isApprox(Mat3::Identity(), 1e-14));
}

TEST(MeshBody, StaticOneMayBeOpenAndHasNoMass) {
  const Scene scene = parse(meshScene("open.3ds", R"(, "motion": "static")")).scene;
  EXPECT_EQ(scene.bodies.at(0).massProperties.mass, 0);
  EXPECT_EQ(std::get<ModelShape>(scene.bodies.at(0).shape).model, 0);
}

TEST(MeshBody, OpenOneThatMovesIsAnErrorWithRemedies) {
  const Error error = errorOf(meshScene("open.3ds", ""));
  EXPECT_EQ(error.kind(), ErrorKind::mesh);
  for (const char* words : {"scenes/test.json:2:44 /bodies/0/shape/mesh: ", "\"models/open.3ds\" is no solid", "edge",
                            "\"motion\": \"static\"", "inertiaTensor", "hull"}) {
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(MeshBody, OpenOneWithMassAloneSaysThatMassIsNotEnough) {
  const Error error = errorOf(meshScene("open.3ds", R"(, "mass": 1, "collision": "none")"));
  EXPECT_EQ(error.kind(), ErrorKind::mesh);
  EXPECT_THAT(error.what(), HasSubstr("mass alone needs a volume"));
}

constexpr const char* kGivenMass = R"(, "mass": 2, "inertiaTensor": [[1, 0, 0], [0, 2, 0], [0, 0, 2]])";

TEST(MeshBody, OpenOneWithGivenInertiaMayMoveUnlessItsSurfaceMustCollide) {
  for (const char* collision : {"none", "hull"}) {
    const LoadedScene loaded =
        parse(meshScene("open.3ds", kGivenMass + std::string(R"(, "collision": ")") + collision + "\""));
    EXPECT_EQ(loaded.scene.bodies.at(0).massProperties.mass, 2);
    EXPECT_EQ(loaded.scene.bodies.at(0).massProperties.centerOfMass, Vec3(0, 0, 0));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("centerOfMass is not given")));
  }
  const Error error = errorOf(meshScene("open.3ds", kGivenMass));
  EXPECT_EQ(error.kind(), ErrorKind::mesh);
  EXPECT_THAT(error.what(), HasSubstr("collision needs a closed surface"));
}

// The hull of an open cube is the cube.
TEST(MeshBody, OpenOneMayWeighWhatItsHullWeighsAndCollidesAsThat) {
  const LoadedScene loaded = parse(meshScene("open.3ds", R"(, "mass": 6, "massFrom": "hull")"));
  const Body& body = loaded.scene.bodies.at(0);
  EXPECT_TRUE(body.massProperties.centerOfMass.isApprox(Vec3(0.5, 0.5, 0.5), 1e-14));
  EXPECT_TRUE(body.massProperties.inertiaTensor.isApprox(Mat3::Identity(), 1e-14));
  EXPECT_EQ(body.collision, CollisionChoice::hull);
  EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("the mesh is open: it collides as its convex hull")));
  EXPECT_THAT(parse(meshScene("open.3ds", R"(, "massFrom": "hull", "collision": "hull")")).warnings, ElementsAre());
  // Of a driven body massFrom is not used: it says nothing of the collision either.
  const std::string driven = R"(, "massFrom": "hull", "motion": "driven", "linearVelocity": [1, 0, 0])";
  EXPECT_THAT(errorOf(meshScene("open.3ds", driven)).what(),
              HasSubstr("give \"motion\": \"static\", or \"collision\""));
  EXPECT_THAT(errorOf(meshScene("open.3ds", R"(, "massFrom": "hull", "collision": "mesh")")).what(),
              HasSubstr("collision needs a closed surface"));
}

// Six faces of 1 m^2, and the moments of a cube's surface, 5/18 m a^2; it collides as the cube.
TEST(MeshBody, ShellWeighsDensityTimesAreaTimesThickness) {
  const LoadedScene loaded = parse(
      sceneWith(R"("materials": {"m": {"density": 500}}, "bodies": [{"name": "a", "material": "m", "massFrom": "shell",
                "thickness": 0.01, "shape": {"mesh": "models/cube.3ds"}}])"));
  const Body& body = loaded.scene.bodies.at(0);
  EXPECT_NEAR(body.massProperties.mass, 30, 1e-12);
  EXPECT_TRUE(body.massProperties.inertiaTensor.isApprox(30 * 5.0 / 18 * Mat3::Identity(), 1e-14));
  EXPECT_EQ(body.collision, CollisionChoice::automatic);
  EXPECT_THAT(loaded.warnings, ElementsAre());
  EXPECT_GT(parse(meshScene("open.3ds", R"(, "massFrom": "shell", "thickness": 0.01)"))
                .scene.bodies.at(0)
                .massProperties.mass,
            0);
}

// Models whose name says so are 100 m large.
TEST(MeshBody, LikelyMillimetresAreAWarningUnlessUnitsOrScaleAreGiven) {
  const std::string shape = R"("bodies": [{"name": "a", "shape": {"mesh": "models/large.3ds")", end = "}}]";
  EXPECT_THAT(parse(sceneWith(shape + end)).warnings, ElementsAre(HasSubstr("if its file is in millimetres")));
  EXPECT_THAT(parse(sceneWith(shape + R"(, "units": "m")" + end)).warnings, ElementsAre());
  EXPECT_THAT(parse(sceneWith(shape + R"(, "scale": 1)" + end)).warnings, ElementsAre());
  EXPECT_THAT(parse(sceneWith(shape + R"(}, "motion": "static"}])")).warnings, ElementsAre());
}

TEST(MeshBody, UnitsMultiplyTheScale) {
  for (const auto& [units, metres] :
       std::map<std::string, double>{{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}) {
    const Scene scene =
        parse(sceneWith(fmt::format(
                  R"("bodies": [{{"name": "a", "shape": {{"mesh": "models/cube.3ds", "scale": 3, "units": "{}"}}}}])",
                  units)))
            .scene;
    EXPECT_NEAR(scene.bodies.at(0).massProperties.centerOfMass.x(), 1.5 * metres, 1e-15) << units;
  }
}

TEST(MeshBody, PartsThatOverlapHaveNoMassUnlessItIsGiven) {
  const Error error = errorOf(meshScene("overlap.3ds", ""));
  EXPECT_EQ(error.kind(), ErrorKind::mesh);
  for (const char* words : {"is no solid", "part 1 of 2", "part 2 of 2", "overlap at", "inertiaTensor"})
    EXPECT_THAT(error.what(), HasSubstr(words));
  EXPECT_EQ(parse(meshScene("overlap.3ds", kGivenMass)).scene.bodies.at(0).massProperties.mass, 2);
  EXPECT_EQ(parse(meshScene("overlap.3ds", R"(, "motion": "static")")).scene.bodies.size(), 1U);
}

TEST(MeshBody, SizeIsThatOfOtherShapes) {
  for (const char* scale : {"1e-10", "1e10"}) {
    const Error error = errorOf(sceneWith(fmt::format(
        R"("bodies": [{{"name": "a", "motion": "static", "shape": {{"mesh": "models/cube.3ds", "scale": {}}}}}])",
        scale)));
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    EXPECT_THAT(error.what(), HasSubstr("allowed are 1e-09..1e+09 m; change \"scale\""));
  }
}

TEST(MeshBody, EachModelIsLoadedOnce) {
  int loads = 0;
  const ModelSource counting = [&loads](const MeshReference& reference) {
    ++loads;
    return cubeModel(reference);
  };
  const std::string text = sceneWith(R"("bodies": [
    {"name": "a", "shape": {"mesh": "models/cube.3ds"}, "copies": {"count": [2, 1, 1]}},
    {"name": "b", "shape": {"mesh": "models/cube.3ds", "scale": 1.0, "object": ""}},
    {"name": "c", "shape": {"mesh": "models/cube.3ds", "scale": 0.1}},
    {"name": "d", "shape": {"mesh": "models/cube.3ds", "object": "Cube01"}}])");
  const Scene scene = parseScene(text, "elsewhere/test.json", counting).scene;
  EXPECT_EQ(loads, 3);
  std::vector<std::string> names;
  for (const Model& model : scene.models) names.push_back(model.name);
  EXPECT_THAT(names, ElementsAre("models/cube.3ds#@1", "models/cube.3ds#@0.1", "models/cube.3ds#Cube01@1"));
  std::vector<int> used;
  for (const Body& body : scene.bodies) used.push_back(std::get<ModelShape>(body.shape).model);
  EXPECT_THAT(used, ElementsAre(0, 0, 0, 1, 2));
}

TEST(MeshBody, NotesOfTheModelAreWarnings) {
  EXPECT_THAT(parse(meshScene("turned.3ds", "")).warnings,
              ElementsAre("scenes/test.json:2:44 /bodies/0/shape/mesh: was inside-out: turned"));
}

TEST(MeshBody, FaultsOfAllMeshesAreReported) {
  const Error error = errorOf(sceneWith(R"("bodies": [
    {"name": "a", "shape": {"mesh": "lost.3ds"}}, {"name": "b", "shape": {"mesh": "models/open.3ds"}},
    {"name": "c", "shape": {"mesh": "lost.3ds"}}, {"name": "d", "shape": {"mesh": "gone.3ds"}}])"));
  EXPECT_EQ(error.kind(), ErrorKind::mesh);
  EXPECT_THAT(error.what(), HasSubstr("3:37 /bodies/0/shape/mesh: lost.3ds: there is no such file\n"));
  EXPECT_THAT(error.what(), HasSubstr("3:83 /bodies/1/shape/mesh: "));
  EXPECT_THAT(error.what(), HasSubstr("4:83 /bodies/3/shape/mesh: gone.3ds"));
}

TEST(MeshBody, FaultsOfTheTextComeBeforeThoseOfMeshes) {
  const Error early = errorOf(meshScene("../lost.3ds", R"(, "mass": -1)"));
  EXPECT_EQ(early.kind(), ErrorKind::scene);
  const Error late = errorOf(sceneWith(R"("bodies": [{"name": "a", "shape": {"mesh": "models/cube.3ds"}},
    {"name": "b", "shape": {"mesh": "lost.3ds"}}], "rods": [{"bodyA": "a", "anchorA": {"vertex": 8}}])"));
  EXPECT_EQ(late.kind(), ErrorKind::scene);
  EXPECT_THAT(late.what(), HasSubstr("3:87 /rods/0/anchorA: vertex is 8; allowed is a whole number in 0..7"));
  EXPECT_THAT(late.what(), Not(HasSubstr("lost.3ds")));
}

TEST(MeshBody, VertexAnchorsAreItsVertices) {
  const Scene scene = parse(meshScene("cube.3ds", R"(, "position": [0, 0, 10]}],
    "rods": [{"bodyA": "a", "anchorA": {"vertex": 6}, "anchorB": [0, 1, 15])"))
                          .scene;
  EXPECT_EQ(scene.rods.at(0).anchorA.point, Vec3(0, 1, 1));
  EXPECT_EQ(scene.rods.at(0).length, 4);
}

TEST(MeshBody, AnchorsAreTheVertexNearestToAPoint) {
  const Scene scene = parse(meshScene("cube.3ds", R"(, "position": [0, 0, 10]}],
    "rods": [{"bodyA": "a", "anchorA": {"nearestVertex": [0.2, 7, 0.6]}, "anchorB": [0, 1, 15])"))
                          .scene;
  EXPECT_EQ(scene.rods.at(0).anchorA.point, Vec3(0, 1, 1));
  EXPECT_EQ(scene.rods.at(0).length, 4);
}

TEST(MeshBody, GapsOfItsJointsAreCheckedOnceItIsThere) {
  const Error error = errorOf(meshScene("cube.3ds", R"(}], "ballJoints": [{"bodyA": "a", "anchorB": [0, 0.1, 0])"));
  EXPECT_EQ(error.kind(), ErrorKind::scene);
  EXPECT_THAT(error.what(), HasSubstr("/ballJoints/0: the anchors are 0.1 m apart"));
}

TEST(MeshBody, CollisionSphereMustBeASphere) {
  const Error error = errorOf(meshScene("cube.3ds", R"(, "collision": "sphere")"));
  EXPECT_EQ(error.kind(), ErrorKind::scene);
  EXPECT_THAT(error.what(), HasSubstr("the mesh is no sphere (box)"));
}

TEST(Warnings, TellOfValuesThatAreNotUsed) {
  const LoadedScene loaded = parse(sceneWithBody(R"("motion": "static", "mass": 1, "angularVelocity": [1, 0, 0]}],
    "pushes": [{"body": "a", "point": [0, 0, 0])"));
  EXPECT_THAT(loaded.warnings,
              ElementsAre("scenes/test.json:3:29 /bodies/0/mass: mass is not used, because the body is static",
                          HasSubstr("/bodies/0/angularVelocity: "), HasSubstr("/pushes/0: the push moves nothing")));
}

}  // namespace
}  // namespace cradle
