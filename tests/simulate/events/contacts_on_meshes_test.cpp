#include "simulate/events/contacts_on_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/root_bracketing.h"
#include "dynamics/integrators/rk4.h"
#include "experiments/ridged_ground.h"
#include "simulate/one_island.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {
namespace {

// m, and of a step: roots are found to 1e-12 of it, and lengths below 3 m are rounded less.
constexpr double kBorderError = 3e-12;

/// The scene of bodies over ground that is flat at y = 0 from x = -2 to 0, and falls by 1 in 2 from there to x = 2,
/// where a slope begins that makes it no hull.
Scene sceneOverCrease(const std::string& bodies) {
  const LoadedModel ground = ridgedGround({{-2, 0}, {0, 0}, {2, -1}, {3, 1}}, false);
  return parseScene(R"({"schema": "cradle-scene/1", "name": "crease", "duration": 1, "gravity": [0, 0, 0], "bodies": [
      {"name": "ground", "shape": {"mesh": "ground.obj"}, "collision": "mesh", "motion": "static"}, )" +
                        bodies + "]}",
                    "crease.json", [&](const MeshReference&) { return ground; })
      .scene;
}

std::string sphereOverCrease(const std::string& name, const Vec3& position, const Vec3& velocity) {
  return fmt::format(
      R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "position": {}, "linearVelocity": {}}})", name,
      vectorText(position), vectorText(velocity));
}

struct OverCrease : OneIsland {
  explicit OverCrease(const std::string& bodies) : OneIsland(sceneOverCrease(bodies)) {
    for (const Contact& contact : contactsWithin(1e-6))
      records.push_back({contact, island.assembly.geometry.pairs[contact.pair]});
  }
  std::optional<FeatureChange> changeWithin(double duration) {
    rk4(island.rightHandSide, state(), 0, duration, island.step);
    prepareInterpolant(island.rightHandSide, island.step);
    return firstFeatureChange(records, island);
  }
  /// m: a border is as wide as rounding, and belongs to the region.
  double width() const {
    return borderWidth(*sphereOverMesh(island.assembly.geometry, records.at(0).pair, island.state).mesh);
  }
  /// m: without that.
  double inside(const Vec3& center) {
    VectorX moved = state();
    centerOfMass(moved, 0) = center;
    return insideVoronoiRegion(records[0].contact, sphereOverMesh(island.assembly.geometry, records[0].pair, moved)) -
           width();
  }
  bool isServed(double touchTolerance) {
    findBodyFrames(mechanism().bodies, state(), frames);
    return isServedOnMesh(records.at(0), touchTolerance, frames, island);
  }

  std::vector<ContactRecord> records;
  std::vector<BodyFrame> frames;
};

// Over a flat face the region ends where the face does: at x = 0 on one side, where another face begins in a plane of
// its own, and at z = -2 on another.
TEST(VoronoiRegion, OfAFaceEndsOverItsBorder) {
  OverCrease at(sphereOverCrease("s", Vec3(-0.3, 0.1, 0.5), Vec3::Zero()));
  ASSERT_EQ(at.records.size(), 1u);
  EXPECT_NEAR(at.inside(Vec3(-0.3, 0.1, 0.5)), 0.3, kBorderError);
  EXPECT_NEAR(at.inside(Vec3(-0.3, 0.7, 0.5)), 0.3, kBorderError);
  EXPECT_NEAR(at.inside(Vec3(0.2, 0.1, 0.5)), -0.2, kBorderError);
  EXPECT_NEAR(at.inside(Vec3(-0.5, 0.1, -1.75)), 0.25, kBorderError);
}

// Over the crease it is the wedge between the normals of its faces: a sphere at an angle a from the first normal is
// r sin a inside of its plane.
TEST(VoronoiRegion, OfAnEdgeIsBetweenTheNormalsOfItsFaces) {
  const double wedge = std::atan(0.5);
  const auto over = [](double angle) { return Vec3(0.1 * std::sin(angle), 0.1 * std::cos(angle), 0.5); };
  OverCrease at(sphereOverCrease("s", over(wedge / 2), Vec3::Zero()));
  ASSERT_EQ(at.records.size(), 1u);
  for (const double angle : {0.1 * wedge, 0.4 * wedge}) {
    EXPECT_NEAR(at.inside(over(angle)), 0.1 * std::sin(angle), kBorderError);
    EXPECT_NEAR(at.inside(over(wedge - angle)), 0.1 * std::sin(angle), kBorderError);
    EXPECT_NEAR(at.inside(over(-angle)), -0.1 * std::sin(angle), kBorderError);
  }
}

