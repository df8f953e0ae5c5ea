// The models of assets/ against closed forms, which the program that wrote the files does not use.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "mesh/mass_properties.h"
#include "mesh/recognise_shape.h"
#include "mesh/solid.h"
#include "test_files.h"

namespace cradle {
namespace {

using std::numbers::pi;

// Coordinates are floats: each is off by up to 6e-8 of the size, a volume by three times that.
constexpr double kFloat = 2e-7;

double polygonArea(double corners, double radius) {
  return corners / 2 * radius * radius * std::sin(2 * pi / corners);
}

LoadedModel loadAsset(const std::string& name, const std::string& shape) {
  const std::string path = asset(name);
  LoadedModel loaded = loadModel({path, "", 1});
  EXPECT_LT(std::filesystem::file_size(path), 1U << 20) << name;
  EXPECT_TRUE(loaded.notes.empty()) << name;
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid) << name;
  EXPECT_EQ(shapeName(recogniseShape(loaded.model.solid)), shape) << name;
  EXPECT_NE(loaded.model.drawn.materials.at(0).baseColor, ModelMaterial{}.baseColor) << name;
  return loaded;
}

void expectVolume(const LoadedModel& loaded, double expected, double tolerance) {
  EXPECT_NEAR(signedVolume(loaded.model.solid), expected, tolerance * expected) << loaded.model.name;
}

TEST(Assets, BallHasRadiusOneToTheLastBit) {
  const LoadedModel ball = loadAsset("ball.3ds", "sphere");
  EXPECT_GE(ball.model.solid.triangles.size(), 2000U);
  EXPECT_EQ(ball.model.drawn.vertices.size(), ball.model.solid.vertices.size());  // smooth everywhere
  const LoadedModel small = loadModel({asset("ball.3ds"), "", 0.025});
  const PlacedPrimitive sphere = *recogniseShape(small.model.solid).primitive;
  EXPECT_EQ(std::get<Sphere>(sphere.shape).radius, 0.025);
  EXPECT_EQ(sphere.bodyFromShape.translation, Vec3(0, 0, 0));
  // 3200 triangles of equal area would have edges of a = 0.095, and lose about a^2 / 3 of the volume.
  EXPECT_LT(signedVolume(ball.model.solid), 4.0 / 3 * pi);
  EXPECT_GT(signedVolume(ball.model.solid), 4.0 / 3 * pi * (1 - 0.095 * 0.095));
}

TEST(Assets, BoxIsExact) {
  const LoadedModel box = loadAsset("box.3ds", "box");
  EXPECT_EQ(std::get<Box>(recogniseShape(box.model.solid).primitive->shape).size, Vec3(0.5, 0.25, 0.125));
  expectVolume(box, 0.015625, 1e-15);
  EXPECT_EQ(box.model.drawn.vertices.size(), 24U);  // sharp edges
}

// A pyramid over a polygon of 24 corners, a third of its prism; its centre of mass is a quarter of the height up.
TEST(Assets, ConeHasItsClosedForm) {
  const LoadedModel cone = loadAsset("cone.3ds", "convex");
  expectVolume(cone, polygonArea(24, 0.15) * 0.3 / 3, 3 * kFloat);
  const MassProperties properties = computeMassProperties(cone.model.solid, 1);
  EXPECT_LT((properties.centerOfMass - Vec3(0, 0.075, 0)).norm(), kFloat);
}

TEST(Assets, LPrismHasItsClosedForm) {
  const LoadedModel prism = loadAsset("l_prism.3ds", "mesh");
  expectVolume(prism, 0.004, kFloat);
  const MassProperties found = computeMassProperties(prism.model.solid, 1000);
  EXPECT_LE((found.centerOfMass - Vec3(0.125, 0.075, 0.05)).norm(), kFloat);
  // The integer L prism (mass 4; 17/12, 41/12, 25/6; xy 3/4) in units of 0.1 m, at 1000 kg/m^3.
  Mat3 expected;
  expected << 17.0 / 12, 0.75, 0, 0.75, 41.0 / 12, 0, 0, 0, 25.0 / 6;
  EXPECT_LE((found.inertiaTensor - 0.01 * expected).norm(), 5 * kFloat * 0.01 * expected.trace());
  EXPECT_EQ(prism.model.drawn.vertices.size(), 36U);  // 6 + 6 + 6 x 4 corners with sharp edges
}

TEST(Assets, TorusHasTheVolumeOfItsFacets) {
  // 64 wedges between planes 2 pi / 64 apart: each has the volume sin(2 pi / 64) R A.
  expectVolume(loadAsset("torus.3ds", "mesh"), 64 * std::sin(2 * pi / 64) * 0.12 * polygonArea(32, 0.045), kFloat);
}

TEST(Assets, RingHasTheVolumeOfItsFacets) {
  expectVolume(loadAsset("ring.3ds", "mesh"), 96 * std::sin(2 * pi / 96) * 0.5 * polygonArea(20, 0.025), kFloat);
}

TEST(Assets, TorusKnotHasTheVolumeOfATube) {
  const LoadedModel knot = loadAsset("torus_knot.3ds", "mesh");
  // Length of the curve by the trapezoidal rule, exact to rounding for a periodic function.
  double length = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 2 * pi * i / kSteps;
    length += std::hypot(2 * (0.105 + 0.05 * std::cos(3 * t)), 3 * 0.05) * 2 * pi / kSteps;
  }
  // From one of the 240 sections to the next the polygon turns about the curve by up to d = 3 (2 pi / 240), so that its
  // sides, of angle a = 2 pi / 20, sweep twisted quads. Cut along a diagonal each is off by s^2 d h / 12 (half of the
  // tetrahedron of its corners; s = a r), together by a d / 6 of the volume. Bends cost a tenth of that.
  expectVolume(knot, polygonArea(20, 0.024) * length, 1.1 * (2 * pi / 20) * (6 * pi / 240) / 6);
  EXPECT_EQ(knot.model.drawn.vertices.size(), knot.model.solid.vertices.size());
}

