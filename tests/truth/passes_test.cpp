#include "truth/passes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "math/rotation.h"
#include "render/camera.h"
#include "truth/truth_scene.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kSingle = 1e-4;  // pixels: single precision of some tens of them

std::size_t pixelAt(const TruthScene& truth, int column, int row) {
  return static_cast<std::size_t>(row * truth.width + column);
}

Eigen::Vector2d shiftOf(const Flow& flow, std::size_t pixel) {
  return Eigen::Vector2f(flow.shift[2 * pixel], flow.shift[2 * pixel + 1]).cast<double>();
}

TEST(Passes, AreNamedWithCommas) {
  EXPECT_THAT(parsePasses("depth"), ElementsAre(Pass::depth));
  EXPECT_THAT(parsePasses("flow,rgb,flow"), ElementsAre(Pass::flow, Pass::rgb));
  EXPECT_EQ(parsePasses("all").size(), 7U);
  for (const char* text : {"", "depth,", "Depth", "depth normal"}) {
    try {
      parsePasses(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_THAT(error.what(), HasSubstr("objectCoordinates"));
    }
  }
}

TEST(Passes, SegmentationTellsBodiesLinksAndSky) {
  TruthScene truth(61, 61);
  addBody(truth.scene, Sphere{0.3}, {Quat::Identity(), {0, -1, 0}});
  addBody(truth.scene, Box{{0.5, 0.5, 0.5}}, {Quat::Identity(), {1, 1, 0}}, Motion::fixed);
  truth.scene.rods.push_back({"rod", "", {0, Vec3::Zero()}, {kWorld, {0, 1, 0}}, 2});
  truth.camera = cameraAt({0, 0, 6}, {0, 0, 0}, 0.6);
  const auto ids = segmentationPass(truth.first());
  const auto idAt = [&](const Vec3& point) {
    const Eigen::Vector2d place = projectToPixel(truth.camera, point, truth.width, truth.height);
    return ids[pixelAt(truth, static_cast<int>(place.x()), static_cast<int>(place.y()))];
  };
  EXPECT_EQ(idAt({0, -1, 0.3}), 1);
  EXPECT_EQ(idAt({1, 1, 0.25}), 2);
  EXPECT_EQ(idAt({0, 0.2, 0}), kFirstLinkId + static_cast<int>(LinkKind::rod));
  EXPECT_EQ(idAt({-1, 1, 0}), 0);
}

/// A box that goes and turns as (offset, turn) say, seen by a camera that goes too.
struct MovedBox {
  explicit MovedBox(const Vec3& offset, const Quat& turn, const Camera& second) : truth(120, 90), camera(second) {
    place = {rotationAbout(Vec3(1, 2, 0.5).normalized(), 0.7), {0.1, 0, 0}};
    addBody(truth.scene, Box{{1, 0.8, 0.6}}, place);
    truth.camera = cameraAt({0.5, 0.7, 3}, {0, 0, 0}, 0.8);
    frame = startFrame(truth.scene);
    frame.states[0].position += offset;
    frame.states[0].orientation = turn * place.rotation;
    moved = {frame.states[0].orientation, frame.states[0].position};
  }
  TruthScene truth;
  Camera camera;
  RigidTransform place, moved;
  Frame frame;
};

TEST(Passes, ObjectCoordinatesLieOnTheBodyAndFlowFollowsThem) {
  MovedBox box({0.05, -0.02, 0.1}, rotationAbout(Vec3(0, 1, 1).normalized(), 0.1),
               cameraAt({0.6, 0.7, 2.9}, {0.02, 0, 0}, 0.75));
  const auto coordinates = objectCoordinatesPass(box.truth.first());
  const auto depth = depthPass(box.truth.first());
  const Flow flow = flowPass(box.truth.first(), box.truth.second(box.frame, box.camera), true);
  int seen = 0;
  for (int row = 0; row < box.truth.height; ++row)
    for (int column = 0; column < box.truth.width; ++column) {
      const std::size_t pixel = pixelAt(box.truth, column, row);
      const Vec3 local(coordinates[3 * pixel], coordinates[3 * pixel + 1], coordinates[3 * pixel + 2]);
      ASSERT_EQ(std::isnan(local.x()), std::isinf(depth[pixel]));
      if (std::isnan(local.x())) continue;
      ++seen;
      EXPECT_NEAR((local.cwiseAbs() - Vec3(0.5, 0.4, 0.3)).maxCoeff(), 0, 1e-6);
      const Eigen::Vector2d centre(column + 0.5, row + 0.5);
      const Vec3 start = box.place * local, end = box.moved * local;
      EXPECT_NEAR((projectToPixel(box.truth.camera, start, 120, 90) - centre).norm(), 0, kSingle);
      EXPECT_NEAR(-(cameraAxes(box.truth.camera).col(2).dot(start - box.truth.camera.position)), depth[pixel], 1e-6);
      EXPECT_NEAR((projectToPixel(box.camera, end, 120, 90) - centre - shiftOf(flow, pixel)).norm(), 0, kSingle);
    }
  EXPECT_GT(seen, 1000);
}

TEST(Passes, WhatTurnsAwayIsHidden) {
  MovedBox box({0.05, -0.02, 0.1}, rotationAbout(Vec3::UnitY(), 1.0), cameraAt({0.6, 0.7, 2.9}, {0.02, 0, 0}, 0.75));
  FrameRays& second = box.truth.second(box.frame, box.camera);
  const Flow flow = flowPass(box.truth.first(), second, true);
  const auto coordinates = objectCoordinatesPass(box.truth.first());
  int hidden = 0;
  for (int row = 0; row < box.truth.height; ++row)
    for (int column = 0; column < box.truth.width; ++column) {
      const std::size_t pixel = pixelAt(box.truth, column, row);
      if (box.truth.first().seen()[pixel].isSky()) continue;
      const Vec3 local(coordinates[3 * pixel], coordinates[3 * pixel + 1], coordinates[3 * pixel + 2]);
      // A face of a convex body is seen from where its outward normal points: an oracle without rays.
      Vec3::Index axis;
      (local.cwiseAbs() - Vec3(0.5, 0.4, 0.3)).maxCoeff(&axis);
      const Vec3 outwards = box.moved.rotation * (std::copysign(1.0, local[axis]) * Vec3::Unit(axis));
      const bool facesAway = outwards.dot(box.camera.position - box.moved * local) < 0;
      EXPECT_EQ(flow.isHidden[pixel], facesAway) << column << " " << row;
      hidden += facesAway;
    }
  EXPECT_GT(hidden, 50);
}

TEST(Passes, WhatPassesBeforeAWallHidesIt) {
  TruthScene truth(200, 100);
  addBody(truth.scene, Sphere{0.2}, {Quat::Identity(), {-0.5, 0, 1}});
  addBody(truth.scene, Box{{8, 8, 1}}, {Quat::Identity(), {0, 0, -0.5}}, Motion::fixed);
  truth.camera = cameraAt({0, 0, 4}, {0, 0, 0}, 0.8);
  Frame frame = startFrame(truth.scene);
  frame.states[0].position.x() = 0.5;
  const Flow flow = flowPass(truth.first(), truth.second(frame, truth.camera), true);
  const auto ids = segmentationPass(truth.first()), after = segmentationPass(truth.second(frame, truth.camera));
  for (std::size_t pixel = 0; pixel < ids.size(); ++pixel) {
    if (ids[pixel] != 2) continue;
    EXPECT_EQ(shiftOf(flow, pixel), Eigen::Vector2d(0, 0));
    EXPECT_EQ(flow.isHidden[pixel], after[pixel] == 1) << pixel;
  }
}

TEST(Passes, TheSkyMovesByTheTurnOfTheCameraAlone) {
  TruthScene truth(80, 60);
  addBody(truth.scene, Sphere{0.1}, {Quat::Identity(), {0, -50, 0}}, Motion::fixed);
  truth.camera = cameraAt({0, 0, 0}, {0, 0, -1}, 0.9);
  const double turn = 0.05;
  const Camera second = cameraAt({3, 1, 2}, Vec3(3, 1, 2) + Vec3(std::sin(turn), 0, -std::cos(turn)), 0.9);
  const Flow flow = flowPass(truth.first(), truth.second(startFrame(truth.scene), second), true);
  // Turned to the right by an angle, a direction at tan(a) of the middle row is at tan(a - turn).
  const double focal = truth.first().pinhole().intrinsics()(0, 0);
  for (int column = 0; column < truth.width; ++column) {
    const std::size_t pixel = pixelAt(truth, column, 30);
    const double across = (column + 0.5 - 40) / focal;
    EXPECT_NEAR(shiftOf(flow, pixel).x(), focal * (std::tan(std::atan(across) - turn) - across), 2e-2 * 1e-2);
    EXPECT_EQ(flow.isHidden[pixel] == 1, column + 0.5 + shiftOf(flow, pixel).x() < 0);
  }
}

TEST(Passes, FlowOfARodGoesWithItsEnds) {
  TruthScene truth(200, 150);
  addBody(truth.scene, Sphere{0.3}, {Quat::Identity(), {0, -1, 0}});
  truth.scene.rods.push_back({"rod", "", {0, Vec3::Zero()}, {kWorld, {0, 1, 0}}, 2});
  truth.camera = cameraAt({0, 0, 5}, {0, 0, 0}, 0.7);
  Frame frame = startFrame(truth.scene);
  const double angle = 0.1;
  frame.states[0].position = Vec3(2 * std::sin(angle), 1 - 2 * std::cos(angle), 0);
  FrameRays& second = truth.second(frame, truth.camera);
  const Flow flow = flowPass(truth.first(), second, false);
  const auto ids = segmentationPass(truth.first());
  int rod = 0;
  for (int row = 0; row < truth.height; ++row)
    for (int column = 0; column < truth.width; ++column) {
      const std::size_t pixel = pixelAt(truth, column, row);
      const SeenPoint& seen = truth.first().seen()[pixel];
      if (ids[pixel] != kFirstLinkId + 1) continue;
      if (!std::holds_alternative<Cylinder>(truth.first().surfaces()[static_cast<std::size_t>(seen.surface)].shape))
        continue;
      const Vec3 point = truth.first().rays().pointAt(column + 0.5, row + 0.5, seen);
      if (point.y() > 0.9) continue;  // the plate behind the rod's end
      ++rod;
      const Vec3 end = rotationAbout(Vec3::UnitZ(), angle) * (point - Vec3(0, 1, 0)) + Vec3(0, 1, 0);
      const Eigen::Vector2d there = projectToPixel(truth.camera, end, truth.width, truth.height);
      EXPECT_NEAR((there - Eigen::Vector2d(column + 0.5, row + 0.5) - shiftOf(flow, pixel)).norm(), 0, kSingle);
    }
  EXPECT_GT(rod, 30);
}

TEST(Passes, FlowOfASpringStretchesWithIt) {
  TruthScene truth(200, 150);
  addBody(truth.scene, Sphere{0.3}, {Quat::Identity(), {0, -1, 0}});
  truth.scene.springs.push_back({"", "", {0, Vec3::Zero()}, {kWorld, {0, 1, 0}}, 100, 0, 2});
  truth.camera = cameraAt({0, 0, 5}, {0, 0, 0}, 0.7);
  Frame frame = startFrame(truth.scene);
  frame.states[0].position.y() -= 0.2;
  FrameRays& second = truth.second(frame, truth.camera);
  const Flow flow = flowPass(truth.first(), second, false);
  int coil = 0;
  for (int row = 0; row < truth.height; ++row)
    for (int column = 0; column < truth.width; ++column) {
      const std::size_t pixel = pixelAt(truth, column, row);
      const SeenPoint& seen = truth.first().seen()[pixel];
      if (seen.triangle < 0) continue;
      ++coil;
      // Height over the fixed end grows by a tenth; rings lean otherwise, by less than the wire's radius.
      const double height = 1 - truth.first().rays().pointAt(column + 0.5, row + 0.5, seen).y();
      const double down = 0.1 * height * truth.first().pinhole().intrinsics()(0, 0) / seen.depth;
      EXPECT_NEAR(shiftOf(flow, pixel).y(), down, 0.8) << column << " " << row;
    }
  EXPECT_GT(coil, 100);
}

}  // namespace
}  // namespace cradle
