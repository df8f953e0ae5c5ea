#include "mesh/fill_holes.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "mesh/mass_properties.h"
#include "mesh/primitives.h"
#include "mesh/solid.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A sphere of 1 m, drawn and solid, without the triangles that `isLeftOut` names by their middle.
LoadedModel ballWithout(const std::function<bool(const Vec3& middle)>& isLeftOut) {
  LoadedModel loaded;
  DrawnMesh& drawn = loaded.model.drawn;
  const DrawnMesh whole = tessellate(Capsule{1, 1e-3}, 256);
  for (const Triangle& triangle : whole.triangles) {
    Vec3 middle = Vec3::Zero();
    for (const std::uint32_t corner : triangle) middle += whole.vertices[corner] / 3;
    if (isLeftOut(middle)) continue;
    const auto first = static_cast<std::uint32_t>(drawn.vertices.size());
    for (const std::uint32_t corner : triangle) {
      drawn.vertices.push_back(whole.vertices[corner]);
      drawn.normals.push_back(whole.normals[corner]);
    }
    drawn.triangles.push_back({first, first + 1, first + 2});
  }
  drawn.materials = {{"m", Vec3f::Zero(), 0, static_cast<std::uint32_t>(drawn.triangles.size())}};
  loaded.model.solid = weld(drawn.vertices, drawn.triangles);
  return loaded;
}

bool isNear(const Vec3& middle, const Vec3& place, double radius) {
  return (middle - place.normalized()).norm() < radius;
}

// Holes of at most 0.06 m radius around three places: caps of pi r^2 h / 2 are cut off, h = r^2 / 2.
TEST(FillHoles, SmallOnesAreFilledInSolidAndDrawnMesh) {
  const std::vector<Vec3> places = {{0, 1, 0}, {1, 0.2, 0.3}, {-1, -1, 1}};
  LoadedModel loaded = ballWithout([&](const Vec3& middle) {
    return std::any_of(places.begin(), places.end(), [&](const Vec3& place) { return isNear(middle, place, 0.03); });
  });
  EXPECT_FALSE(checkSolid(loaded.model.solid).isClosed);
  fillHoles(loaded);
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid);
  EXPECT_THAT(loaded.notes, ElementsAre(HasSubstr("3 holes filled, the largest 0.")));
  const double whole = signedVolume(ballWithout([](const Vec3&) { return false; }).model.solid);
  EXPECT_NEAR(signedVolume(loaded.model.solid), whole, 3 * M_PI * std::pow(0.06, 4) / 4);
  EXPECT_LT(signedVolume(loaded.model.solid), whole);
  // What a trajectory keeps is drawn, and must be closed, too.
  const DrawnMesh& drawn = loaded.model.drawn;
  EXPECT_TRUE(checkSolid(weld(drawn.vertices, drawn.triangles)).isSolid);
  EXPECT_EQ(drawn.materials.back().triangleCount, drawn.triangles.size());
  ASSERT_EQ(drawn.triangles.size(), loaded.model.solid.triangles.size());
  EXPECT_GT(drawn.normals.back().dot(drawn.vertices.back().cast<float>()), 0.9f);  // outwards
}

TEST(FillHoles, OneTriangleIsEnough) {
  LoadedModel loaded = ballWithout([isFirst = true](const Vec3&) mutable { return std::exchange(isFirst, false); });
  fillHoles(loaded);
  EXPECT_TRUE(checkSolid(loaded.model.solid).isSolid);
  EXPECT_THAT(loaded.notes, ElementsAre(HasSubstr("1 hole filled")));
}

TEST(FillHoles, WhatIsOpenOtherwiseIsLeftAsItIs) {
  const auto expectLeft = [](LoadedModel loaded) {
    const std::size_t before = loaded.model.solid.triangles.size();
    fillHoles(loaded);
    EXPECT_EQ(loaded.model.solid.triangles.size(), before);
    EXPECT_EQ(loaded.model.drawn.triangles.size(), before);
    EXPECT_THAT(loaded.notes, IsEmpty());
  };
  expectLeft(ballWithout([](const Vec3&) { return false; }));
  expectLeft(ballWithout([](const Vec3& middle) { return middle.y() > 0.5; }));  // a bowl
  expectLeft(ballWithout([](const Vec3& middle) {                                // a bowl with a hole
    return middle.y() > 0.5 || isNear(middle, Vec3(1, -0.2, 0), 0.06);
  }));
  LoadedModel doubled = ballWithout([](const Vec3& middle) { return isNear(middle, Vec3(1, 0, 0), 0.06); });
  doubled.model.solid.triangles.push_back(doubled.model.solid.triangles[5]);  // an edge of three triangles
  doubled.model.drawn.triangles.push_back(doubled.model.drawn.triangles[5]);
  expectLeft(doubled);
}

}  // namespace
}  // namespace cradle
