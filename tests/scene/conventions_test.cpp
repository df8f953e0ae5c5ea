// Frames and signs, against matrices and vectors written out by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

constexpr double kRounding = 1e-15;  // a few roundings of values up to 1

Mat3 rotationOf(const std::string& orientation) {
  const Scene scene = parse(sceneWithBody(R"("orientation": )" + orientation)).scene;
  return scene.bodies.at(0).worldFromBody.rotation.toRotationMatrix();
}

Mat3 rotationX(double a) {
  return (Mat3() << 1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a)).finished();
}
Mat3 rotationY(double a) {
  return (Mat3() << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)).finished();
}
Mat3 rotationZ(double a) {
  return (Mat3() << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1).finished();
}

const double kA = 10 * std::numbers::pi / 180, kB = 25 * std::numbers::pi / 180, kC = -70 * std::numbers::pi / 180;

TEST(Orientation, QuaternionTurnsBodyToWorld) {
  const double half = std::sqrt(0.5);
  const Mat3 rotation = rotationOf(R"({"w": 0.7071067811865476, "x": 0, "y": 0, "z": 0.7071067811865476})");
  EXPECT_LT((rotation - rotationZ(std::numbers::pi / 2)).norm(), 2 * kRounding) << half;
}

TEST(Orientation, QuaternionIsMadeUnit) {
  const Scene scene = parse(sceneWithBody(R"("orientation": {"w": 0.8000004, "x": 0, "y": 0.6, "z": 0})")).scene;
  EXPECT_NEAR(scene.bodies.at(0).worldFromBody.rotation.norm(), 1, kRounding);
}

TEST(Orientation, AxisAngleIsCounterClockwiseFromTheTip) {
  EXPECT_LT((rotationOf(R"({"axis": [0, 0, 3], "angleDegrees": 10})") - rotationZ(kA)).norm(), kRounding);
  EXPECT_LT((rotationOf(R"({"axis": [0, 5, 0], "angleDegrees": 25})") - rotationY(kB)).norm(), kRounding);
  EXPECT_LT((rotationOf(R"({"axis": [-1, 0, 0], "angleDegrees": 70})") - rotationX(kC)).norm(), kRounding);
}

TEST(Orientation, EulerAnglesMultiplyInTheOrderWritten) {
  const Mat3 usual = rotationZ(kA) * rotationY(kB) * rotationX(kC);
  EXPECT_LT((rotationOf(R"({"eulerDegrees": [10, 25, -70], "order": "zyx"})") - usual).norm(), 4 * kRounding);
  EXPECT_LT((rotationOf(R"({"eulerDegrees": [10, 25, -70]})") - usual).norm(), 4 * kRounding);
  const Mat3 xyz = rotationX(kA) * rotationY(kB) * rotationZ(kC);
  EXPECT_LT((rotationOf(R"({"eulerDegrees": [10, 25, -70], "order": "xyz"})") - xyz).norm(), 4 * kRounding);
  const Mat3 zxz = rotationZ(kA) * rotationX(kB) * rotationZ(kC);
  EXPECT_LT((rotationOf(R"({"eulerDegrees": [10, 25, -70], "order": "zxz"})") - zxz).norm(), 4 * kRounding);
}

TEST(AngularVelocity, OfTheBodysFrameIsTurnedToTheWorld) {
  // A quarter turn about z takes the body's x to the world's y.
  const Scene scene =
      parse(
          sceneWithBody(R"("orientation": {"axis": [0, 0, 1], "angleDegrees": 90}, "angularVelocityBody": [2, 0, 5])"))
          .scene;
  EXPECT_LT((scene.bodies.at(0).angularVelocity - Vec3(0, 2, 5)).norm(), 8 * kRounding);
}

TEST(AngularVelocity, OfTheWorldStaysAsItIs) {
  const Scene scene =
      parse(sceneWithBody(R"("orientation": {"axis": [0, 0, 1], "angleDegrees": 90}, "angularVelocity": [2, 0, 5])"))
          .scene;
  EXPECT_EQ(scene.bodies.at(0).angularVelocity, Vec3(2, 0, 5));
}

TEST(Anchors, AreInTheBodysFrame) {
  // The anchor (1, 0, 0) of a body turned by a quarter about z and put at (5, 0, 0) is at (5, 1, 0).
  const Scene scene =
      parse(sceneWithBody(R"("position": [5, 0, 0], "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}}],
    "rods": [{"bodyA": "a", "anchorA": [1, 0, 0], "anchorB": [5, 4, 0])"))
          .scene;
  EXPECT_NEAR(scene.rods.at(0).length, 3, 4 * kRounding);
}

}  // namespace
}  // namespace cradle
