#include "truth/truth_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "math/rotation.h"
#include "render/camera.h"
#include "truth/truth_scene.h"

namespace cradle {
namespace {

using testing::ElementsAre;

TEST(TruthJson, RunLengthsGoDownTheColumnsAndBeginOutside) {
  const std::vector<std::uint16_t> ids = {7, 7, 0,   //
                                          0, 7, 0};  // 3 x 2 pixels
  const auto runs = runLengths({ids, 3, 2});
  EXPECT_THAT(runs.at(7), ElementsAre(0, 1, 1, 2, 2));
  EXPECT_THAT(runs.at(0), ElementsAre(1, 1, 2, 2));
}

TEST(TruthJson, CameraMatricesTakeItsAxesToTheWorld) {
  const Camera camera = cameraAt({1, 2, 3}, {0, 0.5, 0}, 0.9);
  const auto json = nlohmann::json::parse(cameraJson({{4, 0.25, Pinhole(camera, 320, 200)}}));
  EXPECT_EQ(json["width"], 320);
  EXPECT_EQ(json["height"], 200);
  const auto& frame = json["frames"].at(0);
  EXPECT_EQ(frame["frame"], 4);
  EXPECT_EQ(frame["time"], 0.25);
  const Mat3 axes = cameraAxes(camera);  // right, up, back
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      EXPECT_EQ(frame["worldFromCamera"][row][column], axes(row, column));
      EXPECT_EQ(frame["worldFromCameraOpenCV"][row][column], (column == 0 ? 1 : -1) * axes(row, column));
    }
    EXPECT_EQ(frame["worldFromCamera"][row][3], camera.position[row]);
    EXPECT_EQ(frame["worldFromCameraOpenCV"][row][3], camera.position[row]);
  }
  EXPECT_THAT(frame["worldFromCamera"][3], ElementsAre(0, 0, 0, 1));
  const double focal = 100 / std::tan(0.45);
  EXPECT_NEAR(frame["K"][0][0], focal, 1e-10);
  EXPECT_NEAR(frame["K"][1][1], focal, 1e-10);
  EXPECT_EQ(frame["K"][0][2], 160);
  EXPECT_EQ(frame["K"][1][2], 100);
}

TEST(TruthJson, InstancesHaveWhatIsSeenAndWhatThereIs) {
  TruthScene truth(40, 40);
  addBody(truth.scene, Box{{1, 1, 0.1}}, {Quat::Identity(), {0, 0, -0.05}}, Motion::fixed).name = "back";
  Body& front = addBody(truth.scene, Box{{0.48, 3, 0.1}}, {Quat::Identity(), {0.25, 0, 0.5}});
  front.name = "front";
  front.category = "bar";
  front.massProperties.mass = 3;
  addBody(truth.scene, Sphere{0.1}, {Quat::Identity(), {0, 0, 99}}, Motion::fixed).name = "behind the camera";
  truth.scene.materials[0].dynamicFriction = 0.25;
  truth.camera = cameraAt({0, 0, 11}, {0, 0, 0}, 2 * std::atan(1.0 / 11));
  Frame frame = startFrame(truth.scene);
  frame.number = 12;
  frame.states[0].linearVelocity = {1, 2, 3};
  const auto ids = segmentationPass(truth.first());
  const auto json = nlohmann::json::parse(
      instancesJson(truth.scene, frame, truth.first().wholes(), {ids, truth.width, truth.height}));
  ASSERT_EQ(json["annotations"].size(), 2U);
  const auto &back = json["annotations"][0], &bar = json["annotations"][1];
  EXPECT_EQ(json["images"][0]["id"], 12);
  EXPECT_EQ(back["name"], "back");
  EXPECT_EQ(back["id"], 1);
  EXPECT_THAT(back["wholeBox"], ElementsAre(10, 10, 20, 20));
  EXPECT_EQ(back["wholeArea"], 400);
  EXPECT_THAT(back["bbox"], ElementsAre(10, 10, 10, 20));  // its right half is hidden
  EXPECT_EQ(back["area"], 200);
  EXPECT_EQ(back["visibleFraction"], 0.5);
  EXPECT_EQ(back["mass"], 0);
  EXPECT_EQ(back["motion"], "static");
  EXPECT_EQ(bar["category"], "bar");
  EXPECT_EQ(json["categories"][1]["name"], "bar");
  EXPECT_EQ(bar["category_id"], json["categories"][1]["id"]);
  EXPECT_EQ(bar["mass"], 3);
  EXPECT_EQ(bar["dynamicFriction"], 0.25);
  EXPECT_THAT(bar["linearVelocity"], ElementsAre(1, 2, 3));
  EXPECT_THAT(bar["box3d"]["size"], ElementsAre(0.48, 3, 0.1));
  EXPECT_EQ(bar["worldFromBody"][0][3], 0.25);
  long sum = 0;
  for (const long run : back["segmentation"]["counts"]) sum += run;
  EXPECT_EQ(sum, 1600);
  EXPECT_THAT(back["segmentation"]["size"], ElementsAre(40, 40));
}

}  // namespace
}  // namespace cradle
