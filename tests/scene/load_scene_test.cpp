#include "scene/load_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

constexpr double kRoundingNearOne = 4e-16;  // of values near 1, after a product or a square root or two

// Every value of every_key.json, by hand.
class EveryKey : public testing::Test {
 protected:
  LoadedScene loaded_ = parse(everyKey());
  const Scene& scene_ = loaded_.scene;
};

TEST_F(EveryKey, SettingsAreThoseOfTheFile) {
  EXPECT_EQ(scene_.name, "Every key");
  EXPECT_EQ(scene_.description, "Each key of the scene file at least once");
  EXPECT_EQ(scene_.duration, 2.5);
  EXPECT_EQ(scene_.gravity, Vec3(0.1, -1.62, 0.2));
  EXPECT_EQ(scene_.accuracy, 1e-8);
  EXPECT_TRUE(scene_.namesAccuracy);
  EXPECT_EQ(scene_.accuracyWhere, "scenes/test.json:7:15 /accuracy");
  ASSERT_TRUE(scene_.method.has_value());
  EXPECT_EQ(scene_.method->name, MethodName::rk4);
  EXPECT_EQ(scene_.method->timeStep, 0.001);
  EXPECT_EQ(scene_.output.framesPerSecond, 24);
  EXPECT_EQ(scene_.output.width, 640);
  EXPECT_EQ(scene_.output.height, 360);
  EXPECT_EQ(scene_.output.playbackSpeed, 0.5);
  EXPECT_EQ(scene_.text, everyKey());
  EXPECT_EQ(scene_.path, "scenes/test.json");
  EXPECT_TRUE(loaded_.warnings.empty());
}

TEST_F(EveryKey, CameraAndLightsAreThoseOfTheFile) {
  ASSERT_TRUE(scene_.camera.has_value());
  EXPECT_EQ(scene_.camera->position, Vec3(1, 2, 8));
  EXPECT_EQ(scene_.camera->target, Vec3(0, 2, 0));
  EXPECT_NEAR(scene_.camera->verticalFieldOfView, std::numbers::pi / 3, kRoundingNearOne);
  ASSERT_EQ(scene_.lights.size(), 1U);
  EXPECT_EQ(scene_.lights[0].direction, Vec3(0, -1, 0));
  EXPECT_EQ(scene_.lights[0].color, Vec3f(1, 128.0F / 255, 0));
  EXPECT_EQ(scene_.lights[0].intensity, 2);
  EXPECT_EQ(scene_.look, Look::dark);
  ASSERT_EQ(scene_.captions.size(), 2u);
  EXPECT_EQ(scene_.captions[0].text, "Look here");
  EXPECT_EQ(scene_.captions[0].from, 0.5);
  EXPECT_EQ(scene_.captions[0].to, 1.5);
  EXPECT_EQ(scene_.bodies[static_cast<std::size_t>(scene_.captions[0].body)].name, "ball");
  EXPECT_EQ(scene_.captions[1].body, kWorld);
  EXPECT_EQ(scene_.captions[1].to, std::numeric_limits<double>::infinity());
  EXPECT_EQ(scene_.titleCard->title, "Every key");
  EXPECT_EQ(scene_.titleCard->subtitle, "and some more");
  EXPECT_EQ(scene_.titleCard->seconds, 2);
}

TEST_F(EveryKey, MaterialsFollowTheUnnamedOne) {
  ASSERT_EQ(scene_.materials.size(), 4U);
  EXPECT_EQ(scene_.materials[0].name, "");
  const Material& steel = scene_.materials[1];
  EXPECT_EQ(steel.name, "steel");
  EXPECT_EQ(steel.density, 7800);
  EXPECT_EQ(steel.restitution, 0.9);
  EXPECT_EQ(steel.staticFriction, 0.6);
  EXPECT_EQ(steel.dynamicFriction, 0.4);
  EXPECT_EQ(steel.baseColor, Vec3f(0.2F, 0.4F, 0.6F));
  EXPECT_EQ(steel.metallic, 1);
  EXPECT_EQ(steel.roughness, 0.25);
  EXPECT_EQ(steel.pattern, Pattern::checks);
  EXPECT_EQ(steel.patternColor, Vec3f(1, 0, 0));
  EXPECT_FALSE(scene_.materials[2].baseColor.has_value());
  EXPECT_EQ(scene_.materials[2].texture, nullptr);
  ASSERT_NE(scene_.materials[3].texture, nullptr);
  EXPECT_EQ(scene_.materials[3].texture->name, "models/wood.png");
}

