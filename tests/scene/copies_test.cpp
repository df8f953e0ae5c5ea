#include "scene/load_scene.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "math/rotation.h"

namespace cradle {
namespace {

Scene copied(const std::string& members) {
  return parseScene(R"({"schema": "cradle-scene/1", "name": "n", "duration": 1, )" + members + "}", "n.json", {}).scene;
}

const Vec3& placeOf(const Body& body) {
  return body.worldFromBody.translation;
}

// Two rods to each ball of a cradle: the world's ends go along.
TEST(Copies, OfLinksGoWithThoseOfTheirBodies) {
  const Scene scene = copied(R"("bodies": [{"name": "a", "shape": {"sphere": {}}, "position": [1, 0, 0],
      "copies": {"count": [3, 1, 2], "spacing": [2, 9, 5]}}],
    "rods": [{"name": "left", "bodyA": "a", "anchorA": [0, 0, 0.5], "anchorB": [1, 4, 0.5],
      "copies": {"count": [3, 1, 2], "spacing": [2, 9, 5]}}])");
  ASSERT_EQ(scene.bodies.size(), 6u);
  ASSERT_EQ(scene.rods.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const Rod& rod = scene.rods[i];
    EXPECT_EQ(rod.name, "left_" + std::to_string(i));
    EXPECT_EQ(rod.anchorA.body, static_cast<int>(i));
    EXPECT_EQ(rod.anchorA.point, Vec3(0, 0, 0.5));
    EXPECT_EQ(rod.anchorB.body, kWorld);
    EXPECT_EQ(rod.anchorB.point, placeOf(scene.bodies[i]) + Vec3(0, 4, 0.5));
    EXPECT_DOUBLE_EQ(rod.length, 4);
  }
  EXPECT_EQ(scene.bodies[5].name, "a_5");
  EXPECT_EQ(placeOf(scene.bodies[5]), Vec3(5, 0, 5));
}

// Four cars of a carousel: each is the one before, a quarter on about the upward axis through (1, 0, 2).
TEST(Copies, InARingAreTurned) {
  const Scene scene =
      copied(R"("bodies": [{"name": "car", "shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "position": [4, 1, 2],
      "linearVelocity": [0, 0, -3], "angularVelocity": [0, 1, 0.5], "copies": {"ring": {"count": 4, "center": [1, 0, 2]}}}])");
  ASSERT_EQ(scene.bodies.size(), 4u);
  const std::vector<Vec3> places = {{4, 1, 2}, {1, 1, -1}, {-2, 1, 2}, {1, 1, 5}};
  const std::vector<Vec3> velocities = {{0, 0, -3}, {-3, 0, 0}, {0, 0, 3}, {3, 0, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((placeOf(scene.bodies[i]) - places[i]).norm(), 1e-14) << i;
    EXPECT_LT((scene.bodies[i].linearVelocity - velocities[i]).norm(), 1e-14) << i;
    const Vec3 front = scene.bodies[i].worldFromBody.rotation * Vec3::UnitX();
    EXPECT_LT((3 * front + Vec3(1, 1, 2) - places[i]).norm(), 1e-14) << i;
    EXPECT_DOUBLE_EQ(scene.bodies[i].angularVelocity.y(), 1);
  }
}

// A hinge of each car on a hub that is turned itself: in the hub's frame, its end goes round.
TEST(Copies, OfJointsGoRoundOnWhatHasNone) {
  const Vec3 end = rotationAbout(Vec3(1, 2, 0).normalized(), 70 * M_PI / 180).conjugate() * Vec3(2, -0.5, 0);
  const Scene scene = copied(R"("bodies": [{"name": "car", "shape": {"sphere": {}}, "position": [3, 0, 0],
      "copies": {"ring": {"count": 3}}},
      {"name": "hub", "shape": {"sphere": {}}, "motion": "static", "position": [0, 0.5, 0],
       "orientation": {"axis": [1, 2, 0], "angleDegrees": 70}}],
    "hinges": [{"bodyA": "hub", "axis": [1, 0, 2], "bodyB": "car", "anchorB": [-1, 0, 0],
      "copies": {"ring": {"count": 3}}, "anchorA": )" +
                             fmt::format("[{:.17g}, {:.17g}, {:.17g}]}}]", end.x(), end.y(), end.z()));
  ASSERT_EQ(scene.hinges.size(), 3u);
  const RigidTransform& hub = scene.bodies[3].worldFromBody;
  for (int i = 0; i < 3; ++i) {
    const Hinge& hinge = scene.hinges[static_cast<std::size_t>(i)];
    EXPECT_EQ(hinge.anchorA.body, 3);
    EXPECT_EQ(hinge.anchorB.body, i);
    EXPECT_EQ(hinge.anchorB.point, Vec3(-1, 0, 0));
    const double angle = 2 * M_PI * i / 3;
    const auto turned = [&](const Vec3& vector) {  // about y
      return Vec3(std::cos(angle) * vector.x() + std::sin(angle) * vector.z(), vector.y(),
                  std::cos(angle) * vector.z() - std::sin(angle) * vector.x());
    };
    const Vec3 first(2, 0, 0), axis = hub.rotation * Vec3(1, 0, 2).normalized();
    EXPECT_LT((hub * hinge.anchorA.point - turned(first)).norm(), 1e-14) << i;
    EXPECT_LT((hub.rotation * hinge.axis - turned(axis)).norm(), 1e-14) << i;
  }
}

