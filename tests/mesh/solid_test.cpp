#include "mesh/solid.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "sample_meshes.h"

namespace cradle {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(Solid, ClosedMeshesAreSolids) {
  for (const TriangleMesh& mesh : {boxMesh({1, 2, 3}), lPrismMesh(), solidOf(tessellate(Sphere{})),
                                   solidOf(tessellate(Capsule{})), prismMesh(3, 1, 1)}) {
    const SolidReport report = checkSolid(mesh);
    EXPECT_TRUE(report.isSolid);
    EXPECT_THAT(report.problems, IsEmpty());
  }
}

TEST(Solid, SizeAndPlaceDoNotMatter) {
  for (const double scale : {1e-9, 1e9})
    EXPECT_TRUE(checkSolid(moved(lPrismMesh(), [&](const Vec3& v) { return Vec3(scale * v); })).isSolid);
  EXPECT_TRUE(checkSolid(moved(lPrismMesh(), [](const Vec3& v) { return Vec3(v + Vec3(2.3e6, 0, 0)); })).isSolid);
}

TEST(Solid, MissingFaceLeavesThreeOpenEdgesAndSaysWhere) {
  TriangleMesh mesh = boxMesh({1, 2, 3});
  mesh.triangles.erase(mesh.triangles.begin());  // of the side x = -0.5
  const SolidReport report = checkSolid(mesh);
  EXPECT_FALSE(report.isSolid);
  EXPECT_THAT(report.problems,
              Contains(AllOf(HasSubstr("3 edges open"), HasSubstr("from (-0.5, -1, 1.5) to (-0.5, 1, 1.5)"))));
  for (const char* remedy : {"static", "`mass` with `inertiaTensor`", "`collision: hull`"})
    EXPECT_THAT(report.problems, Contains(HasSubstr(remedy)));
}

TEST(Solid, SinglePolygonIsOpenAndFlat) {
  const SolidReport report = checkSolid({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  EXPECT_FALSE(report.isSolid);
  EXPECT_THAT(report.problems, Contains(HasSubstr("4 edges open")));
  EXPECT_THAT(report.problems, Contains(HasSubstr("flat")));
}

TEST(Solid, TwoSidedSheetIsFlatThoughClosed) {
  // Not in a plane of the axes: the volume is rounding, not zero.
  const RigidTransform place = askew();
  TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0.3, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  const SolidReport report = checkSolid(moved(sheet, [&](const Vec3& v) { return place * v; }));
  EXPECT_FALSE(report.isSolid);
  EXPECT_THAT(report.problems, Contains(HasSubstr("flat")));
  EXPECT_THAT(report.problems, Not(Contains(HasSubstr("open"))));
}

TEST(Solid, ThinPlateIsNotFlat) {
  EXPECT_TRUE(checkSolid(boxMesh({1, 1e-6, 1})).isSolid);
}

TEST(Solid, EdgeOfFourTrianglesIsNonManifold) {
  const TriangleMesh one = boxMesh({1, 1, 1});
  const TriangleMesh other = moved(one, [](const Vec3& v) { return Vec3(v + Vec3(1, 1, 0)); });
  const TriangleMesh both = joined(one, other);
  const SolidReport report = checkSolid(weld(both.vertices, both.triangles));
  EXPECT_FALSE(report.isSolid);
  EXPECT_THAT(report.problems, Contains(AllOf(HasSubstr("1 edge non-manifold"), HasSubstr("(0.5, 0.5, -0.5)"))));
}

TEST(Solid, OneTurnedTriangleIsReported) {
  TriangleMesh mesh = boxMesh({1, 2, 3});
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  EXPECT_THAT(checkSolid(mesh).problems, Contains(HasSubstr("3 edges between triangles that face opposite sides")));
}

TEST(Solid, InsideOutIsReported) {
  EXPECT_THAT(checkSolid(insideOut(lPrismMesh())).problems, Contains(HasSubstr("inside-out")));
}

TEST(Solid, EmptyMeshIsReported) {
  EXPECT_THAT(checkSolid({}).problems, Contains(HasSubstr("no triangles")));
}

TEST(Solid, NumbersThatAreNoneAreReportedFirst) {
  TriangleMesh mesh = boxMesh({1, 2, 3});
  mesh.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(checkSolid(mesh).problems, Contains(HasSubstr("vertex 3 is not finite")));
  mesh = boxMesh({1, 2, 3});
  mesh.triangles[4][1] = 8;
  EXPECT_THAT(checkSolid(mesh).problems, Contains(HasSubstr("triangle 4 names vertex 8, but there are only 8")));
  EXPECT_THAT(checkSolid(moved(boxMesh({1, 1, 1}), [](const Vec3& v) { return Vec3(1e200 * v); })).problems,
              Contains(HasSubstr("too large")));
}

}  // namespace
}  // namespace cradle
