#include "collision/mesh_gap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/core_separation.h"
#include "collision/triangle_soup.h"
#include "mesh/load_mesh.h"

// Separations of meshes against computations that know nothing of trees, features or pseudo-normals: distances by every
// triangle with every other, inside and outside by the solid angle that a surface fills, and boxes by separating axes.

namespace cradle {
namespace {

constexpr double kGapRounding = 1e-14;  // m: some sums and products of lengths of about 1 m

double pointToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double part = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - part * (b - a)).norm();
}

double pointToTriangle(const Vec3& p, const Corners& t) {
  double least = INFINITY;
  for (std::size_t i = 0; i < 3; ++i) least = std::min(least, pointToSegment(p, t[i], t[(i + 1) % 3]));
  // Where the plane is nearest, in coordinates of the triangle.
  Eigen::Matrix<double, 3, 2> sides;
  sides << t[1] - t[0], t[2] - t[0];
  const Eigen::Vector2d at = (sides.transpose() * sides).inverse() * (sides.transpose() * (p - t[0]));
  if (at.minCoeff() >= 0 && at.sum() <= 1) least = std::min(least, (p - t[0] - sides * at).norm());
  return least;
}

double segmentToSegment(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  double least =
      std::min({pointToSegment(a, c, d), pointToSegment(b, c, d), pointToSegment(c, a, b), pointToSegment(d, a, b)});
  Eigen::Matrix<double, 3, 2> sides;
  sides << b - a, c - d;
  const Eigen::Vector2d at = (sides.transpose() * sides).inverse() * (sides.transpose() * (c - a));
  if (at.minCoeff() >= 0 && at.maxCoeff() <= 1) least = std::min(least, (a - c + sides * at).norm());
  return least;
}

double triangleToTriangle(const Corners& s, const Corners& t) {
  double least = INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    least = std::min({least, pointToTriangle(s[i], t), pointToTriangle(t[i], s)});
    for (std::size_t j = 0; j < 3; ++j)
      least = std::min(least, segmentToSegment(s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]));
  }
  return least;
}

double soupDistance(const std::vector<Corners>& a, const std::vector<Corners>& b) {
  double least = INFINITY;
  for (const Corners& s : a)
    for (const Corners& t : b) {
      const Vec3 between = (s[0] - t[0]).cwiseAbs() - (s[1] - s[0]).cwiseAbs() - (s[2] - s[0]).cwiseAbs() -
                           (t[1] - t[0]).cwiseAbs() - (t[2] - t[0]).cwiseAbs();
      if (between.maxCoeff() <= least) least = std::min(least, triangleToTriangle(s, t));
    }
  return least;
}

bool goesThrough(const Vec3& from, const Vec3& to, const Corners& t) {
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a) > 0;
  };
  if (side(t[0], t[1], t[2], from) == side(t[0], t[1], t[2], to)) return false;
  const bool first = side(from, to, t[0], t[1]);
  return side(from, to, t[1], t[2]) == first && side(from, to, t[2], t[0]) == first;
}

bool intersect(const std::vector<Corners>& a, const std::vector<Corners>& b) {
  for (const Corners& s : a)
    for (const Corners& t : b)
      for (std::size_t i = 0; i < 3; ++i)
        if (goesThrough(s[i], s[(i + 1) % 3], t) || goesThrough(t[i], t[(i + 1) % 3], s)) return true;
  return false;
}

bool overlap(const std::vector<Corners>& a, const std::vector<Corners>& b) {
  return intersect(a, b) || windingAround(a[0][0], b) > 0.5 || windingAround(b[0][0], a) > 0.5;
}

struct MeshSolid {
  TriangleMesh mesh;
  MeshSurface surface;
  explicit MeshSolid(const TriangleMesh& given) : mesh(given), surface(surfaceOf(given)) {}
};

MeshGap gapOf(const MeshSurface& a, const MeshSurface& b, const RigidTransform& aFromB, double enough = INFINITY) {
  FeatureNeighbourList none;
  return gapBetween(MeshPair(a, b, aFromB), none, enough);
}

MeshGap gapOf(const MeshSolid& a, const MeshSolid& b, const RigidTransform& aFromB, double enough = INFINITY) {
  return gapOf(a.surface, b.surface, aFromB, enough);
}

