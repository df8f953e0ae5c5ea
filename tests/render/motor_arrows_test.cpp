#include "render/motor_arrows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "render/body_place.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

/// A wheel of radius 0.4 m and width 0.1 m on a fixed axle along z, and a cart that is pushed along x.
Scene motorScene() {
  Scene scene = emptyScene();
  addBody(scene, Cylinder{0.4, 0.1}, {rotationAbout(Vec3::UnitX(), std::numbers::pi / 2), {0, 1, 0}});
  addBody(scene, Box{{0.6, 0.2, 0.2}}, {Quat::Identity(), {3, 1, 0}});
  scene.hinges.push_back({});
  scene.hinges[0].anchorA = {0, Vec3::Zero()}, scene.hinges[0].anchorB = {kWorld, {0, 1, 0}};
  scene.hinges[0].axis = Vec3::UnitY();
  scene.hinges[0].motor = JointDrive{3.0, 5};
  scene.sliders.push_back({});
  scene.sliders[0].anchorA = {1, Vec3::Zero()}, scene.sliders[0].anchorB = {kWorld, {3, 1, 0}};
  scene.sliders[0].axis = Vec3::UnitX();
  scene.sliders[0].motor = JointDrive{{}, -8};
  return scene;
}

DrawList arrowsOf(const Scene& scene, double torque, double force) {
  Frame frame = startFrame(scene);
  frame.joints = {{0, 0, torque}, {0, 0, force}};
  const View view = viewOfStart(scene, 640, 360);
  const Appearance appearance = makeAppearance(scene, view, 100);
  DrawList list;
  appendMotorArrows(scene, appearance, frame, placeBodiesAtStart(scene), list);
  return list;
}

/// Arcs on both sides of the wheel, outside of it, with heads that point the way that a torque about z turns (the
/// hinge's axis is the wheel's y, which is -z or z of the world).
TEST(MotorArrows, TorqueIsAnArcOnBothSidesOfItsWheel) {
  const Scene scene = motorScene();
  const Vec3 axis = scene.bodies[0].worldFromBody.rotation * Vec3::UnitY();
  for (const double torque : {5.0, -5.0}) {
    const DrawList list = arrowsOf(scene, torque, 0);
    ASSERT_EQ(list.meshes.size(), 2u);
    for (const MeshItem& head : list.meshes) {
      const Vec3 tip = head.worldFromMesh.translation - Vec3(0, 1, 0);
      EXPECT_GT(std::abs(tip.z()), 0.05);
      EXPECT_NEAR(std::hypot(tip.x(), tip.y()), 0.75 * 0.4, 1e-9);
      const Vec3 pointing = head.worldFromMesh.rotation * Vec3::UnitY();
      EXPECT_GT(tip.cross(pointing).dot(axis) * torque, 0);
    }
    EXPECT_LT(list.meshes[0].worldFromMesh.translation.z() * list.meshes[1].worldFromMesh.translation.z(), 0);
  }
}

/// The angle goes with the part of all torque that acts; a twentieth and less is not shown.
TEST(MotorArrows, ArcGoesWithTheTorque) {
  const auto angleOf = [](const DrawList& list) {
    double angle = 0;
    for (std::size_t i = 0; i < list.cylinders.size() / 2; ++i) angle += list.cylinders[i].length / 1.1 / (0.75 * 0.4);
    return angle;
  };
  const double whole = angleOf(arrowsOf(motorScene(), 5, 0)), half = angleOf(arrowsOf(motorScene(), 2.5, 0));
  EXPECT_NEAR(half, whole / 2, 1e-9);
  EXPECT_TRUE(arrowsOf(motorScene(), 0.2, 0).meshes.empty());
  EXPECT_TRUE(arrowsOf(motorScene(), 0, 0).cylinders.empty());
}

