#include "collision/separating_axis.h"

#include <gtest/gtest.h>

#include "collision/gjk.h"
#include "collision/sample_cores.h"
#include "rounding.h"

// Against all normals of faces and all cross products of edges, without Gauss maps and without walks along edges.

namespace cradle {
namespace {

// Of the size: a gap is a difference of two support values, each some 16 rounded products and sums.
constexpr double kAxisRounding = 64 * kEpsilon;

double widest(const SeparatingAxes& axes) {
  return std::max({axes.faceOfA.separation, axes.faceOfB.separation, axes.edges.separation});
}

/// The largest gap (m) that the normal of any face of a core sees; `sign` is -1 for B's.
double widestOfFaces(const CorePair& pair, const Core& core, double sign) {
  double most = -INFINITY;
  for (const Polytope::Face& face : core.collider().polytope->faces)
    most = std::max(most, pair.gapSeen(sign * core.turned(face.normal)));
  return most;
}

std::vector<Vec3> edgesOf(const Core& core) {
  const Polytope& polytope = *core.collider().polytope;
  if (polytope.faces.empty()) return {core.axis()};
  std::vector<Vec3> edges;
  for (const Polytope::Edge& edge : polytope.edges)
    edges.push_back(core.turned(polytope.vertices[edge.to] - polytope.vertices[edge.from]));
  return edges;
}

/// The largest gap (m) that a cross product of two edges sees.
double widestOfEdges(const CorePair& pair) {
  double most = -INFINITY;
  for (const Vec3& ofA : edgesOf(pair.a))
    for (const Vec3& ofB : edgesOf(pair.b)) {
      const Vec3 cross = ofA.cross(ofB);
      if (cross.norm() <= 1e-7 * ofA.norm() * ofB.norm()) continue;
      most = std::max({most, pair.gapSeen(cross.normalized()), pair.gapSeen(-cross.normalized())});
    }
  return most;
}

/// Checks what is true of any two cores; returns whether they overlap.
bool checkAxes(const CorePair& pair, double size) {
  const double rounding = kAxisRounding * size;
  const SeparatingAxes axes = separatingAxes(pair.a, pair.b);
  for (const SeparatingAxis& axis : {axes.faceOfA, axes.faceOfB, axes.edges}) {
    if (!std::isfinite(axis.separation)) continue;
    EXPECT_NEAR(axis.normal.norm(), 1, 4 * kEpsilon);
    EXPECT_NEAR(pair.gapSeen(axis.normal), axis.separation, rounding) << pair.name();
  }
  const double ofA = widestOfFaces(pair, pair.a, 1), ofB = widestOfFaces(pair, pair.b, -1);
  const double ofEdges = widestOfEdges(pair);
  EXPECT_EQ(std::isfinite(axes.faceOfA.separation) && std::isfinite(ofA), std::isfinite(axes.faceOfA.separation));
  EXPECT_LE(widest(axes), std::max({ofA, ofB, ofEdges}) + rounding) << pair.name();
  EXPECT_NEAR(std::max(axes.faceOfA.separation, axes.faceOfB.separation), std::max(ofA, ofB), rounding) << pair.name();
  if (ofB > ofA + rounding) {
    EXPECT_NEAR(axes.faceOfB.separation, ofB, rounding) << pair.name();
  }
  const double distance = distanceOf(pair.a, pair.b).distance;
  if (distance >
      1e-12 * size) {  // some face of the Minkowski difference sees the origin, but may see less than the distance
    EXPECT_GE(widest(axes), -rounding) << pair.name();
    EXPECT_LE(widest(axes), distance + rounding) << pair.name();
    return false;
  }
  // Of cores that overlap no direction sees a larger gap than a face of the difference: others cannot add to the edges.
  EXPECT_NEAR(widest(axes), std::max({ofA, ofB, ofEdges}), rounding) << pair.name();
  return true;
}

bool hasAxes(const CorePair& pair) {
  const auto isFlat = [](const SampleCore& core) { return core.collider.kind() == ColliderKind::polytope; };
  const auto isSegment = [](const SampleCore& core) { return core.collider.kind() == ColliderKind::capsule; };
  return (isFlat(pair.sampleA) && (isFlat(pair.sampleB) || isSegment(pair.sampleB))) ||
         (isSegment(pair.sampleA) && isFlat(pair.sampleB));
}

TEST(SeparatingAxes, SeeAsMuchAsAnyFaceOrPairOfEdgesAtAnySize) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    int overlapping = 0, all = 0;
    forRandomCorePairs(size, 0.5, 30, [&](const CorePair& pair) {
      if (hasAxes(pair)) ++all, overlapping += checkAxes(pair, 2 * size);
    });
    EXPECT_GT(overlapping, 100);
    EXPECT_GT(all - overlapping, 50);
  }
}

