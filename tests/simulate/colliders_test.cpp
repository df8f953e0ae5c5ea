#include "simulate/colliders.h"

#include <gmock/gmock.h>

#include "collision/separation.h"
#include "experiments/experiment.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

Scene collidingScene(const std::string& bodies, const std::string& more = "") {
  return sceneWith(R"("duration": 1, "bodies": [)" + bodies + "]" + more);
}

// Of a body that moves, in the frame of its centre of mass; of one that does not, in the world.
TEST(Colliders, AreInTheFrameOfTheCenterOfMassOrTheWorld) {
  const std::string box = R"("shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "position": [1, 2, 3],
    "orientation": {"axis": [0, 0, 1], "angleDegrees": 90})";
  const Scene scene = collidingScene(R"({"name": "a", "mass": 1, "centerOfMass": [0.1, 0.05, 0],
    "inertiaTensor": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], )" +
                                     box + R"(}, {"name": "b", "motion": "static", )" + box + "}");
  const auto moving = colliderOf(scene.bodies[0], scene, 7), fixed = colliderOf(scene.bodies[1], scene, kFixed);
  ASSERT_TRUE(moving && fixed);
  EXPECT_EQ(moving->body, 7);
  EXPECT_EQ(fixed->body, kFixed);
  EXPECT_LT((moving->bounds.center() - Vec3(-0.1, -0.05, 0)).norm(), 1e-15);
  EXPECT_LT((moving->bounds.sizes() - Vec3(0.4, 0.2, 0.6)).norm(), 1e-15);
  EXPECT_NEAR(moving->boundingRadius, Vec3(0.3, 0.15, 0.3).norm(), 1e-15);  // about the centre of mass
  EXPECT_LT((fixed->bounds.center() - Vec3(1, 2, 3)).norm(), 1e-15);
  EXPECT_LT((fixed->bounds.sizes() - Vec3(0.2, 0.4, 0.6)).norm(), 1e-15);  // turned
}

TEST(Colliders, AreNoneOfPlanesAndOfWhatDoesNotCollide) {
  const Scene scene = collidingScene(R"({"name": "floor", "shape": {"plane": {}}, "motion": "static"},
    {"name": "ghost", "shape": {"sphere": {"radius": 0.1}}, "collision": "none", "position": [0, 1, 0]},
    {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 2, 0]},
    {"name": "rock", "shape": {"sphere": {"radius": 0.1}}, "motion": "static", "position": [0, 3, 0]})");
  const std::vector<Body>& bodies = scene.bodies;
  EXPECT_FALSE(colliderOf(bodies[0], scene, kFixed));
  EXPECT_FALSE(colliderOf(bodies[1], scene, 0));
  const auto ball = colliderOf(bodies[2], scene, 1);
  ASSERT_TRUE(ball);
  EXPECT_TRUE(ball->isSphere());
  EXPECT_TRUE(canSolveContact(*ball, nullptr));
  EXPECT_FALSE(canSolveContact(Collider(), nullptr));
  EXPECT_FALSE(canSolveContact(*ball, nullptr) && canSolveContact(*ball, std::make_unique<Collider>().get()));
  // One of two has to move, and both to collide.
  EXPECT_TRUE(mayTouch(bodies[0], bodies[2]) && mayTouch(bodies[2], bodies[3]));
  EXPECT_FALSE(mayTouch(bodies[0], bodies[3]) || mayTouch(bodies[1], bodies[2]) || mayTouch(bodies[2], bodies[1]));
}

// Bodies on a joint do not touch each other, unless one of their joints lets them; in whatever order they are named.
TEST(Colliders, OfJointsAreKeptFromTouching) {
  std::string bodies;
  for (const char name : {'a', 'b', 'c'})
    bodies += fmt::format(R"({}{{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [{}, 0, 0]}})",
                          name == 'a' ? "" : ", ", name, static_cast<int>(name - 'a'));
  const auto joint = [](const char* a, const char* b, const char* more) {
    return fmt::format(R"({{"bodyA": "{}", "bodyB": "{}", "anchorA": [0, 0, 0], "anchorB": [{}, 0, 0]{}}})", a, b,
                       a[0] - b[0], more);
  };
  const auto pairs = [&](const std::string& joints) {
    return pairsKeptFromTouching(collidingScene(bodies, R"(, "ballJoints": [)" + joints + "]"));
  };
  EXPECT_THAT(pairs(joint("c", "a", "") + ", " + joint("b", "c", "")), ElementsAre(Pair(0, 2), Pair(1, 2)));
  EXPECT_THAT(pairs(joint("c", "a", "") + ", " + joint("a", "c", R"(, "collide": true)")), IsEmpty());
}

}  // namespace
}  // namespace cradle