// Four balls in a row on three springs: from one to the next.
TEST(Copies, OfLinksFromOneCopyToTheNextAreAChain) {
  const Scene scene = copied(R"("bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [1, 0, 0],
      "copies": {"count": [4, 1, 1], "spacing": [2, 0, 0]}}],
    "springs": [{"name": "link", "bodyA": "ball_0", "bodyB": "ball_1", "anchorB": [0, 0.1, 0],
      "copies": {"count": [3, 1, 1], "spacing": [2, 0, 0]}}])");
  ASSERT_EQ(scene.springs.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(scene.springs[i].anchorA.body, static_cast<int>(i));
    EXPECT_EQ(scene.springs[i].anchorB.body, static_cast<int>(i + 1));
    EXPECT_EQ(scene.springs[i].anchorA.point, Vec3::Zero());
    EXPECT_EQ(scene.springs[i].anchorB.point, Vec3(0, 0.1, 0));
    EXPECT_DOUBLE_EQ(scene.springs[i].restLength, std::hypot(2, 0.1));
  }
}

// A cloth of 3 x 4 balls: rods along z tie those of one row, along x those of one column; and each spring of the
// diagonals, from the second column on, goes one on along x and one back along z.
TEST(Copies, OfLinksGoAlongTheAxesOfTheirBodies) {
  const Scene scene = copied(R"("bodies": [{"name": "b", "shape": {"sphere": {"radius": 0.1}},
      "copies": {"count": [3, 1, 4], "spacing": [1, 1, 1]}}],
    "rods": [{"name": "z", "bodyA": "b_0", "bodyB": "b_1", "anchorB": [0, 0, 0], "copies": {"count": [3, 1, 3]}},
             {"name": "x", "bodyA": "b_0", "bodyB": "b_4", "anchorB": [0, 0, 0], "copies": {"count": [2, 1, 4]}}],
    "springs": [{"bodyA": "b_1", "bodyB": "b_4", "copies": {"count": [2, 1, 3]}}])");
  ASSERT_EQ(scene.rods.size(), 17u);
  ASSERT_EQ(scene.springs.size(), 6u);
  const auto way = [&](const auto& link) {
    return Vec3(placeOf(scene.bodies[static_cast<std::size_t>(link.anchorB.body)]) -
                placeOf(scene.bodies[static_cast<std::size_t>(link.anchorA.body)]));
  };
  std::set<std::pair<int, int>> pairs;
  for (const Rod& rod : scene.rods) {
    EXPECT_EQ(way(rod), rod.name[0] == 'z' ? Vec3::UnitZ() : Vec3::UnitX()) << rod.name;
    pairs.emplace(rod.anchorA.body, rod.anchorB.body);
  }
  for (const Spring& spring : scene.springs) {
    EXPECT_EQ(way(spring), Vec3(1, 0, -1)) << spring.name;
    pairs.emplace(spring.anchorA.body, spring.anchorB.body);
  }
  EXPECT_EQ(pairs.size(), 23u);
}

// Five beads of a necklace: the last hinge joins the last one with the first. Axes are in A's frame, which is turned
// already.
TEST(Copies, OfLinksInARingCloseIt) {
  const Scene scene = copied(R"("bodies": [{"name": "bead", "shape": {"sphere": {"radius": 0.1}}, "position": [1, 0, 0],
      "copies": {"ring": {"count": 5}}}],
    "springs": [{"bodyA": "bead", "bodyB": "bead_1", "copies": {"ring": {"count": 5}}},
                {"bodyA": "bead_3", "bodyB": "bead_1", "copies": {"ring": {"count": 5}}}])");
  ASSERT_EQ(scene.springs.size(), 10u);
  for (std::size_t i = 0; i < 5; ++i) {
    const int number = static_cast<int>(i);
    EXPECT_EQ(scene.springs[i].anchorA.body, number);
    EXPECT_EQ(scene.springs[i].anchorB.body, (number + 1) % 5);
    EXPECT_NEAR(scene.springs[i].restLength, 2 * std::sin(M_PI / 5), 1e-14);
    EXPECT_EQ(scene.springs[5 + i].anchorA.body, (number + 3) % 5);
    EXPECT_EQ(scene.springs[5 + i].anchorB.body, (number + 1) % 5);
  }
}

}  // namespace
}  // namespace cradle