// The second sphere comes to the crease after 0.2 s, the first one after 0.3 s, the third one after 0.45 s; a step that
// is shorter has no change.
TEST(FeatureChange, IsTheFirstSphereThatLeavesItsFace) {
  OverCrease at(sphereOverCrease("slow", Vec3(-0.3, 0.1, 0), Vec3(1, 0, 0)) + ", " +
                sphereOverCrease("fast", Vec3(-0.4, 0.1, 1), Vec3(2, 0, 0.5)) + ", " +
                sphereOverCrease("last", Vec3(-0.45, 0.1, -1), Vec3(1, 0, 0)));
  ASSERT_EQ(at.records.size(), 3u);
  const std::optional<FeatureChange> first = at.changeWithin(0.5);
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->fraction, (0.4 + at.width()) / 2 / 0.5, kBorderError);
  EXPECT_EQ(at.records[first->record].contact.movingBody(), 1);
  at.records.erase(at.records.begin() + static_cast<std::ptrdiff_t>(first->record));
  EXPECT_NEAR(at.changeWithin(0.5)->fraction, (0.3 + at.width()) / 0.5, kBorderError);
  EXPECT_FALSE(at.changeWithin(0.29));
}

// At 1 m/s across a crease whose wedge is 0.1 m / 2 wide at this height, a sphere in its middle leaves it half of that
// later, though a long step leads far beyond. It goes through the border at an angle, of cosine 2 / sqrt(5).
TEST(FeatureChange, IsFoundInANarrowRegionOfALongStep) {
  OverCrease at(sphereOverCrease("s", Vec3(0.025, 0.1, 0), Vec3(1, 0, 0)));
  at.records.clear();
  for (const Contact& contact : at.contactsWithin(0.01))
    at.records.push_back({contact, at.island.assembly.geometry.pairs[contact.pair]});
  ASSERT_EQ(at.records.size(), 1u);
  const std::optional<FeatureChange> first = at.changeWithin(1);
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->fraction, 0.025 + at.width() * std::sqrt(5) / 2, kBorderError);
}

// A sphere that turns back at the crease is beyond its border around a third of the step, by d - a (f - 1/3)^2 with
// a = 1.25 m: as long as twice sqrt(d / a). What lasts less than the shortest interval that is searched is passed over:
// a sphere that rolls along a border would be looked for at a million places of it.
TEST(FeatureChange, IsPassedOverWhereTheRegionIsLeftForLessThanTheShortestInterval) {
  for (const double half : {8 * kFinestBlindApproach, kFinestBlindApproach / 8}) {
    OverCrease at(sphereOverCrease("s", Vec3(-1.25 / 9, 0.1, 0.5), Vec3(2.5 / 1.5, 0, 0)));
    ASSERT_EQ(at.records.size(), 1u);
    at.mechanism().gravity = Vec3(-10, 0, 0);
    centerOfMass(at.state(), 0).x() += at.width() + 1.25 * half * half;
    const std::optional<FeatureChange> first = at.changeWithin(0.5);
    ASSERT_EQ(first.has_value(), half > kFinestBlindApproach);
    if (!first) continue;
    EXPECT_NEAR(first->fraction, 1.0 / 3 - half, 1e-9);  // the slope there is 2.5 m times half, lengths are rounded
  }
}

// A sphere on another side of the border than its contact changes at once.
TEST(FeatureChange, IsNowBeyondTheBorder) {
  OverCrease at(sphereOverCrease("s", Vec3(-0.3, 0.1, 0), Vec3(1, 0, 0)));
  centerOfMass(at.state(), 0).x() = 1e-6;
  const std::optional<FeatureChange> first = at.changeWithin(0.1);
  ASSERT_TRUE(first);
  EXPECT_LT(first->fraction, 1e-9);
}

std::string bodyOverCrease(const std::string& shape, const Vec3& position) {
  return fmt::format(R"({{"name": "b", "shape": {}, "position": {}}})", shape, vectorText(position));
}

// The sphere around a box of 0.2 m has a radius of 0.1 sqrt(3) m: its room ends where its centre is as far from the
// crease.
TEST(RowsOnMeshes, ServeABoxThatIsOverOneFace) {
  const std::string box = R"({"box": {"size": [0.2, 0.2, 0.2]}})";
  const double radius = 0.1 * std::sqrt(3.0);
  EXPECT_TRUE(OverCrease(bodyOverCrease(box, Vec3(-radius - 0.011, 0.1, 0))).isServed(0.01));
  EXPECT_FALSE(OverCrease(bodyOverCrease(box, Vec3(-radius - 0.009, 0.1, 0))).isServed(0.01));
  EXPECT_FALSE(OverCrease(bodyOverCrease(box, Vec3(0, 0.1, 0))).isServed(1e-9));
}

// Spheres have rows of their own on edges, and cylinders are watched by other functions.
TEST(RowsOnMeshes, ServeSpheresAndCylindersEverywhere) {
  for (const double x : {-1.0, 0.0}) {
    OverCrease sphere(bodyOverCrease(R"({"sphere": {"radius": 0.1}})", Vec3(x, 0.1, 0)));
    OverCrease cylinder(bodyOverCrease(R"({"cylinder": {"radius": 0.1, "length": 0.2}})", Vec3(x, 0.1, 0)));
    EXPECT_TRUE(sphere.isServed(1e-9));
    EXPECT_TRUE(cylinder.isServed(1e-9));
  }
}

}  // namespace
}  // namespace cradle
