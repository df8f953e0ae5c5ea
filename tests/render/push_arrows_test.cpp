#include "render/push_arrows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "mesh/mass_properties.h"
#include "render/arrows.h"
#include "render/body_place.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr double kStart = 1.005, kDuration = 0.1;  // s; between two frames
const Vec3 kForce(0, -6, 8);                       // N: direction (0, -0.6, 0.8)

double timeOf(long frame) {
  return static_cast<double>(frame) / 60;
}

/// A box that flies along x at 2 m/s and turns about y at 3 rad/s; frames are 1/60 s apart.
Frame frameOfFlight(long number) {
  Frame frame;
  frame.number = number;
  frame.time = timeOf(number);
  frame.states.resize(1);
  frame.states[0].position = {2 * frame.time, 1, 0};
  frame.states[0].orientation = rotationAbout(Vec3::UnitY(), 3 * frame.time);
  return frame;
}

RigidTransform placeInFlight(double time) {
  return {rotationAbout(Vec3::UnitY(), 3 * time), {2 * time, 1, 0}};
}

Scene pushedScene(const std::variant<Vec3, Push::Ray>& target) {
  Scene scene = emptyScene();
  scene.duration = 2;
  addBody(scene, Box{{0.4, 0.3, 0.2}}, {Quat::Identity(), {0, 1, 0}});
  scene.pushes.push_back({"", 0, target, kForce, kStart, kDuration});
  return scene;
}

Event pushEvent(double time, const Vec3& point, EventKind kind = EventKind::pushStart, int body = 0) {
  return {time, kind, body, kWorld, point, Vec3::Zero(), 0};
}

const Vec3 kPointOfBody(0.2, 0.15, 0.1);

std::vector<ShownPush> pushesOf(const Scene& scene) {
  return findShownPushes(scene, {pushEvent(kStart, placeInFlight(kStart) * kPointOfBody)}, frameOfFlight);
}

View viewOf(const Scene& scene) {
  Framing framing(scene, 640, 360, pushesOf(scene));
  for (long frame = 0; frame <= 120; ++frame) framing.add(frameOfFlight(frame));
  return framing.view();
}

DrawList listAt(const Scene& scene, long frame) {
  const View view = viewOf(scene);
  const Frame shown = frameOfFlight(frame);
  return makeDrawList(scene, makeAppearance(scene, view, 100), view, {shown, view.camera.position});
}

/// Where the head of the only arrow has its point: the box is mesh 0 of the list, the head a later one.
Vec3 tipOf(const DrawList& list) {
  return list.meshes.at(1).worldFromMesh.translation;
}

TEST(ShownPush, PointHitByARayIsFoundInTheBodysFrame) {
  // Between frames the turn is interpolated exactly and the place too: both go at a constant rate.
  const Scene scene = pushedScene(Push::Ray{{5, 1, 0}, -Vec3::UnitX()});
  const auto pushes = pushesOf(scene);
  ASSERT_EQ(pushes.size(), 1u);
  EXPECT_NEAR((pushes[0].pointOfBody - kPointOfBody).norm(), 0, 1e-12);
}

/// An arc round the body, whose head has its point in the plane through the centre of mass across the axis, and whose
/// pieces go about that axis as a right hand's fingers do.
TEST(ShownPush, TorqueIsAnArcRoundItsBody) {
  Scene scene = pushedScene(Vec3::Zero());
  const Vec3 axis(0, -0.6, 0.8);
  scene.pushes[0].torque = 10 * axis;
  Framing framing(scene, 640, 360,
                  findShownPushes(scene, {pushEvent(kStart, placeInFlight(kStart).translation)}, frameOfFlight));
  for (long frame = 0; frame <= 120; ++frame) framing.add(frameOfFlight(frame));
  const View view = framing.view();
  const Frame shown = frameOfFlight(62);
  const DrawList list = makeDrawList(scene, makeAppearance(scene, view, 100), view, {shown, view.camera.position});
  ASSERT_EQ(list.meshes.size(), 2u);
  const double radius = std::max(Vec3(0.2, 0.15, 0.1).norm() + 0.06 * view.longestArrow, 0.4 * view.longestArrow);
  const Vec3 tip = tipOf(list) - shown.states[0].position;
  EXPECT_NEAR(tip.norm(), radius, 1e-9);
  EXPECT_NEAR(tip.dot(axis), 0, 1e-9);
  ASSERT_GT(list.cylinders.size(), 10u);
  for (const auto& piece : list.cylinders) {
    const Vec3 out = (piece.center - shown.states[0].position) / radius;
    EXPECT_LT((out.cross(piece.axis) - axis).norm(), 1e-9);
  }
}