TEST_F(EveryKey, PairsAreAsNamedOrCombined) {
  EXPECT_EQ(scene_.surfacePairs[1][2].restitution, 0.7);
  EXPECT_EQ(scene_.surfacePairs[2][1].staticFriction, 1);
  EXPECT_EQ(scene_.surfacePairs[2][1].dynamicFriction, 0.8);
  EXPECT_EQ(scene_.surfacePairs[0][2].restitution, 0);
  EXPECT_EQ(scene_.surfacePairs[2][0].staticFriction, std::sqrt(0.5 * 1.5));
  EXPECT_EQ(scene_.surfacePairs[0][2].dynamicFriction, std::sqrt(0.5 * 0.9));
  EXPECT_EQ(scene_.surfacePairs[1][1].restitution, 0.9);
  EXPECT_NEAR(scene_.surfacePairs[1][1].staticFriction, 0.6, kRoundingNearOne);
}

TEST_F(EveryKey, MeshBodyHasWhatItWasGiven) {
  const Body& crate = scene_.bodies.at(0);
  EXPECT_EQ(crate.name, "crate");
  EXPECT_EQ(crate.where, "scenes/test.json:17:5 /bodies/0");
  EXPECT_EQ(crate.material, 1);
  EXPECT_TRUE(crate.namesMaterial);
  ASSERT_EQ(scene_.models.size(), 1U);
  EXPECT_EQ(scene_.models[0].name, "models/cube.3ds#Cube01@2^z");
  EXPECT_EQ(scene_.models[0].solid.vertices.at(7), Vec3(2, 2, 2));
  EXPECT_EQ(std::get<ModelShape>(crate.shape).model, 0);
  EXPECT_EQ(crate.collision, CollisionChoice::hull);
  EXPECT_EQ(crate.motion, Motion::dynamic);
  EXPECT_EQ(crate.massProperties.mass, 3);
  EXPECT_EQ(crate.massProperties.centerOfMass, Vec3(0.9, 1, 1.1));
  EXPECT_EQ(crate.massProperties.inertiaTensor, (Mat3() << 2, 0.1, 0, 0.1, 2.5, -0.2, 0, -0.2, 3).finished());
  EXPECT_EQ(crate.worldFromBody.translation, Vec3(0, 5, 0));
  EXPECT_TRUE(crate.worldFromBody.rotation.coeffs().isApprox(Quat(0.8, 0.6, 0, 0).coeffs(), kRoundingNearOne));
  EXPECT_EQ(crate.linearVelocity, Vec3(1, 2, 3));
  EXPECT_EQ(crate.angularVelocity, Vec3(4, 5, 6));
}

TEST_F(EveryKey, PrimitivesHaveTheirSizes) {
  EXPECT_EQ(std::get<Sphere>(scene_.bodies.at(1).shape).radius, 0.5);
  EXPECT_EQ(scene_.bodies.at(1).collision, CollisionChoice::sphere);
  EXPECT_NEAR(scene_.bodies.at(1).massProperties.mass, 1100 * std::numbers::pi / 6, 1e-12);
  EXPECT_EQ(std::get<Box>(scene_.bodies.at(2).shape).size, Vec3(1, 2, 3));
  EXPECT_EQ(std::get<Cylinder>(scene_.bodies.at(6).shape).radius, 0.2);
  EXPECT_EQ(std::get<Cylinder>(scene_.bodies.at(6).shape).length, 0.6);
  EXPECT_EQ(scene_.bodies.at(6).collision, CollisionChoice::none);
  EXPECT_EQ(std::get<Capsule>(scene_.bodies.at(7).shape).radius, 0.1);
  EXPECT_EQ(std::get<Capsule>(scene_.bodies.at(7).shape).length, 0.8);
  EXPECT_EQ(std::get<Plane>(scene_.bodies.at(8).shape).normal, Vec3(0, 1, 0));
  EXPECT_EQ(scene_.bodies.at(8).motion, Motion::fixed);
  EXPECT_EQ(scene_.bodies.at(8).massProperties.mass, 0);
}

