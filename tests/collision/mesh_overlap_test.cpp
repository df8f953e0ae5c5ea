#include "collision/mesh_overlap.h"

#include <gtest/gtest.h>

#include "collision/triangle_soup.h"
#include "rounding.h"

namespace cradle {
namespace {

/// The depth of a segment that goes into a solid: `entry` counts the faces that it goes through from outside.
EdgeDepth depthFrom(const MeshSurface& solid, const Segment& segment, bool isFromItsEnd = false) {
  for (std::uint32_t face = 0; face < solid.faces.size(); ++face) {
    const FlatTriangle triangle = triangleOf(solid, face);
    const double start = triangle.heightOf(segment.from), end = triangle.heightOf(segment.at(1));
    if (start * end >= 0 || (start < 0) != isFromItsEnd) continue;
    const double part = start / (start - end);
    if (triangle.isAbove(segment.at(part))) return depthOfEdge(solid, segment, part, face);
  }
  ADD_FAILURE() << "the segment goes through no face";
  return {};
}

// An edge that ends inside: as deep as its end under the side, at any size, from either direction of the segment.
TEST(DepthOfEdge, ThatEndsInsideIsThatOfItsEnd) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    const MeshSurface box = surfaceOf(boxMesh(size * Vec3(2, 2, 2)));
    const Vec3 above = size * Vec3(0.1, 1.3, 0.2), inside = size * Vec3(0.4, 0.9, 0.3);
    for (const bool isFromItsEnd : {false, true}) {
      const Segment segment = isFromItsEnd ? Segment{inside, above - inside} : Segment{above, inside - above};
      const EdgeDepth found = depthFrom(box, segment, isFromItsEnd);
      EXPECT_NEAR(found.depth, 0.1 * size, 8 * kEpsilon * size);
      EXPECT_LT((found.normal - Vec3::UnitY()).norm(), 4 * kEpsilon);
      EXPECT_LT((found.deepest - inside).norm(), 8 * kEpsilon * size);
      EXPECT_TRUE(found.isVertex);
    }
  }
}

// An edge in at one side and out at the next passes beneath their common edge: by the distance of the two lines.
TEST(DepthOfEdge, ThatPassesBeneathAnotherIsTheDistanceOfTheLines) {
  RandomPoses random(1);
  for (const double size : {1.0, 1e-6, 1e6}) {
    const MeshSurface box = surfaceOf(boxMesh(size * Vec3(2, 2, 2)));
    for (int i = 0; i < 200; ++i) {
      // Beneath the edge at x = y = 1, along z.
      const Vec3 from = size * Vec3(random.number(0.5, 0.95), 1, random.number(-0.4, 0.4));
      const Vec3 to = size * Vec3(1, random.number(0.5, 0.95), random.number(-0.4, 0.4));
      const Segment segment{from - 0.2 * (to - from), 1.4 * (to - from)};
      const EdgeDepth found = depthFrom(box, segment, i % 2);
      const Vec3 across = segment.along.cross(Vec3::UnitZ()).normalized();
      const double expected = std::abs(across.dot(from - size * Vec3(1, 1, 0)));
      EXPECT_NEAR(found.depth, expected, 32 * kEpsilon * size);
      EXPECT_NEAR(std::abs(found.normal.dot(across)), 1, 16 * kEpsilon);
      EXPECT_GT(found.normal.dot(Vec3(1, 1, 0)), 0);  // out
      EXPECT_FALSE(found.isVertex);
      // The deepest point is on the segment, and straight under the edge.
      EXPECT_LT(segment.along.normalized().cross(found.deepest - from).norm(), 64 * kEpsilon * size);
      const Vec3 out = found.deepest + found.depth * found.normal;
      EXPECT_LT((out - size * Vec3(1, 1, out.z() / size)).norm(), 64 * kEpsilon * size);
    }
  }
}

