#include "render/draw_list.h"

#include <gtest/gtest.h>

#include <numbers>

#include "math/rotation.h"
#include "render/body_place.h"
#include "render/scene_builder.h"
#include "render/tube_curve.h"

namespace cradle {
namespace {

DrawList listOf(const Scene& scene, const Frame& frame) {
  Framing framing(scene, 640, 360);
  framing.add(frame);
  const View view = framing.view();
  return makeDrawList(scene, makeAppearance(scene, view, 100), view, {frame, view.camera.position});
}

Scene springScene(double height) {
  Scene scene = emptyScene();
  addBody(scene, Box{{0.4, 0.3, 0.2}}, {Quat::Identity(), {0, -height, 0}});
  scene.springs.push_back({"", "", {0, {0.2, 0.15, 0.1}}, {kWorld, {0.2, 0.15, 0.1}}, 100, 0, 1});
  return scene;
}

TEST(BodyPlace, FrameOriginIsCentreOfMassMinusItsTurnedOffset) {
  Scene scene = emptyScene();
  addBody(scene, Box{{1, 2, 3}}, {}).massProperties.centerOfMass = {0.1, 0.2, 0.3};
  Frame frame;
  frame.states.resize(1);
  frame.states[0].position = {5, 6, 7};
  frame.states[0].orientation = rotationAbout(Vec3::UnitZ(), std::numbers::pi / 2);  // x to y, y to -x
  const RigidTransform place = placeBodies(scene, frame).at(0);
  EXPECT_NEAR((place.translation - Vec3(5.2, 5.9, 6.7)).norm(), 0, 1e-14);
}

TEST(BodyPlace, FixedBodiesTakeNoState) {
  Scene scene = emptyScene();
  addBody(scene, Sphere{1}, {Quat::Identity(), {1, 0, 0}}, Motion::fixed);
  addBody(scene, Sphere{1}, {});
  Frame frame;
  frame.states.resize(1);
  frame.states[0].position = {0, 9, 0};
  const auto places = placeBodies(scene, frame);
  EXPECT_EQ(places.at(0).translation, Vec3(1, 0, 0));
  EXPECT_EQ(places.at(1).translation, Vec3(0, 9, 0));
}

double lengthOf(const TubeItem& tube) {
  constexpr int kPieces = 20000;
  double length = 0;
  for (int i = 0; i < kPieces; ++i)
    length += (tubePoint(tube, (i + 1.0) / kPieces) - tubePoint(tube, i / double{kPieces})).norm();
  return length;
}

TEST(DrawList, SpringRunsFromAnchorToAnchor) {
  const Scene scene = springScene(1.2);
  Frame frame = startFrame(scene);
  frame.states[0].orientation = rotationAbout(Vec3::UnitY(), 0.3);
  const DrawList list = listOf(scene, frame);
  ASSERT_EQ(list.tubes.size(), 1u);
  EXPECT_NEAR((list.tubes[0].start - (Vec3(0, -1.2, 0) + frame.states[0].orientation * Vec3(0.2, 0.15, 0.1))).norm(), 0,
              1e-14);
  EXPECT_EQ(list.tubes[0].end, Vec3(0.2, 0.15, 0.1));
}

TEST(DrawList, WireOfASpringKeepsItsLength) {
  const Scene scene = springScene(1.2);
  const auto tubeAt = [&](double height) {
    Frame frame = startFrame(scene);
    frame.states[0].position.y() = -height;
    return listOf(scene, frame).tubes.at(0);
  };
  const TubeItem pressed = tubeAt(0.7), drawn = tubeAt(1.7);
  EXPECT_EQ(pressed.turns, drawn.turns);
  EXPECT_LT(drawn.coilRadius, pressed.coilRadius);
  EXPECT_NEAR(lengthOf(pressed) / lengthOf(drawn), 1, 0.01);  // the view grows with the motion, and thickness with it
}

TEST(DrawList, WireThatIsDrawnOutFurtherKeepsItsVolume) {
  TubeItem coil{{0, 0, 0}, {0, 3, 0}, {1, 0, 0}};
  coil.turns = 10;
  coil.straightEnd = 0.07;
  EXPECT_NEAR(windCoil(5, 0.01, coil), 5, 1e-9);
  EXPECT_NEAR(lengthOf(coil), 5, 0.005);
  EXPECT_GT(coil.coilRadius, 0.01);
  coil.end = {0, 6, 0};  // longer than the wire
  EXPECT_GT(windCoil(5, 0.01, coil), 6);
  EXPECT_DOUBLE_EQ(coil.coilRadius, 0.01);

  const auto tubeAt = [](double height) {
    const Scene scene = springScene(1.2);
    Frame frame = startFrame(scene);
    frame.states[0].position.y() = -height;
    return listOf(scene, frame).tubes.at(0);
  };
  const auto volume = [](const TubeItem& tube) { return tube.wireRadius * tube.wireRadius * lengthOf(tube); };
  EXPECT_LT(tubeAt(9).wireRadius / tubeAt(9).coilRadius, tubeAt(1.2).wireRadius / (0.3 * tubeAt(1.2).coilRadius));
  EXPECT_NEAR(volume(tubeAt(9)) / volume(tubeAt(1.2)), 1, 0.02);
}

TEST(DrawList, CoilTurnsWithItsSpringWithoutJumps) {
  Scene scene = emptyScene();
  addBody(scene, Sphere{0.1}, {Quat::Identity(), {0, -1, 0}});
  scene.springs.push_back({"", "", {0, {0, 0, 0}}, {kWorld, {0, 0, 0}}, 100, 0, 1});
  Vec3 before = Vec3::Zero();
  for (int i = 0; i <= 300; ++i) {  // most of a full turn, past all axes of the world
    const double angle = 0.01 * i;
    Frame frame = startFrame(scene);
    frame.states[0].position = Vec3(0.05 * std::sin(3 * angle), -std::cos(angle), std::sin(angle));
    const Vec3 side = listOf(scene, frame).tubes.at(0).side;
    EXPECT_NEAR(side.dot(frame.states[0].position.normalized()), 0, 1e-12);
    if (i > 0) {
      EXPECT_LT((side - before).norm(), 0.1) << angle;
    }
    before = side;
  }
}

TEST(DrawList, SlackRopeHangsAsLongAsItIs) {
  Scene scene = emptyScene();
  addBody(scene, Sphere{0.1}, {Quat::Identity(), {1.2, 0, 0}});
  scene.ropes.push_back({"", "", {0, {0, 0, 0}}, {kWorld, {0, 0, 0}}, 2, 0});
  const TubeItem rope = listOf(scene, startFrame(scene)).tubes.at(0);
  EXPECT_NEAR(lengthOf(rope), 2, 1e-5);
  EXPECT_LT(rope.sag.y(), 0);
  EXPECT_TRUE(rope.bounds.contains(Vec3((rope.start + rope.end) / 2 + rope.sag)));
}

// Along a hanging rope, the horizontal pull is the same everywhere and the vertical one grows with the weight of what
// hangs below: the slope is a linear function of the length along it.
TEST(DrawList, SlackRopeIsACatenaryOfItsLength) {
  for (const Vec3& end : {Vec3(1.2, 0, 0), Vec3(0.7, 1.1, 0.4), Vec3(-1, -1.5, 0.3), Vec3(0.4, 0.1, 0)}) {
    TubeItem rope{Vec3::Zero(), end, Vec3::Zero()};
    hangRope(2, -Vec3::UnitY(), rope);
    constexpr int kPieces = 40000;
    const double step = std::hypot(end.x(), end.z()) / kPieces;
    double length = 0, firstSlope = 0, change = 0;
    for (int i = 0; i < kPieces; ++i) {
      const Vec3 piece = tubePoint(rope, (i + 1.0) / kPieces) - tubePoint(rope, i / double{kPieces});
      const double slope = piece.y() / step;
      length += piece.norm();
      if (i == 0) firstSlope = slope;
      if (i == kPieces / 4) change = (slope - firstSlope) / length;  // per metre
      if (i > kPieces / 4) {
        EXPECT_NEAR((slope - firstSlope) / (length * change), 1, 2e-3) << end.transpose() << " " << i;
      }
    }
    EXPECT_NEAR(length, 2, 1e-6) << end.transpose();
    Bounds around;
    for (const Vec3& corner : ropeCorners(rope)) around.extend(corner);
    for (int i = 0; i <= 100; ++i) EXPECT_LT(around.exteriorDistance(tubePoint(rope, i / 100.0)), 1e-9);
  }
}

TEST(DrawList, RopeWithItsEndsTogetherHangsDoubled) {
  TubeItem rope{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  hangRope(2, -Vec3::UnitY(), rope);
  EXPECT_NEAR(tubePoint(rope, 0.5).y(), -1, 0.02);
}

TEST(DrawList, SlackRopeLiesOnTheGroundRatherThanInIt) {
  // Hanging freely, a rope of 2 m over a chord of 1.2 m would sag by 0.71 m; the ground is 0.2 m below its lower end.
  for (const double rise : {0.0, 0.5}) {
    Scene scene = emptyScene();
    addBody(scene, Plane{}, {Quat::Identity(), {0, -0.2, 0}}, Motion::fixed);
    addBody(scene, Sphere{0.1}, {Quat::Identity(), {1.2, rise, 0}});
    scene.ropes.push_back({"", "", {1, {0, 0, 0}}, {kWorld, {0, 0, 0}}, 2, 0});
    const TubeItem rope = listOf(scene, startFrame(scene)).tubes.at(0);
    double lowest = 1, length = 0;
    Vec3 before = rope.start;
    for (int i = 1; i <= 1000; ++i) {
      const double s = i / 1000.0;
      const Vec3 point = tubePoint(rope, s);
      lowest = std::min(lowest, point.y());
      length += (point - before).norm();
      before = point;
    }
    EXPECT_NEAR(lowest, -0.2 + rope.wireRadius, 1e-5) << rise;
    if (rise == 0) {
      EXPECT_NEAR(length, 2, 1e-5);
    }
  }
}

TEST(DrawList, TautRopeIsStraight) {
  Scene scene = emptyScene();
  addBody(scene, Sphere{0.1}, {Quat::Identity(), {2, 0, 0}});
  scene.ropes.push_back({"", "", {0, {0, 0, 0}}, {kWorld, {0, 0, 0}}, 2, 0});
  EXPECT_EQ(listOf(scene, startFrame(scene)).tubes.at(0).sag, Vec3::Zero());
}

TEST(DrawList, RodEndsAtItsAnchors) {
  Scene scene = emptyScene();
  addBody(scene, Sphere{0.1}, {Quat::Identity(), {1, 0, 0}});
  scene.rods.push_back({"", "", {0, {0, 0, 0}}, {kWorld, {0, 2, 0}}, std::sqrt(5.0)});
  const CylinderItem rod = listOf(scene, startFrame(scene)).cylinders.at(0);
  EXPECT_NEAR((rod.center - Vec3(0.5, 1, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(rod.length, std::sqrt(5.0), 1e-14);
  EXPECT_NEAR(rod.axis.cross(Vec3(-1, 2, 0)).norm(), 0, 1e-14);
}

TEST(DrawList, BallJointIsADarkBallAtTheEndOfAnArm) {
  Scene scene = emptyScene();
  addBody(scene, Box{{0.6, 0.2, 0.6}}, {Quat::Identity(), {0, 1, 0}});
  scene.ballJoints.push_back({"", "", {0, {0, -0.5, 0}}, {kWorld, {0, 0.5, 0}}});
  Frame frame = startFrame(scene);
  frame.states[0].orientation = rotationAbout(Vec3::UnitZ(), std::numbers::pi / 2);  // -y to x
  const DrawList list = listOf(scene, frame);
  ASSERT_EQ(list.spheres.size(), 1u);
  EXPECT_NEAR((list.spheres[0].center - Vec3(0.5, 1, 0)).norm(), 0, 1e-14);
  EXPECT_LT(list.spheres[0].surface.color.maxCoeff(), 0.2f);
  ASSERT_EQ(list.cylinders.size(), 1u);  // the arm: from the centre of mass to the joint
  EXPECT_NEAR((list.cylinders[0].center - Vec3(0.25, 1, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(list.cylinders[0].length, 0.5, 1e-14);
  EXPECT_LT(list.cylinders[0].radius, list.spheres[0].radius);
}

TEST(DrawList, PinOfAHingeLiesAlongItsAxisAndTurnsWithBodyA) {
  Scene scene = emptyScene();
  addBody(scene, Box{{0.4, 0.1, 0.4}}, {Quat::Identity(), {0, 1, 0}});
  scene.hinges.push_back({"", "", {0, {0.2, 0, 0}}, {kWorld, {0.2, 1, 0}}, {0.6, 0, 0.8}});
  Frame frame = startFrame(scene);
  frame.states[0].orientation = rotationAbout(Vec3::UnitX(), std::numbers::pi / 2);  // z to -y
  const DrawList list = listOf(scene, frame);
  ASSERT_EQ(list.cylinders.size(), 1u);  // the hinge is on the body's surface: no arm
  const CylinderItem& pin = list.cylinders[0];
  EXPECT_NEAR((pin.center - Vec3(0.2, 1, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(pin.axis.cross(Vec3(0.6, -0.8, 0)).norm(), 0, 1e-14);
  EXPECT_GT(pin.length, 3 * pin.radius);
  EXPECT_LT(pin.surface.color.maxCoeff(), 0.2f);
}

// A body that has moved by 0.02 along its axis, and one that has left its rail, which reaches to it then.
TEST(DrawList, RailOfASliderStaysOnBAndCarriesTheSleeveOfA) {
  Scene scene = emptyScene();
  addBody(scene, Box{{0.4, 0.1, 0.4}}, {Quat::Identity(), {0, 1, 0}});
  scene.sliders.push_back({"", "", {0, {0, 0.05, 0}}, {kWorld, {0, 1.05, 0}}, {0.6, 0, 0.8}});
  for (const double way : {0.02, 9.0}) {
    Frame frame = startFrame(scene);
    frame.states[0].position += way * Vec3(0.6, 0, 0.8);
    const DrawList list = listOf(scene, frame);
    ASSERT_EQ(list.cylinders.size(), 2u);
    const CylinderItem &rail = list.cylinders[0], &sleeve = list.cylinders[1];
    EXPECT_NEAR((sleeve.center - Vec3(0.6 * way, 1.05, 0.8 * way)).norm(), 0, 1e-14);
    for (const CylinderItem& item : list.cylinders) EXPECT_NEAR(item.axis.cross(Vec3(0.6, 0, 0.8)).norm(), 0, 1e-14);
    EXPECT_GT(sleeve.radius, rail.radius);
    EXPECT_GT(rail.length, 3 * sleeve.length);
    const double end = (rail.center - Vec3(0, 1.05, 0)).dot(Vec3(0.6, 0, 0.8)) + rail.length / 2;
    EXPECT_GE(end, way + sleeve.length / 2 - 1e-14);
    if (way < 1) {
      EXPECT_NEAR((rail.center - Vec3(0, 1.05, 0)).norm(), 0, 1e-14);
    }
  }
}

// The sleeve reaches the end of the rail at a limit, where a stop stands around it; beyond the other side is none.
TEST(DrawList, RailEndsAtTheLimitsOfItsSlider) {
  Scene scene = emptyScene();
  addBody(scene, Box{{0.4, 0.1, 0.4}}, {Quat::Identity(), {0, 1, 0}});
  scene.sliders.push_back({"", "", {0, {0, 0.05, 0}}, {kWorld, {0, 1.05, 0}}, {1, 0, 0}});
  scene.sliders[0].limits.emplace().upper = 0.07;
  Frame frame = startFrame(scene);
  frame.states[0].position.x() += 0.07;
  const DrawList list = listOf(scene, frame);
  ASSERT_EQ(list.cylinders.size(), 3u);
  const CylinderItem &rail = list.cylinders[0], &sleeve = list.cylinders[1], &stop = list.cylinders[2];
  const double end = rail.center.x() + rail.length / 2;
  EXPECT_NEAR(end, sleeve.center.x() + sleeve.length / 2, 1e-14);
  EXPECT_NEAR(stop.center.x() - stop.length / 2, end, 1e-14);
  EXPECT_GT(stop.radius, sleeve.radius);
}

TEST(DrawList, WeldIsABead) {
  Scene scene = emptyScene();
  addBody(scene, Box{{0.4, 0.1, 0.4}}, {Quat::Identity(), {0, 1, 0}});
  scene.welds.push_back({"", "", {0, {0.2, 0, 0}}, {kWorld, {0.2, 1, 0}}});
  const DrawList list = listOf(scene, startFrame(scene));
  ASSERT_EQ(list.spheres.size(), 1u);
  EXPECT_TRUE(list.cylinders.empty());
  EXPECT_NEAR((list.spheres[0].center - Vec3(0.2, 1, 0)).norm(), 0, 1e-14);
}

TEST(DrawList, WheelsDoNotDecideHowThickTheSpringsOfACartAre) {
  const auto coilRadius = [](double wheelThickness) {
    Scene scene = emptyScene();
    addBody(scene, Box{{0.4, 0.2, 0.4}}, {});
    scene.springs.push_back({"", "", {0, {0, 0.1, 0}}, {kWorld, {0, 1, 0}}, 100, 0, 0.9});
    for (int i = 0; i < 2; ++i) {
      addBody(scene, Box{{wheelThickness, 0.2, 0.2}}, {Quat::Identity(), {i - 0.5, 0, 0}});
      scene.hinges.push_back({"", "", {i + 1, {0, 0, 0}}, {0, {i - 0.5, 0, 0}}, Vec3::UnitX()});
    }
    return listOf(scene, startFrame(scene)).tubes.at(0).coilRadius;
  };
  EXPECT_NEAR(coilRadius(0.02) / coilRadius(0.04), 1, 0.02);  // the view is a little wider
}

TEST(DrawList, BoundsOfACylinderAreTight) {
  // Axis (3, 4, 0) / 5: half length 2 along it, discs of radius 1 across.
  const CylinderItem item{{1, 1, 1}, {0.6, 0.8, 0}, 1, 4};
  EXPECT_NEAR((item.bounds().max() - Vec3(1 + 1.2 + 0.8, 1 + 1.6 + 0.6, 2)).norm(), 0, 1e-14);
}

TEST(DrawList, BallsNearABallAreTheClosestOthers) {
  Scene scene = emptyScene();
  for (int i = 0; i < 9; ++i) addBody(scene, Sphere{0.5}, {Quat::Identity(), {0.9 * i, 0, 0}});
  const DrawList list = listOf(scene, startFrame(scene));
  const SphereItem& middle = list.spheres.at(4);
  std::vector<int> near(list.nearOccluders.begin() + middle.firstNearOccluder,
                        list.nearOccluders.begin() + middle.firstNearOccluder + middle.nearOccluders);
  EXPECT_EQ(near, (std::vector<int>{3, 5, 2, 6}));
}

// Balls that lie on a board touch it but for rounding, which differs from frame to frame.
TEST(DrawList, RoundingDoesNotChooseWhichBallsABoardMirrors) {
  Scene scene = emptyScene();
  addBody(scene, Box{{20, 0.2, 20}}, {});
  for (int i = 0; i < 9; ++i)
    addBody(scene, Sphere{0.5}, {Quat::Identity(), {2.0 * i - 8, 0.6 + 1e-12 * (i * 5 % 9), 0}});
  const DrawList list = listOf(scene, startFrame(scene));
  for (int i = 0; i < 6; ++i) {
    const auto place = static_cast<std::size_t>(list.meshes.at(0).firstNearOccluder + i);
    EXPECT_EQ(list.nearOccluders.at(place), 1 + i);
  }
}

TEST(DrawList, BoxBesideABallIsItsNeighbourToItsReach) {
  // Half edges 0.1, 0.3, 0.5: the box counts 1.6 times the middle one beyond its faces.
  for (const auto& [gap, count] : {std::pair(0.47, 1), std::pair(0.49, 0)}) {
    Scene scene = emptyScene();
    addBody(scene, Box{{0.2, 0.6, 1}}, {});
    addBody(scene, Sphere{0.05}, {Quat::Identity(), {0.1 + gap + 0.05, 0, 0}});
    EXPECT_EQ(listOf(scene, startFrame(scene)).spheres.at(0).nearOccluders, count) << gap;
  }
}

TEST(Appearance, ColoursOfAModelAreTheFilesUnlessTheSceneSaysOtherwise) {
  Scene scene = emptyScene();
  Model model;
  model.drawn = tessellate(Box{{1, 1, 1}});
  model.drawn.materials = {{"red", {1, 0, 0}, 0, 4}, {"blue", {0, 0, 1}, 4, 8}};
  scene.models.push_back(model);
  addBody(scene, ModelShape{0}, {});
  const View view = viewOfStart(scene, 640, 360);
  const BodyAppearance fromFile = makeAppearance(scene, view, 100).bodies.at(0);
  ASSERT_EQ(fromFile.parts.size(), 2u);
  EXPECT_EQ(fromFile.parts[0].surface.color, Vec3f(1, 0, 0));
  EXPECT_EQ(fromFile.parts[1].firstTriangle, 4u);
  EXPECT_EQ(fromFile.parts[1].triangleCount, 8u);

  scene.materials[0].baseColor = Vec3f(0, 1, 0);
  const BodyAppearance fromScene = makeAppearance(scene, view, 100).bodies.at(0);
  ASSERT_EQ(fromScene.parts.size(), 1u);
  EXPECT_EQ(fromScene.parts[0].surface.color, Vec3f(0, 1, 0));
  EXPECT_EQ(fromScene.parts[0].triangleCount, 12u);
}

TEST(Appearance, UnnamedColourIsTheGreyOfTheSceneFormat) {
  // #b0b0b0 is 0.434 of white.
  Scene scene = emptyScene();
  addBody(scene, Sphere{1}, {});
  const Surface surface = makeAppearance(scene, viewOfStart(scene, 64, 64), 100).bodies.at(0).surface;
  EXPECT_NEAR(surface.color.x(), 0.434, 0.001);
}

TEST(Appearance, SquaresOfTheGroundArePowersOfTenInProportion) {
  for (const auto& [radius, square] :
       {std::pair(0.025, 0.01), std::pair(0.4, 0.1), std::pair(1.0, 1.0), std::pair(30.0, 10.0)}) {
    Scene scene = emptyScene();
    addBody(scene, Plane{}, {}, Motion::fixed);
    addBody(scene, Sphere{radius}, {});
    const auto ground = makeAppearance(scene, viewOfStart(scene, 64, 64), 100).ground;
    ASSERT_TRUE(ground);
    EXPECT_DOUBLE_EQ(ground->squareSize, square) << radius;
  }
}

}  // namespace
}  // namespace cradle