TEST_F(EveryKey, DrivenBodiesStartWhereTheirMotionDoes) {
  const Body &lift = scene_.bodies.at(9), &shaker = scene_.bodies.at(10);
  EXPECT_EQ(lift.motion, Motion::driven);
  EXPECT_EQ(lift.massProperties.mass, 0);
  EXPECT_EQ(lift.worldFromBody.translation, Vec3(20, 0, 0));
  const PoseMotion top = motionAt(*lift.prescribed, 3);  // it repeats
  EXPECT_NEAR(top.pose.translation.y(), 1, kRoundingNearOne);
  EXPECT_NEAR(top.pose.rotation.y(), std::sin(9 * std::numbers::pi / 360), kRoundingNearOne);
  EXPECT_NEAR(shaker.worldFromBody.translation.x(), 25 + 0.1 * std::sin(0.5), 25 * kRoundingNearOne);
  EXPECT_NEAR(shaker.linearVelocity.x(), 0.1 * 6 * std::numbers::pi * std::cos(0.5), 2 * kRoundingNearOne);
}

TEST_F(EveryKey, CopiesRunAlongZFirst) {
  ASSERT_EQ(scene_.bodies.size(), 11U);
  const char* names[] = {"block_0", "block_1", "block_2", "block_3"};
  const Vec3 positions[] = {{10, 0, 0}, {10, 0, 5}, {14, 0, 0}, {14, 0, 5}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(scene_.bodies[2 + i].name, names[i]);
    EXPECT_EQ(scene_.bodies[2 + i].worldFromBody.translation, positions[i]);
    EXPECT_EQ(scene_.bodies[2 + i].massProperties.mass, 6000);
  }
}

TEST_F(EveryKey, LinksJoinWhatTheyName) {
  const Spring& spring = scene_.springs.at(0);
  EXPECT_EQ(spring.name, "coil");
  EXPECT_EQ(spring.where, "scenes/test.json:36:15 /springs/0");
  EXPECT_EQ(spring.anchorA.body, 0);
  EXPECT_EQ(spring.anchorA.point, Vec3(2, 0, 0));
  EXPECT_EQ(spring.anchorB.body, 1);
  EXPECT_EQ(spring.anchorB.point, Vec3(0, 0.5, 0));
  EXPECT_EQ(spring.stiffness, 50);
  EXPECT_EQ(spring.damping, 0.5);
  EXPECT_EQ(spring.restLength, 1.5);
  EXPECT_EQ(scene_.rods.at(0).anchorB.body, kWorld);
  EXPECT_EQ(scene_.rods.at(0).anchorB.point, Vec3(5, 1.3, 0));
  EXPECT_EQ(scene_.rods.at(0).length, 1);
  EXPECT_EQ(scene_.ropes.at(0).maxLength, 1.25);
  EXPECT_EQ(scene_.ropes.at(0).restitution, 0.2);
  EXPECT_EQ(scene_.ballJoints.at(0).anchorA.body, 7);
  EXPECT_EQ(scene_.ballJoints.at(0).anchorB.body, 6);
  EXPECT_EQ(scene_.hinges.at(0).anchorA.body, 2);
  EXPECT_TRUE(scene_.hinges.at(0).axis.isApprox(Vec3(0, 0.6, 0.8), kRoundingNearOne));
  EXPECT_EQ(scene_.sliders.at(0).name, "rail");
  EXPECT_EQ(scene_.sliders.at(0).anchorA.body, 3);
  EXPECT_TRUE(scene_.sliders.at(0).axis.isApprox(Vec3(0.6, 0.8, 0), kRoundingNearOne));
  EXPECT_TRUE(scene_.sliders.at(0).collide);
  EXPECT_EQ(scene_.welds.at(0).name, "seam_0");
  EXPECT_EQ(scene_.welds.at(0).anchorA.body, 4);
}

TEST_F(EveryKey, PushesActWhereTheySay) {
  const Push& ray = scene_.pushes.at(0);
  EXPECT_EQ(ray.body, 1);
  EXPECT_EQ(std::get<Push::Ray>(ray.target).origin, Vec3(0, 3, 9));
  EXPECT_EQ(std::get<Push::Ray>(ray.target).direction, Vec3(0, 0, -1));
  EXPECT_EQ(ray.force, Vec3(0, 0, -4));
  EXPECT_EQ(ray.start, 0.25);
  EXPECT_EQ(ray.duration, 0.1);
  EXPECT_EQ(std::get<Vec3>(scene_.pushes.at(1).target), Vec3(0, 0.1, 0));
}