std::vector<MeshSolid> sampleSolids(RandomPoses& random) {
  return {MeshSolid(lPrismMesh()), MeshSolid(lumpMesh(random)), MeshSolid(boxMesh(Vec3(0.5, 1.2, 0.8)))};
}

TEST(MeshGap, IsTheDistanceOfTheTrianglesApartAndNegativeExactlyIfTheSolidsOverlap) {
  RandomPoses random(1);
  int apart = 0, overlapping = 0;
  for (const MeshSolid& a : sampleSolids(random))
    for (const MeshSolid& b : sampleSolids(random))
      for (int i = 0; i < 25; ++i) {
        const RigidTransform pose = random.pose(1.5);
        const auto cornersOfA = cornersOf(a.mesh, {}), cornersOfB = cornersOf(b.mesh, pose);
        const MeshGap gap = gapOf(a, b, pose);
        EXPECT_NEAR(gap.normal.norm(), 1, kGapRounding);
        if (overlap(cornersOfA, cornersOfB)) {
          ++overlapping;
          EXPECT_LT(gap.separation, 0);
          continue;
        }
        ++apart;
        EXPECT_NEAR(gap.separation, soupDistance(cornersOfA, cornersOfB), kGapRounding);
        EXPECT_LT((gap.pointA + gap.separation * gap.normal - gap.pointB).norm(), 10 * kGapRounding);
      }
  EXPECT_GT(apart, 50);
  EXPECT_GT(overlapping, 50);
}

TEST(MeshGap, OneSolidInsideAnotherIsNegative) {
  const MeshSolid box(boxMesh(Vec3::Ones())), small(boxMesh(Vec3(0.2, 0.1, 0.3)));
  // Two parts, of which the nearer one is outside.
  const MeshSolid twoParts(joined(boxMesh(Vec3::Constant(0.1)), moved(boxMesh(Vec3::Constant(0.1)), [](const Vec3& p) {
                                    return Vec3(p.x() + 1, p.y(), p.z());
                                  })));
  const RigidTransform pose{rotationAbout(Vec3(1, 2, 3).normalized(), 0.3), Vec3(0.1, 0.05, -0.1)};
  EXPECT_LT(gapOf(box, small, pose).separation, 0);
  EXPECT_LT(gapOf(small, box, pose).separation, 0);
  EXPECT_LT(gapOf(box, small, pose, 1e-3).separation, 0);
  EXPECT_LT(gapOf(box, twoParts, {Quat::Identity(), Vec3(-0.4, 0, 0)}).separation, 0);
  EXPECT_LT(gapOf(box, twoParts, {Quat::Identity(), Vec3(-0.3, 0, 0)}).separation, 0);
  EXPECT_LT(gapOf(twoParts, box, {Quat::Identity(), Vec3(0.3, 0, 0)}).separation, 0);
}

TEST(MeshGap, HollowSolidHoldsAnotherWithoutTouchingIt) {
  const MeshSolid shell(joined(boxMesh(Vec3::Ones()), insideOut(boxMesh(Vec3::Constant(0.8)))));
  const MeshSolid small(boxMesh(Vec3::Constant(0.2)));
  EXPECT_NEAR(gapOf(shell, small, {Quat::Identity(), Vec3(0.1, 0, 0)}).separation, 0.2, kGapRounding);
  EXPECT_NEAR(gapOf(small, shell, {Quat::Identity(), Vec3(-0.1, 0, 0)}).separation, 0.2, kGapRounding);
  EXPECT_LT(gapOf(shell, small, {Quat::Identity(), Vec3(0.35, 0, 0)}).separation, 0);
}