TEST(Assets, GearHasTheVolumeOfItsOutline) {
  // Corners at 0.05, 0.2, 0.4 and 0.55 of a tooth of 30 degrees, on radii 0.12, 0.15, 0.15, 0.12; 48-sided hole.
  const double tooth = pi / 6;
  const double sector = 0.12 * 0.15 * std::sin(0.15 * tooth) + 0.15 * 0.15 * std::sin(0.2 * tooth) / 2 +
                        0.12 * 0.12 * std::sin(0.5 * tooth) / 2;
  expectVolume(loadAsset("gear.3ds", "mesh"), 0.04 * (12 * sector - polygonArea(48, 0.05)), 2 * kFloat);
}

TEST(Assets, THandleHasTheVolumeOfTwoJoinedCylinders) {
  // The stem begins on the bar: its length below the top is 0.09 - sqrt(r1^2 - z^2), here by the midpoint rule.
  const double bar = 0.015, stem = 0.012;
  double stemVolume = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = pi * (i + 0.5) / kSteps, z = stem * std::cos(angle);
    stemVolume += 2 * std::pow(stem * std::sin(angle), 2) * (0.09 - std::sqrt(bar * bar - z * z)) * pi / kSteps;
  }
  const double exact = pi * bar * bar * 0.16 + stemVolume;
  const LoadedModel handle = loadAsset("t_handle.3ds", "mesh");
  // Facets of a = 2 pi / 48 around the bar and up to 2 pi / 36 around the stem lose up to a^2 / 6.
  const double volume = signedVolume(handle.model.solid);
  EXPECT_LT(volume, exact);
  EXPECT_GT(volume, exact * (1 - std::pow(2 * pi / 36, 2) / 6));
  // Symmetric about two planes: the principal axes are those of the frame, all three moments differ.
  const MassProperties found = computeMassProperties(handle.model.solid, 1);
  EXPECT_NEAR(found.centerOfMass.x(), 0, kFloat * 0.16);
  EXPECT_NEAR(found.centerOfMass.z(), 0, kFloat * 0.16);
  const Vec3 moments = found.inertiaTensor.diagonal();
  EXPECT_LT(moments.x(), 0.9 * moments.y());
  EXPECT_LT(moments.y(), 0.9 * moments.z());
}

TEST(Assets, CradleFrameIsThreeSolids) {
  const auto objects = loadObjects(asset("cradle_frame.3ds"), 1);
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[0].model.name, "RailFront");
  EXPECT_EQ(objects[1].model.name, "RailBack");
  EXPECT_EQ(objects[2].model.name, "Board");
  for (const LoadedModel& object : objects) EXPECT_TRUE(checkSolid(object.model.solid).isSolid) << object.model.name;

  // Straight parts, two bends of twelve wedges (as in a torus), and two feet that narrow from 12 to 5 mm.
  const double area = polygonArea(24, 0.005), foot = polygonArea(24, 0.012);
  const double straight = 2 * (0.29 - 0.028) + 0.30, bends = 2 * 12 * std::sin(pi / 24) * 0.03;
  const double feet = 2 * 0.008 / 3 * (area + foot + std::sqrt(area * foot));
  expectVolume(objects[0], area * (straight + bends) + feet, 20 * kFloat);  // thin: floats of 0.3 m, radius 0.005 m
  const double base = 0.44 * 0.24, top = 0.432 * 0.232, middle = 0.436 * 0.236;
  expectVolume(objects[2], base * 0.016 + 0.004 / 6 * (base + 4 * middle + top), 2 * kFloat);

  loadAsset("cradle_frame.3ds", "mesh");
}

TEST(Assets, RailsLieWhereBallsHangFrom) {
  for (const auto& [name, z] : {std::pair{"RailFront", 0.08}, {"RailBack", -0.08}}) {
    const LoadedModel rail = loadModel({asset("cradle_frame.3ds"), name, 1});
    Bounds bounds;
    for (const Vec3& vertex : rail.model.solid.vertices) {
      if (std::abs(vertex.x()) > 0.151 || vertex.y() < 0.3) continue;  // the rail between its bends
      bounds.extend(vertex);
      EXPECT_NEAR(std::hypot(vertex.y() - 0.32, vertex.z() - z), 0.005, 1e-7);
    }
    EXPECT_NEAR(bounds.sizes().x(), 0.30, 1e-7);
  }
}

}  // namespace
}  // namespace cradle