// Moved out along the normal by the depth the edge is out of a convex solid, and by less it is not.
TEST(DepthOfEdge, IsTheWayThatBringsItOut) {
  RandomPoses random(2);
  const MeshSurface solid = surfaceOf(moved(boxMesh(Vec3(2, 2, 2)), [](const Vec3& v) {
    return Vec3(v.x() + 0.3 * v.y(), v.y() + 0.2 * v.z(), v.z() - 0.1 * v.x());
  }));
  int checked = 0;
  for (int i = 0; i < 400; ++i) {
    const Segment segment{2.2 * random.direction(), random.vector(1.4)};
    if (heightOver(solid, segment.from).height <= 0 || heightOver(solid, segment.at(1)).height > -1e-3) continue;
    const EdgeDepth found = depthFrom(solid, segment);
    const double least = [&] {
      double lowest = INFINITY;
      for (int k = 0; k <= 200; ++k)
        lowest = std::min(lowest, heightOver(solid, segment.at(k / 200.0) + found.depth * found.normal).height);
      return lowest;
    }();
    if (found.depth > 0.2) continue;  // deeper inside, some way out
    ++checked;
    EXPECT_GT(least, -1e-12);
    EXPECT_LT(heightOver(solid, found.deepest + 0.99 * found.depth * found.normal).height, 0);
  }
  EXPECT_GT(checked, 5);
}

// Edges that graze: depths go to zero with the overlap, and never below it.
TEST(DepthOfEdge, GoesToZeroWhereItGrazes) {
  const MeshSurface box = surfaceOf(boxMesh(Vec3(2, 2, 2)));
  for (const double depth : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const double part = depth * std::sqrt(2);
    const Vec3 from(1 - part, 1, 0.1), to(1, 1 - part, 0.1), along = (to - from).normalized();
    const EdgeDepth found = depthFrom(box, {from - 0.1 * along, 0.2 * along + (to - from)});
    EXPECT_NEAR(found.depth, depth, 4 * kEpsilon);
    EXPECT_LT((found.normal - Vec3(1, 1, 0).normalized()).norm(), 1e-6);
  }
}

// An edge that ends on a face, here at its rim, touches it and is no way in: along the normal of that face.
TEST(DepthOfEdge, ThatEndsOnAFaceIsNone) {
  const MeshSurface box = surfaceOf(boxMesh(Vec3(2, 2, 2)));
  const Vec3 above(0.75, 1.5, 0.25);
  for (const Vec3& end : {Vec3(0.5, 1, 0.25), Vec3(1, 1, 0.5), Vec3(1, 1, 1)})
    for (std::uint32_t face = 0; face < box.faces.size(); ++face) {
      const FlatTriangle triangle = triangleOf(box, face);
      if (triangle.normal != Vec3::UnitY() || !triangle.isAbove(end)) continue;
      const EdgeDepth found = depthOfEdge(box, {above, end - above}, 1, face);
      EXPECT_EQ(found.depth, 0);
      EXPECT_EQ(found.normal, Vec3::UnitY());
      EXPECT_EQ(found.deepest, end);
      EXPECT_FALSE(found.isVertex);
    }
}

// Behind a sheet is inside, seen from the side of the face: the end of an edge that goes through it from above or from
// below is as deep as it is beyond.
TEST(DepthOfEdge, ThroughASheetIsWhatIsBehindIt) {
  const MeshSurface sheet = sheetOf({{{-1, 0, -1}, {-1, 0, 2}, {2, 0, -1}}, {{0, 1, 2}}});
  for (const double side : {1.0, -1.0}) {
    const Vec3 before(0.1, 0.3 * side, 0.1), behind(0.2, -0.05 * side, 0.15);
    const EdgeDepth found = depthFrom(sheet, {before, behind - before});
    EXPECT_NEAR(found.depth, 0.05, 8 * kEpsilon);
    EXPECT_LT((found.normal - side * Vec3::UnitY()).norm(), 4 * kEpsilon);
    EXPECT_TRUE(found.isVertex);
  }
}

}  // namespace
}  // namespace cradle