// Separating axes see the least translation that parts two boxes: for small overlaps the depth of the vertex in the
// face or of the two crossed edges.
TEST(MeshGap, BoxesAsMeshesOverlapAsPolytopesDo) {
  RandomPoses random(2);
  const Vec3 sizeA(1, 0.6, 1.4), sizeB(0.5, 1.1, 0.8);
  const MeshSolid a(boxMesh(sizeA)), b(boxMesh(sizeB));
  const Collider boxA = colliderOf(Box{sizeA}, {}), boxB = colliderOf(Box{sizeB}, {});
  const auto axisAt = [&](const RigidTransform& pose) { return contactAxis(Core(boxA, {}), Core(boxB, pose)); };
  int edges = 0;
  for (int i = 0; i < 60; ++i) {
    RigidTransform pose = random.pose(0.6);
    // Along the axis of their gap, until they overlap by as much as wanted.
    const double depth = std::pow(10, random.number(-12, -3));
    const Vec3 way = pose.translation.normalized();
    double near = -3, far = 3;
    for (int k = 0; k < 60; ++k) {
      const double middle = (near + far) / 2;
      const RigidTransform tried{pose.rotation, pose.translation + middle * way};
      (axisAt(tried).separation > -depth ? far : near) = middle;
    }
    pose.translation += far * way;
    const double expected = axisAt(pose).separation;
    const MeshGap gap = gapOf(a, b, pose);
    EXPECT_NEAR(gap.separation, expected, 1e-9 * depth + kGapRounding) << i;
    const Vec3 normal = axisAt(pose).normal;
    if (depth > 1e-9) {
      EXPECT_LT((gap.normal - normal).norm(), 1e-6) << i << " " << depth;
    }
    edges += std::max((pose.rotation.conjugate() * normal).cwiseAbs().maxCoeff(), normal.cwiseAbs().maxCoeff()) < 0.999;
  }
  EXPECT_GT(edges, 10);
}

/// Where along `way` (m, from far to near) the solids first touch.
double touchingAt(const MeshSolid& a, const MeshSolid& b, RigidTransform pose, const Vec3& way) {
  const Vec3 start = pose.translation;
  double gone = 0;
  for (int i = 0; i < 10000; ++i) {
    pose.translation = start + gone * way;
    const double gap = gapOf(a, b, pose).separation;
    if (gap < 1e-15) break;
    gone += gap;  // nothing can touch before
  }
  return gone;
}

TEST(MeshGap, ChangesByTheNormalTimesTheMotionAndPassesThroughZero) {
  RandomPoses random(3);
  const std::vector<MeshSolid> solids = sampleSolids(random);
  for (int i = 0; i < 60; ++i) {
    const MeshSolid &a = solids[static_cast<std::size_t>(i) % 3], &b = solids[static_cast<std::size_t>(i / 3) % 3];
    const RigidTransform start{random.turn(), 7 * random.direction()};  // none reaches farther than 3.4 m
    const Vec3 way = (random.vector(0.3) - start.translation).normalized();
    const double touch = touchingAt(a, b, start, way);
    if (touch > 11) continue;  // passed by
    for (const double beyond : {-1e-6, 1e-6, 1e-8}) {
      RigidTransform pose{start.rotation, start.translation + (touch + beyond) * way};
      const MeshGap gap = gapOf(a, b, pose);
      EXPECT_GT(gap.separation * -beyond, 0) << i;
      EXPECT_LE(std::abs(gap.separation), std::abs(beyond) + kGapRounding);
      EXPECT_NEAR(gap.separation, gap.normal.dot(way) * beyond, 1e-3 * std::abs(beyond)) << i << " " << beyond;
    }
  }
}