TEST(ShownPush, PushThatMissedIsNotShown) {
  const Scene scene = pushedScene(Push::Ray{{5, 9, 0}, -Vec3::UnitX()});
  EXPECT_TRUE(findShownPushes(scene, {pushEvent(kStart, {5, 9, 0}, EventKind::pushMissed)}, frameOfFlight).empty());
}

TEST(ShownPush, EventsOfABodyBelongToItsPushesInOrderOfTheirStart) {
  Scene scene = pushedScene(Vec3(0.1, 0, 0));
  addBody(scene, Sphere{0.1}, {});
  scene.pushes.push_back({"", 1, Vec3(0, 0.1, 0), {1, 0, 0}, 0.7, 0.2});
  scene.pushes.push_back({"", 0, Vec3(0, 0, 0.1), {2, 0, 0}, 0.5, 0.3});
  const auto frameAt = [](long number) {
    Frame frame = frameOfFlight(number);
    frame.states.resize(2);
    return frame;
  };
  const auto pushes =
      findShownPushes(scene,
                      {pushEvent(0.5, kPointOfBody), pushEvent(0.7, kPointOfBody, EventKind::pushStart, 1),
                       pushEvent(kStart, kPointOfBody)},
                      frameAt);
  ASSERT_EQ(pushes.size(), 3u);
  EXPECT_EQ(pushes[0].force, Vec3(2, 0, 0));
  EXPECT_EQ(pushes[1].force, Vec3(1, 0, 0));
  EXPECT_EQ(pushes[2].force, kForce);
}

TEST(PushArrows, ArrowIsSeenFromAQuarterOfASecondBeforeThePushUntilAfterItsEnd) {
  // Shown from 1.005 - 0.25 = 0.755 (frame 45.3) until 1.105 + 0.35 = 1.455 (frame 87.3).
  const Scene scene = pushedScene(kPointOfBody);
  for (const long frame : {0L, 45L, 88L, 120L}) EXPECT_TRUE(listAt(scene, frame).cylinders.empty()) << frame;
  for (const long frame : {46L, 60L, 63L, 87L}) EXPECT_EQ(listAt(scene, frame).cylinders.size(), 1u) << frame;
}

TEST(PushArrows, SlowMotionShowsThemShorterInTheTimeOfTheScene) {
  Scene scene = pushedScene(kPointOfBody);
  scene.output.playbackSpeed = 0.1;
  scene.output.framesPerSecond = 6;  // frames are 1/60 s of the scene apart, as before
  const ShownPush push = pushesOf(scene).at(0);
  EXPECT_NEAR(push.shownFrom, kStart - 0.025, 1e-12);
  EXPECT_NEAR(push.shownUntil, kStart + kDuration + 0.035, 1e-12);
}

TEST(PushArrows, TipStandsWhereThePushWillHitAndThenGoesWithTheBody) {
  for (const auto& target : {std::variant<Vec3, Push::Ray>(kPointOfBody),
                             std::variant<Vec3, Push::Ray>(Push::Ray{{5, 1, 0}, -Vec3::UnitX()})}) {
    const Scene scene = pushedScene(target);
    EXPECT_NEAR((tipOf(listAt(scene, 50)) - placeInFlight(kStart) * kPointOfBody).norm(), 0, 1e-12);
    for (const long frame : {61L, 70L, 85L})
      EXPECT_NEAR((tipOf(listAt(scene, frame)) - placeInFlight(timeOf(frame)) * kPointOfBody).norm(), 0, 1e-12);
  }
}