// Parallel faces and edges, edges that cross at 1e-9 rad, a common centre, faces that coincide.
TEST(SeparatingAxes, OfAlignedCoresAreThoseOfTheirFaces) {
  const std::vector<SampleCore> cores = sampleCores(1);
  for (const SampleCore& a : cores)
    for (const SampleCore& b : cores)
      for (const double angle : {0.0, 1e-9, 1e-5, M_PI / 2, M_PI / 4})
        for (const Vec3& place : {Vec3(0, 0, 0), Vec3(0.2, 0.1, 0), Vec3(0, 0.305, 0.1), Vec3(0.3, 0.3, -0.7)}) {
          const CorePair pair{a, b, {}, {rotationAbout(Vec3::UnitY(), angle), place}};
          if (hasAxes(pair)) checkAxes(pair, 2);
        }
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4));
  const SeparatingAxes axes =
      separatingAxes(Core(box.collider, {}), Core(box.collider, {Quat(1, 0, 0, 0), Vec3(0, 0.5, 0)}));
  EXPECT_NEAR(axes.faceOfA.separation, -0.1, kAxisRounding);
  EXPECT_NEAR(axes.faceOfB.separation, -0.1, kAxisRounding);  // as large a gap as A's: kept too
  EXPECT_EQ(axes.faceOfA.normal, Vec3::UnitY());
  EXPECT_EQ(axes.faceOfB.normal, Vec3::UnitY());
}

// Two long edges at right angles, one over the other: 0.02 of overlap along y, which no face sees.
TEST(SeparatingAxes, OfCrossingEdgesIsAcrossBoth) {
  const SampleCore bar = boxCore("bar", Vec3(1, 1, 6));
  const Quat onEdge = rotationAbout(Vec3::UnitZ(), M_PI / 4);
  const double half = std::sqrt(0.5);
  for (const double shift : {-0.02, 0.02}) {
    const CorePair pair{bar,
                        bar,
                        {onEdge, Vec3::Zero()},
                        {rotationAbout(Vec3::UnitY(), M_PI / 2) * onEdge, Vec3(0.1, 2 * half + shift, 0.2)}};
    const SeparatingAxes axes = separatingAxes(pair.a, pair.b);
    EXPECT_NEAR(axes.edges.separation, shift, kAxisRounding);
    EXPECT_LT((axes.edges.normal - Vec3::UnitY()).norm(), 8 * kEpsilon);
    EXPECT_LT(std::max(axes.faceOfA.separation, axes.faceOfB.separation), shift - 0.1);
  }
}

// Exchanged, the axes of A are those of B, and all normals are turned round: also where A is the segment.
TEST(SeparatingAxes, OfExchangedCoresAreTurnedRound) {
  forRandomCorePairs(1, 0.5, 10, [&](const CorePair& pair) {
    if (!hasAxes(pair)) return;
    const double there = widest(separatingAxes(pair.a, pair.b)), back = widest(separatingAxes(pair.b, pair.a));
    if (distanceOf(pair.a, pair.b).distance == 0) {
      EXPECT_NEAR(there, back, kAxisRounding) << pair.name();
    }
  });
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4)), segment = segmentCore(1);
  const SeparatingAxes axes =
      separatingAxes(Core(segment.collider, {Quat::Identity(), Vec3(0.1, 0.75, 0.2)}), Core(box.collider, {}));
  EXPECT_NEAR(axes.faceOfB.separation, -0.05, kAxisRounding);
  EXPECT_LT((axes.faceOfB.normal + Vec3::UnitY()).norm(), 4 * kEpsilon);  // from the segment down to the box
  EXPECT_FALSE(std::isfinite(axes.faceOfA.separation));                   // it has no faces
}

}  // namespace
}  // namespace cradle