/// Hills of 16 x 16 squares of 0.25 m, each of two triangles; closed, a solid down to y = -2.
TriangleMesh hillsMesh(bool isClosed) {
  constexpr std::uint32_t kSquares = 16;
  TriangleMesh mesh;
  for (const bool isBottom : {false, true})
    for (std::uint32_t i = 0; i <= kSquares && (isClosed || !isBottom); ++i)
      for (std::uint32_t k = 0; k <= kSquares; ++k) {
        const double x = 0.25 * i - 2, z = 0.25 * k - 2;
        mesh.vertices.emplace_back(x, isBottom ? -2 : 0.4 * std::sin(3 * x + 0.3) * std::cos(2.6 * z), z);
      }
  const std::uint32_t below = (kSquares + 1) * (kSquares + 1);
  const auto at = [](std::uint32_t i, std::uint32_t k) { return i * (kSquares + 1) + k; };
  const auto addQuad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  for (std::uint32_t i = 0; i < kSquares; ++i)
    for (std::uint32_t k = 0; k < kSquares; ++k) {
      addQuad(at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
      if (isClosed) addQuad(below + at(i, k), below + at(i + 1, k), below + at(i + 1, k + 1), below + at(i, k + 1));
    }
  const auto addSide = [&](std::uint32_t from, std::uint32_t to) { addQuad(from, to, below + to, below + from); };
  for (std::uint32_t i = 0; i < kSquares && isClosed; ++i) {
    addSide(at(i, 0), at(i + 1, 0)), addSide(at(i + 1, kSquares), at(i, kSquares));
    addSide(at(0, i + 1), at(0, i)), addSide(at(kSquares, i), at(kSquares, i + 1));
  }
  return mesh;
}

// What is under a sheet does not matter to what has hardly touched it from above, at faces, creases and corners. (How
// deep a box is in the solid is exact to 1e-3 of the depth: see the test above.)
TEST(MeshGap, OverASheetIsThatOverASolidWithTheSameTop) {
  RandomPoses random(6);
  const MeshSolid box(boxMesh(Vec3(0.3, 0.2, 0.25))), solid(hillsMesh(true));
  const MeshSurface sheet = sheetOf(hillsMesh(false));
  for (int i = 0; i < 300; ++i) {
    const RigidTransform start{random.turn(), {random.number(-1.2, 1.2), 1.5, random.number(-1.2, 1.2)}};
    const Vec3 way = Vec3(random.number(-0.3, 0.3), -1, random.number(-0.3, 0.3)).normalized();
    const double touch = touchingAt(solid, box, start, way);
    ASSERT_LT(touch, 3) << i;
    for (const double beyond : {-1e-6, 1e-11, 1e-9, 1e-7, 1e-5}) {
      const RigidTransform pose{start.rotation, start.translation + (touch + beyond) * way};
      const MeshGap expected = gapOf(solid, box, pose), gap = gapOf(sheet, box.surface, pose),
                    turned = gapOf(box.surface, sheet, pose.inverse());
      const double tolerance = 1e-2 * std::abs(beyond) + kGapRounding;
      EXPECT_NEAR(gap.separation, expected.separation, tolerance) << i << " " << beyond;
      EXPECT_NEAR(turned.separation, expected.separation, tolerance) << i << " " << beyond;
      EXPECT_GT(gap.normal.dot(expected.normal), 0.99) << i << " " << beyond;
      EXPECT_GT(-(pose.rotation * turned.normal).dot(expected.normal), 0.99) << i << " " << beyond;
    }
  }
}

// Edges at tiny angles: their distance must not suffer.
TEST(MeshGap, NearlyParallelEdgesKeepTheExactDistance) {
  RandomPoses random(4);
  for (double sine = 1e-16; sine < 1e-2; sine *= 10) {
    const Segment a{Vec3(-1, 0, 0), Vec3(2, 0, 0)};
    const Segment b{Vec3(-1, -sine, 0.1), Vec3(2, 2 * sine, 0)};  // crosses above the middle of a
    const Quat turn = random.turn();
    const Segment seenA{turn * a.from, turn * a.along}, seenB{turn * b.from, turn * b.along};
    const SegmentParts parts = nearestParts(seenA, seenB);
    EXPECT_NEAR((seenA.at(parts.a) - seenB.at(parts.b)).norm(), 0.1, 1e-15) << sine;
  }
}

TEST(MeshGap, EnoughEndsTheSearchWithoutChangingSmallerGaps) {
  RandomPoses random(5);
  const MeshSolid gear(loadObjects(CRADLE_SOURCE_DIR "/assets/gear.3ds", 1, ModelParts::solidAlone)[0].model.solid);
  for (int i = 0; i < 30; ++i) {
    const RigidTransform pose{random.turn(), 0.3 * random.direction()};
    const double gap = gapOf(gear, gear, pose).separation;
    EXPECT_EQ(gapOf(gear, gear, pose, std::abs(gap) * 1.01).separation, gap);
    if (gap > 0) {
      EXPECT_GT(gapOf(gear, gear, pose, gap * 0.99).separation, gap);
    }
  }
  const RigidTransform pose{random.turn(), Vec3(0.1, 0.25, 0.05)};
  EXPECT_NEAR(gapOf(gear, gear, pose).separation, soupDistance(cornersOf(gear.mesh, {}), cornersOf(gear.mesh, pose)),
              kGapRounding);
}

}  // namespace
}  // namespace cradle
