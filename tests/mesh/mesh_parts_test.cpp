#include "mesh/mesh_parts.h"

#include <gmock/gmock.h>

#include <cmath>

#include "mesh/mass_properties.h"
#include "mesh/part_relation.h"
#include "mesh/solid.h"
#include "sample_meshes.h"

namespace cradle {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TriangleMesh boxAt(const Vec3& center, const Vec3& size) {
  return moved(boxMesh(size), [&](const Vec3& v) { return Vec3(v + center); });
}

TriangleMesh sphereAt(const Vec3& center, double radius) {
  return moved(solidOf(tessellate(Sphere{radius})), [&](const Vec3& v) { return Vec3(v + center); });
}

TriangleMesh welded(const TriangleMesh& mesh) {
  return weld(mesh.vertices, mesh.triangles);
}

PartRelation relationOf(const TriangleMesh& a, const TriangleMesh& b) {
  const TriangleMesh both = joined(a, b);
  const std::vector<MeshPart> parts = partsOf(both);
  EXPECT_THAT(parts, SizeIs(2));
  std::size_t testsLeft = 1'000'000;
  return relate(both, parts[0], parts[1], testsLeft).relation;
}

/// The same of two parts in any place, and either way round.
void expectRelation(const TriangleMesh& a, const TriangleMesh& b, PartRelation expected) {
  const PartRelation swapped = expected == PartRelation::firstInside    ? PartRelation::secondInside
                               : expected == PartRelation::secondInside ? PartRelation::firstInside
                                                                        : expected;
  for (const RigidTransform& place : {RigidTransform{}, askew()}) {
    const auto move = [&](const Vec3& v) { return place * v; };
    EXPECT_EQ(relationOf(moved(a, move), moved(b, move)), expected);
    EXPECT_EQ(relationOf(moved(b, move), moved(a, move)), swapped);
    EXPECT_EQ(relationOf(insideOut(moved(a, move)), moved(b, move)), expected);
  }
}

TEST(PartRelation, OverlapIsFoundHoweverTheSurfacesMeet) {
  const TriangleMesh unit = boxMesh({1, 1, 1});
  expectRelation(unit, boxAt({0.7, 0.3, 0.2}, {1, 1, 1}), PartRelation::crossing);  // corner in corner
  expectRelation(unit, boxAt({0.5, 0, 0}, {1, 1, 1}), PartRelation::crossing);      // four sides flush
  expectRelation(unit, boxAt({0.999, 0, 0}, {1, 1, 1}), PartRelation::crossing);    // a thousandth deep
  expectRelation(unit, boxAt({0.999, 0.999, 0.999}, {1, 1, 1}), PartRelation::crossing);
  expectRelation(boxMesh({4, 1, 1}), boxMesh({1, 4, 0.5}), PartRelation::crossing);  // no corner inside
  expectRelation(boxMesh({4, 1, 1}), boxMesh({1, 4, 1}), PartRelation::crossing);    // the same, two sides flush
  expectRelation(unit, boxAt({0, 0.5, 0}, {0.5, 1, 0.5}), PartRelation::crossing);   // a peg in a side
  expectRelation(unit, boxAt({0, 0.25, 0}, {0.5, 1, 1}), PartRelation::crossing);    // the same, two sides flush
  expectRelation(sphereAt({0, 0, 0}, 1), sphereAt({1.9, 0.1, 0.2}, 1), PartRelation::crossing);
  expectRelation(lPrismMesh(), boxAt({0.5, 1.5, 0.5}, {0.4, 2, 0.4}), PartRelation::crossing);
}

TEST(PartRelation, TouchingIsNoOverlap) {
  const TriangleMesh unit = boxMesh({1, 1, 1});
  for (const double offset : {1.0, 1 + 3e-8, 1 - 3e-8}) {  // what single precision leaves
    expectRelation(unit, boxAt({offset, 0, 0}, {1, 1, 1}), PartRelation::apart);
    expectRelation(unit, boxAt({offset, 0.3, 0.2}, {1, 1, 1}), PartRelation::apart);
    expectRelation(unit, boxAt({offset, 0, 0}, {1, 3, 3}), PartRelation::apart);
    expectRelation(unit, boxAt({offset, offset, 0.4}, {1, 1, 1}), PartRelation::apart);  // along an edge
    expectRelation(lPrismMesh(), boxAt({1 + offset, 2 - (1 - offset), 0.5}, {2, 2, 1}),
                   PartRelation::apart);  // in its bend
  }
  expectRelation(unit, sphereAt({1, 0, 0}, 0.5), PartRelation::apart);
}

TEST(PartRelation, LinksOfAChainAndContentsOfABendAreApart) {
  expectRelation(lPrismMesh(), boxAt({2, 1.6, 0.5}, {1, 1, 0.5}), PartRelation::apart);
  // Four bars make a frame; another bar goes through it.
  const TriangleMesh through = boxMesh({0.5, 0.5, 9});
  for (const auto& [center, size] : {std::pair{Vec3(2, 0, 0), Vec3(1, 5, 1)}, {Vec3(0, 2, 0), Vec3(5, 1, 1)}})
    expectRelation(through, boxAt(center, size), PartRelation::apart);
}

TEST(PartRelation, InsideIsFoundThoughSidesTouch) {
  const TriangleMesh outer = boxMesh({2, 2, 2});
  expectRelation(boxMesh({1, 1, 1}), outer, PartRelation::firstInside);
  expectRelation(boxAt({0.5, 0, 0}, {1, 1, 1}), outer, PartRelation::firstInside);      // a side flush
  expectRelation(boxAt({0.5, 0.5, 0.5}, {1, 1, 1}), outer, PartRelation::firstInside);  // three
  expectRelation(boxMesh({1, 1, 2}), outer, PartRelation::firstInside);                 // a tunnel's ends
  expectRelation(sphereAt({0.1, 0.2, 0.3}, 0.4), outer, PartRelation::firstInside);
  // A tetrahedron on the diagonals of the sides: each of its edges lies on the box.
  const TriangleMesh tetrahedron{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                                 {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
  expectRelation(tetrahedron, outer, PartRelation::firstInside);
}

TEST(Parts, HangTogetherByEdges) {
  // Two boxes that share a corner, and a third alone.
  TriangleMesh mesh = joined(boxMesh({1, 1, 1}), boxAt({1, 1, 1}, {1, 1, 1}));
  mesh = welded(joined(mesh, boxAt({5, 0, 0}, {1, 2, 3})));
  EXPECT_THAT(mesh.vertices, SizeIs(23));
  const std::vector<MeshPart> parts = partsOf(mesh);
  ASSERT_THAT(parts, SizeIs(3));
  for (const MeshPart& part : parts) EXPECT_THAT(part.triangles, SizeIs(12));
  EXPECT_NEAR(parts[2].volume, 6, 1e-14);
  EXPECT_THAT(examineParts(mesh).insideOut, IsEmpty());
  EXPECT_TRUE(checkSolid(mesh).isSolid);
}

/// Boxes around the origin, from the outermost inwards; 1: faces outwards.
TriangleMesh nested(const std::vector<int>& ways) {
  TriangleMesh mesh;
  double size = 16;
  for (const int way : ways) {
    const TriangleMesh box = boxMesh({size, 0.9 * size, 1.1 * size});
    mesh = joined(mesh, way > 0 ? box : insideOut(box));
    size /= 2;
  }
  return mesh;
}

TEST(Parts, FaceOutwardsInwardsAndOutwardsAgain) {
  using Ways = std::vector<int>;
  struct Case {
    Ways ways;
    std::vector<std::size_t> insideOut;
    std::size_t overlaps;
  };
  for (const Case& known : std::vector<Case>{{{1}, {}, 0},
                                             {{-1}, {0}, 0},
                                             {{1, -1}, {}, 0},             // a cavity
                                             {{1, -1, 1}, {}, 0},          // an island in it
                                             {{1, -1, 1, -1}, {}, 0},      // with a cavity of its own
                                             {{1, -1, -1}, {2}, 0},        // an island inside-out
                                             {{1, -1, -1, -1}, {2}, 0},    // with a cavity
                                             {{-1, -1}, {0}, 0},           // only the outer one is wrong
                                             {{-1, 1}, {0, 1}, 0},         // all of it is inside-out
                                             {{-1, 1, -1}, {0, 1, 2}, 0},  // the same
                                             {{1, 1}, {}, 1}}) {           // volume that counts twice
    const PartReport report = examineParts(nested(known.ways));
    EXPECT_EQ(report.insideOut, known.insideOut) << testing::PrintToString(known.ways);
    EXPECT_THAT(report.overlaps, SizeIs(known.overlaps)) << testing::PrintToString(known.ways);
  }
}

TEST(Parts, AreJudgedEachByItsOwnSurroundings) {
  // Inside-out beside one that is right, both hollow; the cavities stay.
  const TriangleMesh hollow = nested({1, -1});
  const auto beside = [](const TriangleMesh& mesh) {
    return moved(mesh, [](const Vec3& v) { return Vec3(v + Vec3(40, 0, 0)); });
  };
  EXPECT_THAT(examineParts(joined(hollow, beside(nested({-1, -1})))).insideOut, ElementsAre(2));
  EXPECT_THAT(examineParts(joined(hollow, beside(insideOut(hollow)))).insideOut, ElementsAre(2, 3));
  EXPECT_THAT(examineParts(joined(hollow, beside(hollow))).insideOut, IsEmpty());
}

TEST(Parts, ManySideBySideAreSwept) {
  TriangleMesh mesh;
  for (int x = 0; x < 12; ++x)
    for (int y = 0; y < 12; ++y)
      for (int z = 0; z < 12; ++z) mesh = joined(std::move(mesh), boxAt({1.0 * x, 1.0 * y, 1.0 * z}, {0.9, 0.9, 0.9}));
  const PartReport report = examineParts(mesh);
  EXPECT_THAT(report.parts, SizeIs(1728));
  EXPECT_THAT(report.overlaps, IsEmpty());
}

TEST(Parts, ThousandsAroundEachOtherAreRefusedAndNotExaminedForHours) {
  TriangleMesh nested;
  for (int i = 1; i <= 4000; ++i) {  // 8 million pairs of 12 triangles each
    const auto first = static_cast<std::uint32_t>(nested.vertices.size());
    const TriangleMesh box = boxMesh(Vec3::Constant(i));
    nested.vertices.insert(nested.vertices.end(), box.vertices.begin(), box.vertices.end());
    for (const auto& [a, b, c] : box.triangles) nested.triangles.push_back({first + a, first + b, first + c});
  }
  const SolidReport report = checkSolid(nested);
  EXPECT_THAT(report.problems, Contains(HasSubstr("4000 parts lie around each other")));
  EXPECT_FALSE(report.isSolid);
}

TEST(Solid, OverlappingPartsAreNamedWithTheirPlace) {
  const TriangleMesh mesh = joined(boxMesh({1, 1, 1}), boxAt({0.75, 0, 0}, {1, 0.5, 0.5}));
  const SolidReport report = checkSolid(mesh);
  EXPECT_TRUE(report.isClosed);
  EXPECT_FALSE(report.isSolid);
  EXPECT_THAT(report.problems, Contains(testing::AllOf(HasSubstr("part 1 of 2 (12 triangles around (0, 0, 0))"),
                                                       HasSubstr("part 2 of 2 (12 triangles around (0.75, 0, 0))"),
                                                       HasSubstr("overlap at (0.5, 0, 0)"))));
}

TEST(Solid, PartsThatCancelEachOtherAreNotCalledFlat) {
  const SolidReport report = checkSolid(joined(boxMesh({1, 1, 1}), insideOut(boxAt({3, 0, 0}, {1, 1, 1}))));
  EXPECT_FALSE(report.isClosed);
  EXPECT_THAT(report.problems, Contains(HasSubstr("part 2 of 2 (12 triangles around (3, 0, 0)) is inside-out")));
  EXPECT_THAT(report.problems, testing::Not(Contains(HasSubstr("flat"))));
}

TEST(PartRelation, IsUnknownWhereItWouldTakeTooLong) {
  const TriangleMesh both = joined(boxMesh({4, 1, 1}), boxMesh({1, 4, 0.5}));
  const std::vector<MeshPart> parts = partsOf(both);
  for (std::size_t tests : {std::size_t{1}, std::size_t{100}}) {
    EXPECT_EQ(relate(both, parts[0], parts[1], tests).relation, PartRelation::unknown);
    EXPECT_EQ(tests, 0U);
  }
}

}  // namespace
}  // namespace cradle