TEST(SceneDefaults, AreThoseOfTheTable) {
  const Scene scene = parse(sceneWith(R"("bodies": [{"name": "a", "shape": {"sphere": {}}}])")).scene;
  EXPECT_EQ(scene.description, "");
  EXPECT_EQ(scene.gravity, Vec3(0, -9.81, 0));
  EXPECT_EQ(scene.accuracy, 1e-6);
  EXPECT_FALSE(scene.namesAccuracy);
  EXPECT_FALSE(scene.method.has_value());
  EXPECT_EQ(scene.output.framesPerSecond, 60);
  EXPECT_EQ(scene.output.width, 1280);
  EXPECT_EQ(scene.output.height, 720);
  EXPECT_EQ(scene.output.playbackSpeed, 1);
  EXPECT_FALSE(scene.camera.has_value());
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_TRUE(scene.lights[0].direction.isApprox(Vec3(-1, -2, -1) / std::sqrt(6.0), kRoundingNearOne));
  EXPECT_EQ(scene.lights[0].color, Vec3f(1, 1, 1));
  EXPECT_EQ(scene.lights[0].intensity, 3);
  EXPECT_EQ(scene.look, Look::light);
}

// Static friction is not below dynamic: one that is named alone takes the other with it, if the default would not do.
TEST(SceneDefaults, OfOneFrictionFollowTheOther) {
  const auto frictionsOf = [](const std::string& named) {
    const Scene scene = parse(sceneWith(R"("materials": {"m": {)" + named + R"(}}, "bodies": [])")).scene;
    const Material& material = scene.materials.back();
    return std::pair(material.staticFriction, material.dynamicFriction);
  };
  EXPECT_EQ(frictionsOf(R"("staticFriction": 0.3)"), std::pair(0.3, 0.3));
  EXPECT_EQ(frictionsOf(R"("staticFriction": 0.8)"), std::pair(0.8, 0.5));
  EXPECT_EQ(frictionsOf(R"("dynamicFriction": 0.3)"), std::pair(0.5, 0.3));
  EXPECT_EQ(frictionsOf(R"("dynamicFriction": 0.8)"), std::pair(0.8, 0.8));
}