/// An arrow that begins outside of the cart and goes the way of the force.
TEST(MotorArrows, ForceIsAnArrowAlongItsSlider) {
  for (const double force : {-8.0, 4.0}) {
    const DrawList list = arrowsOf(motorScene(), 0, force);
    ASSERT_EQ(list.meshes.size(), 1u);
    const Vec3 tip = list.meshes[0].worldFromMesh.translation;
    EXPECT_GT((tip.x() - 3) * force, 0.3 * std::abs(force));
    EXPECT_NEAR((list.meshes[0].worldFromMesh.rotation * Vec3::UnitY()).x(), force < 0 ? -1 : 1, 1e-12);
    EXPECT_NEAR(tip.y(), 1, 1e-12);
  }
}

/// On B a motor acts the other way.
TEST(MotorArrows, ArrowStandsAtTheSmallerBody) {
  Scene scene = motorScene();
  addBody(scene, Box{{3, 3, 3}}, {Quat::Identity(), {0, 1, 0}});
  std::swap(scene.hinges[0].anchorA, scene.hinges[0].anchorB);
  scene.hinges[0].anchorA = {2, Vec3::Zero()};
  scene.hinges[0].axis = scene.bodies[0].worldFromBody.rotation * Vec3::UnitY();
  const DrawList list = arrowsOf(scene, 5, 0);
  ASSERT_EQ(list.meshes.size(), 2u);
  const Vec3 tip = list.meshes[0].worldFromMesh.translation - Vec3(0, 1, 0);
  EXPECT_NEAR(std::hypot(tip.x(), tip.y()), 0.75 * 0.4, 1e-9);
  EXPECT_LT(tip.cross(list.meshes[0].worldFromMesh.rotation * Vec3::UnitY()).dot(scene.hinges[0].axis), 0);
}

/// A wheel inside of a case has its arcs in front of the case and behind it, a cart inside of a fixed sleeve its arrow
/// beyond the sleeve's end.
TEST(MotorArrows, StandOutsideOfWhatWouldHideThem) {
  Scene scene = motorScene();
  addBody(scene, Box{{2, 2, 2}}, {Quat::Identity(), {0, 1, 0}});
  addBody(scene, Box{{4, 0.5, 0.5}}, {Quat::Identity(), {3, 1, 0}}, Motion::fixed);
  scene.hinges[0].anchorB = {2, Vec3::Zero()};
  const DrawList list = arrowsOf(scene, 5, 4);
  ASSERT_EQ(list.meshes.size(), 3u);
  EXPECT_GT(list.cylinders.size(), 100u);
  for (const CylinderItem& piece : list.cylinders)
    EXPECT_TRUE(std::abs(piece.center.z()) > 1 || piece.center.x() - piece.length / 2 > 5 - 1e-12)
        << piece.center.transpose();
}

/// From where the program looks the arrows are in the picture, as the bodies alone would have them outside.
TEST(MotorArrows, AreInThePictureThatTheProgramChooses) {
  const Scene scene = motorScene();
  Frame frame = startFrame(scene);
  const auto farthestOut = [&](const View& view) {
    DrawList list;
    appendMotorArrows(scene, makeAppearance(scene, view, 100), frame, placeBodiesAtStart(scene), list);
    double farthest = 0;
    for (const MeshItem& head : list.meshes) {
      const Eigen::Vector2d pixel = projectToPixel(view.camera, head.worldFromMesh.translation, 640, 360);
      farthest = std::max({farthest, std::abs(pixel.x() / 320 - 1), std::abs(pixel.y() / 180 - 1)});
    }
    return farthest;
  };
  frame.joints = {{0, 0, 5}, {0, 0, 8}};
  EXPECT_GT(farthestOut(viewOfStart(scene, 640, 360)), 1);  // its frame tells of no forces
  Framing framing(scene, 640, 360);
  framing.add(frame);
  EXPECT_LT(farthestOut(framing.view()), 0.85);
}

/// Files of earlier versions tell nothing of joints.
TEST(MotorArrows, WithoutJointStatesThereAreNone) {
  const Scene scene = motorScene();
  const View view = viewOfStart(scene, 640, 360);
  DrawList list;
  appendMotorArrows(scene, makeAppearance(scene, view, 100), startFrame(scene), placeBodiesAtStart(scene), list);
  EXPECT_TRUE(list.meshes.empty());
}

}  // namespace
}  // namespace cradle
