#include "scene/picked_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A camera on the z axis that sees 45 degrees to each side of the middle: at a depth of 1 m, pixel c of 200 x 200 is
// (c + 0.5 - 100) / 100 m aside.
const std::string kCamera =
    R"("output": {"width": 200, "height": 200},
"camera": {"position": [0, 0, 5], "target": [0, 0, 0], "verticalFieldOfViewDegrees": 90},
)";

TEST(PickedPoints, LieOnTheRayOfThePixel) {
  const Scene scene = parse(sceneWith(kCamera + R"("bodies": [
    {"name": "wall", "shape": {"box": {"size": [9, 9, 2]}}, "motion": "static", "position": [0, 0, -2]},
    {"name": "ball", "shape": {"sphere": {"radius": 1}}, "position": [0, 0, 0.5], "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}}],
    "pushes": [{"pick": {"pixel": [99.5, 99.5]}}, {"body": "ball", "pick": {"pixel": [109.5, 99.5]}}])"))
                          .scene;
  ASSERT_EQ(scene.pushes.size(), 2U);
  EXPECT_EQ(scene.pushes[0].body, 1);
  EXPECT_NEAR((std::get<Vec3>(scene.pushes[0].target) - Vec3(0, 0, 1)).norm(), 0, 1e-14);
  // The ray (0.1, 0, -1) t from 4.5 m before the centre: 1.01 t^2 - 9 t + 19.25 = 0. The body's x axis is the world's
  // y.
  const double t = (9 - std::sqrt(81 - 4 * 1.01 * 19.25)) / 2.02;
  EXPECT_NEAR((std::get<Vec3>(scene.pushes[1].target) - Vec3(0, -0.1 * t, 4.5 - t)).norm(), 0, 1e-13);
}

TEST(PickedPoints, AreOnTheNamedBodyWhateverIsBeforeIt) {
  const Scene scene = parse(sceneWith(kCamera + R"("bodies": [
    {"name": "ball", "shape": {"sphere": {"radius": 1}}, "position": [0, 0, -3]},
    {"name": "screen", "shape": {"box": {"size": [9, 9, 2]}}, "motion": "static"}],
    "springs": [{"bodyA": "ball", "anchorA": {"pick": {"frame": 7, "pixel": [99.5, 99.5]}}, "anchorB": [0, 0, 2]}],
    "pushes": [{"body": "ball", "pick": {"pixel": [99.5, 99.5]}}])"))
                          .scene;
  EXPECT_NEAR((std::get<Vec3>(scene.pushes.at(0).target) - Vec3(0, 0, 1)).norm(), 0, 1e-14);
  EXPECT_NEAR((scene.springs.at(0).anchorA.point - Vec3(0, 0, 1)).norm(), 0, 1e-14);
  EXPECT_NEAR(scene.springs.at(0).restLength, 4, 1e-14);  // from where it was picked
}

TEST(PickedPoints, WaitForTheModelsBeforeThem) {
  const Scene scene = parse(sceneWith(kCamera + R"("bodies": [
    {"name": "ball", "shape": {"sphere": {"radius": 1}}, "position": [0, 0, -3]},
    {"name": "cube", "shape": {"mesh": "models/cube.3ds", "scale": 2}, "position": [-1, -1, 0]}],
    "pushes": [{"pick": {"pixel": [100, 110]}}])"))
                          .scene;
  EXPECT_EQ(scene.pushes.at(0).body, 1);
  EXPECT_NEAR((std::get<Vec3>(scene.pushes[0].target) - Vec3(1 + 0.005 * 3, 1 - 0.105 * 3, 2)).norm(), 0, 1e-14);
}

TEST(PickedPoints, AreSeenByACameraThatLooksAtABodyAndMoves) {
  const Scene scene = parse(sceneWith(R"("output": {"width": 200, "height": 200},
    "camera": {"position": [0, 0, 5], "target": "ball", "orbit": {"period": 9}},
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 1}}, "position": [3, 0, 5]}],
    "pushes": [{"pick": {"pixel": [99.5, 99.5]}}])"))
                          .scene;
  EXPECT_NEAR((std::get<Vec3>(scene.pushes.at(0).target) - Vec3(-1, 0, 0)).norm(), 0, 1e-14);
}

TEST(PickedPoints, ARayWithoutABodyStopsAtTheFirst) {
  const LoadedScene loaded = parse(sceneWith(R"("bodies": [
    {"name": "far", "shape": {"sphere": {"radius": 1}}, "position": [0, 0, -5]},
    {"name": "near", "shape": {"sphere": {"radius": 1}}},
    {"name": "floor", "shape": {"plane": {}}, "motion": "static", "position": [0, -3, 0]}],
    "pushes": [{"ray": {"origin": [0, 0, 9]}}, {"ray": {"origin": [8, 8, 8], "direction": [0, -1, 0]}}])"));
  EXPECT_EQ(loaded.scene.pushes.at(0).body, 1);
  EXPECT_TRUE(std::holds_alternative<Push::Ray>(loaded.scene.pushes[0].target));  // cast again when the push starts
  EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("the push moves nothing, because body \"floor\" is static")));
}

TEST(PickedPoints, AreNotTooMany) {
  const auto many = [](const std::string& key, const std::string& item) {
    std::string list = item;
    for (std::size_t i = 0; i < kMaxPicks; ++i) list += "," + item;
    return sceneWith(kCamera + R"("bodies": [{"name": "a", "shape": {"sphere": {}}}], ")" + key + "\": [" + list + "]");
  };
  EXPECT_THAT(errorOf(many("pushes", R"({"pick": {"pixel": [100, 100]}})")).what(),
              HasSubstr("/pushes/1000: from here on, more than 1000 pushes are picked"));
  EXPECT_THAT(errorOf(many("springs", R"({"bodyA": "a", "anchorA": {"pick": {"pixel": [100, 100]}}})")).what(),
              HasSubstr("/springs/1000: from here on, more than 1000 links"));
}

}  // namespace
}  // namespace cradle