TEST(SceneDefaults, OfABodyAreThoseOfTheTable) {
  const Scene scene = parse(sceneWith(R"("bodies": [{"name": "a", "shape": {"sphere": {}}}])")).scene;
  const Body& body = scene.bodies.at(0);
  EXPECT_EQ(body.material, 0);
  EXPECT_FALSE(body.namesMaterial);
  EXPECT_EQ(scene.materials.at(0).density, 1000);
  EXPECT_EQ(scene.materials.at(0).restitution, 0);
  EXPECT_EQ(scene.materials.at(0).staticFriction, 0.5);
  EXPECT_EQ(scene.materials.at(0).dynamicFriction, 0.5);
  EXPECT_EQ(scene.materials.at(0).metallic, 0);
  EXPECT_EQ(scene.materials.at(0).roughness, 0.5);
  EXPECT_EQ(scene.materials.at(0).pattern, Pattern::none);
  EXPECT_EQ(std::get<Sphere>(body.shape).radius, 1);
  EXPECT_EQ(body.collision, CollisionChoice::automatic);
  EXPECT_EQ(body.motion, Motion::dynamic);
  EXPECT_NEAR(body.massProperties.mass, 4000 * std::numbers::pi / 3, 1e-12);
  EXPECT_EQ(body.worldFromBody.translation, Vec3(0, 0, 0));
  EXPECT_EQ(body.worldFromBody.rotation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(body.linearVelocity, Vec3(0, 0, 0));
  EXPECT_EQ(body.angularVelocity, Vec3(0, 0, 0));
}

TEST(SceneDefaults, LengthsAreTheDistancesAtTheStart) {
  const Scene scene = parse(sceneWithBody(R"("position": [3, 0, 4]}],
    "springs": [{"bodyA": "a", "anchorB": [0, 0, 0]}],
    "rods": [{"bodyA": "a", "anchorB": [0, 0, 0]}, {"bodyA": "a", "anchorB": [3, 2, 4]}],
    "ropes": [{"bodyA": "a", "anchorA": [0, 1, 0], "anchorB": [3, 2, 4])"))
                          .scene;
  EXPECT_EQ(scene.springs.at(0).name, "spring0");
  EXPECT_EQ(scene.springs.at(0).restLength, 5);
  EXPECT_EQ(scene.springs.at(0).stiffness, 100);
  EXPECT_EQ(scene.springs.at(0).damping, 0);
  EXPECT_EQ(scene.rods.at(0).length, 5);
  EXPECT_EQ(scene.rods.at(1).name, "rod1");
  EXPECT_EQ(scene.rods.at(1).length, 2);
  EXPECT_EQ(scene.ropes.at(0).maxLength, 1);
  EXPECT_EQ(scene.ropes.at(0).restitution, 0);
}

TEST(Accuracy, WordsStandForNumbers) {
  const std::string body = R"(, "bodies": [])";
  EXPECT_EQ(parse(sceneWith(R"("accuracy": "visual")" + body)).scene.accuracy, 1e-3);
  EXPECT_EQ(parse(sceneWith(R"("accuracy": "default")" + body)).scene.accuracy, 1e-6);
  EXPECT_EQ(parse(sceneWith(R"("accuracy": "reference")" + body)).scene.accuracy, 1e-10);
}

TEST(Frames, BothEndsAreIncluded) {
  Scene scene;
  scene.duration = 10;
  EXPECT_EQ(lastFrame(scene), 600);
  EXPECT_EQ(frameTime(scene, 600), 10);
  scene.duration = 0.7;  // 0.7 x 30 is 20.999999999999996 in doubles
  scene.output.framesPerSecond = 30;
  EXPECT_EQ(lastFrame(scene), 21);
  scene.output.playbackSpeed = 0.5;  // slow motion: twice the frames
  EXPECT_EQ(lastFrame(scene), 42);
  EXPECT_EQ(frameTime(scene, 3), 0.05);
}

TEST(Frames, NoneIsLaterThanTheDuration) {
  // N frames may be longer than the duration: by the rounding of k * playbackSpeed / framesPerSecond, and by the 1e-9
  // of a frame that N = floor(duration * framesPerSecond / playbackSpeed + 1e-9) forgives.
  Scene scene;
  for (const double framesPerSecond : {0.7, 30.0, 60.0, 1000.0 / 3, 9999.0})
    for (const double playbackSpeed : {1.0, 0.1, 7.0})
      for (const long frames : {1L, 3L, 100L, 12345L})
        for (const double missing : {0.0, 1e-15, 1e-12, 0.9e-9}) {  // of a frame
          scene.output.framesPerSecond = framesPerSecond;
          scene.output.playbackSpeed = playbackSpeed;
          scene.duration = (static_cast<double>(frames) - missing) * playbackSpeed / framesPerSecond;
          ASSERT_EQ(lastFrame(scene), frames);
          EXPECT_LE(frameTime(scene, frames), scene.duration);
          EXPECT_NEAR(frameTime(scene, frames), scene.duration, 1e-15 * scene.duration);
          EXPECT_LT(frameTime(scene, frames - 1), scene.duration);
          EXPECT_EQ(frameInterval(scene), playbackSpeed / framesPerSecond);
        }
}

TEST(SceneFile, CommentsAndAByteOrderMarkAreAllowed) {
  const Scene scene = parse("\xEF\xBB\xBF// a scene\n" + sceneWith("/* no\nbodies */ \"bodies\": [] // yet\n")).scene;
  EXPECT_TRUE(scene.bodies.empty());
}

TEST(SceneFile, MissingFileIsAnError) {
  try {
    loadScene("no/such/scene.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    EXPECT_NE(std::string(error.what()).find("no/such/scene.json"), std::string::npos);
  }
}

TEST(SceneFile, MeshPathsStartFromItsFolder) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "scene_file_test";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "scene.json").string();
  std::ofstream(path) << sceneWith(R"("bodies": [{"name": "a", "shape": {"mesh": "../scene_file_test/missing.3ds"}}])");
  try {
    loadScene(path);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mesh);
    const std::string resolved = (folder / "../scene_file_test/missing.3ds").string();
    EXPECT_NE(std::string(error.what()).find(resolved), std::string::npos) << error.what();
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cradle