TEST(PushArrows, ArrowPointsAlongTheForce) {
  const DrawList list = listAt(pushedScene(kPointOfBody), 63);
  const Vec3 direction = kForce.normalized();
  EXPECT_NEAR((list.meshes.at(1).worldFromMesh.rotation * Vec3::UnitY() - direction).norm(), 0, 1e-12);
  EXPECT_NEAR((list.cylinders.at(0).axis - direction).norm(), 0, 1e-12);
  // The shaft lies on the line through the tip, behind it.
  const Vec3 fromTip = list.cylinders[0].center - tipOf(list);
  EXPECT_NEAR((fromTip + fromTip.norm() * direction).norm(), 0, 1e-12);
}

TEST(PushArrows, ShaftAndHeadTogetherAreAsLongAsTheForceSays) {
  Scene scene = pushedScene(kPointOfBody);
  const View view = viewOf(scene);
  const DrawList list = listAt(scene, 63);
  const CylinderItem& shaft = list.cylinders.at(0);
  const Vec3 tail = shaft.center - shaft.length / 2 * shaft.axis;
  EXPECT_NEAR((tipOf(list) - tail).norm(), view.longestArrow, 1e-12);

  // Linear in the force, from 0.45 of the longest up.
  View two = view;
  ShownPush weaker = view.pushes.at(0);
  weaker.force = 0.2 * kForce;
  two.pushes.push_back(weaker);
  EXPECT_NEAR(two.arrowLength(weaker), (0.45 + 0.2 * 0.55) * view.longestArrow, 1e-12);
}

TEST(PushArrows, WholeArrowIsInThePicture) {
  const Scene scene = pushedScene(kPointOfBody);
  const View view = viewOf(scene);
  for (long frame = 46; frame <= 87; ++frame) {
    const CylinderItem shaft = listAt(scene, frame).cylinders.at(0);
    const Vec3 tail = shaft.center - shaft.length / 2 * shaft.axis;
    const Eigen::Vector2d pixel = projectToPixel(view.camera, tail, 640, 360);
    EXPECT_TRUE(pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < 360) << pixel.transpose();
    EXPECT_TRUE(view.bounds.contains(tail));
  }
}

TEST(PushArrows, HeadIsAClosedConeWoundOutwards) {
  // Of height 0.26 and radius 0.085 the volume is pi r^2 h / 3; 48 facets inscribed have sin(a) / a of it, a = 2 pi
  // / 48.
  const DrawnMesh head = makeArrowHead(1);
  const MassProperties cone = computeMassProperties({head.vertices, head.triangles}, 1);
  const double a = 2 * std::numbers::pi / 48;
  EXPECT_NEAR(cone.mass, std::numbers::pi * 0.085 * 0.085 * 0.26 / 3 * std::sin(a) / a, 1e-15);
  EXPECT_NEAR(cone.centerOfMass.y(), -0.75 * 0.26, 1e-12);
  for (const Triangle& triangle : head.triangles) {
    const Vec3 a = head.vertices[triangle[0]], b = head.vertices[triangle[1]], c = head.vertices[triangle[2]];
    for (const std::uint32_t corner : triangle)
      EXPECT_GT((b - a).cross(c - a).dot(head.normals[corner].cast<double>()), 0);
  }
}

TEST(PushArrows, RedArrowIsSeenInThePicture) {
  const Scene scene = pushedScene(kPointOfBody);
  const View view = viewOf(scene);
  Renderer renderer(scene, view, 640, 360);
  const auto isRed = [&](long frame) {
    const Image image = renderer.render(frameOfFlight(frame));
    const CylinderItem shaft = listAt(scene, 63).cylinders.at(0);
    const Eigen::Vector2d pixel = projectToPixel(view.camera, shaft.center, 640, 360);
    const std::uint8_t* rgb = image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
    return rgb[0] > 2 * rgb[1] && rgb[0] > 2 * rgb[2];
  };
  EXPECT_TRUE(isRed(63));
  EXPECT_FALSE(isRed(20));
}

}  // namespace
}  // namespace cradle
