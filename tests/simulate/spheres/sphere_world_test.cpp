#include "simulate/spheres/sphere_world.h"

#include <gmock/gmock.h>

#include "experiments/experiment.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

/// A material beside the one without loss.
std::string twoMaterials(double restitution, double friction) {
  return fmt::format(R"("duration": 1, "materials": {{
      "hard": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}},
      "other": {{"restitution": {0}, "staticFriction": {1}, "dynamicFriction": {1}}}}}, )",
                     restitution, friction);
}

/// Of all bodies as one island in which all may touch each other.
std::optional<SphereWorld> worldOf(const std::string& bodies, const std::string& materials = twoMaterials(1, 0)) {
  const Scene scene = sceneWith(materials + R"("bodies": [)" + bodies + "]");
  IslandPlan island;
  for (int i = 0; i < std::ssize(scene.bodies); ++i) {
    island.touching.push_back(i);
    if (scene.bodies[static_cast<std::size_t>(i)].motion == Motion::dynamic) island.bodies.push_back(i);
  }
  return sphereWorldOf(scene, island);
}

std::string sphereBody(const std::string& name, const std::string& more) {
  return R"({"name": ")" + name + R"(", "shape": {"sphere": {"radius": 0.2}}, "mass": 4, "material": "hard", )" + more +
         "}";
}

TEST(SphereWorld, HasTheSpheresAndWhatIsFixed) {
  const auto world = worldOf(
      R"({"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "motion": "static", "material": "hard",
          "position": [0, -3, 0], "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}}, )" +
      sphereBody("a", R"("position": [1, 2, 3], "linearVelocity": [4, 5, 6])") +
      R"(, {"name": "wall", "shape": {"plane": {"normal": [1, 0, 0]}}, "motion": "static", "material": "hard",
          "position": [-5, 0, 0], "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}},
         {"name": "pin", "shape": {"capsule": {"radius": 0.3, "length": 0.8}}, "motion": "static", "material": "hard",
          "position": [7, 0, 0]}, )" +
      sphereBody("b", R"("position": [2, 2, 3])") + ", " +
      sphereBody("rock", R"("position": [9, 0, 0], "motion": "static")"));
  ASSERT_TRUE(world);
  EXPECT_EQ(world->gravity, Vec3(0, -9.81, 0));
  EXPECT_THAT(world->sceneBodies, ElementsAre(1, 4));
  EXPECT_THAT(world->radii, ElementsAre(0.2, 0.2));
  EXPECT_THAT(world->inverseMasses, ElementsAre(0.25, 0.25));
  EXPECT_EQ(world->starts[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(world->starts[0].velocity, Vec3(4, 5, 6));
  EXPECT_EQ(world->starts[0].acceleration, world->gravity);
  ASSERT_THAT(world->planes, SizeIs(1));
  EXPECT_EQ(world->planes[0].point, Vec3(-5, 0, 0));
  EXPECT_LT((world->planes[0].normal - Vec3::UnitY()).norm(), 1e-15);  // turned
  EXPECT_THAT(world->obstacleBodies, ElementsAre(2, 0, 3, 5));         // planes first
  ASSERT_THAT(world->boxes, SizeIs(3));
  EXPECT_LT((world->boxes[0].boxFromWorld * Vec3(0, -2.8, 0) - Vec3(0.2, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(world->boxes[0].halfSize, Vec3(0.2, 0.1, 0.3));
  EXPECT_EQ(world->boxes[1].halfSize, Vec3(0, 0.4, 0));
  EXPECT_EQ(world->boxes[1].radius, 0.3);
  EXPECT_EQ(world->boxes[2].radius, 0.2);
}

// Each of these ends the closed form of a sphere's flight.
TEST(SphereWorld, IsNoneWithOtherBodies) {
  const std::string ball = sphereBody("a", R"("position": [1, 2, 3])");
  EXPECT_TRUE(worldOf(ball));
  EXPECT_FALSE(worldOf(ball + R"(, {"name": "b", "shape": {"box": {"size": [1, 1, 1]}}, "material": "hard"})"));
  EXPECT_FALSE(worldOf(sphereBody("a", R"("centerOfMass": [0.01, 0, 0],
    "inertiaTensor": [[1, 0, 0], [0, 1, 0], [0, 0, 1]])")));
  EXPECT_FALSE(worldOf(ball + R"(, {"name": "post", "shape": {"cylinder": {"radius": 0.1, "length": 1}},
    "motion": "static", "material": "hard", "position": [9, 9, 9]})"));
}

// Restitution and friction are those of the pairs that may come about: of what moves with all, not of what is fixed.
TEST(SphereWorld, IsNoneWithLossOrFriction) {
  const std::string ball = sphereBody("a", R"("position": [1, 2, 3])");
  const auto floorOf = [](const std::string& material) {
    return R"(, {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": ")" + material + R"("})";
  };
  EXPECT_TRUE(worldOf(ball + floorOf("other"), twoMaterials(1, 0)));
  EXPECT_FALSE(worldOf(ball + floorOf("other"), twoMaterials(0.99, 0)));
  EXPECT_TRUE(worldOf(ball + floorOf("hard"), twoMaterials(0.99, 0)));
}

}  // namespace
}  // namespace cradle
