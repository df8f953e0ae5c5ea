#include "collision/bvh.h"

#include <gtest/gtest.h>

#include <set>

#include "collision/triangle_soup.h"
#include "rounding.h"

namespace cradle {
namespace {

Bounds boxOf(const TriangleMesh& mesh, std::uint32_t triangle) {
  Bounds box;
  for (const std::uint32_t vertex : mesh.triangles[triangle]) box.extend(mesh.vertices[vertex]);
  return box;
}

/// Checks the subtree at a node; returns its box and adds its triangles and its depth.
Bounds checkSubtree(const Bvh& tree, const TriangleMesh& mesh, std::uint32_t at, int depth,
                    std::set<std::uint32_t>& found, int& deepest) {
  const Bvh::Node& node = tree.nodes[at];
  deepest = std::max(deepest, depth);
  Bounds box;
  if (node.isLeaf()) {
    box = boxOf(mesh, node.triangle);
    EXPECT_TRUE(found.insert(node.triangle).second);
  } else {
    box = checkSubtree(tree, mesh, at + 1, depth + 1, found, deepest);
    box.extend(checkSubtree(tree, mesh, node.second, depth + 1, found, deepest));
  }
  EXPECT_LT((node.center - box.center()).norm() + (node.halfSize - box.sizes() / 2).norm(), 1e-15);
  return box;
}

TEST(Bvh, HoldsEachTriangleOnceInTightBoxesOfABalancedTree) {
  RandomPoses random(1);
  for (const TriangleMesh& mesh : {lumpMesh(random), crumpledSheet(2), lPrismMesh()}) {
    const Bvh tree = buildBvh(mesh);
    std::set<std::uint32_t> found;
    int deepest = 0;
    checkSubtree(tree, mesh, 0, 0, found, deepest);
    EXPECT_EQ(found.size(), mesh.triangles.size());
    EXPECT_EQ(tree.nodes.size(), 2 * mesh.triangles.size() - 1);
    EXPECT_EQ(deepest, std::ceil(std::log2(static_cast<double>(mesh.triangles.size()))));  // halved by number
  }
  const Bvh one = buildBvh({{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}});
  EXPECT_TRUE(one.nodes[0].isLeaf());
  EXPECT_EQ(one.nodes.size(), 1u);
}

/// Collects what is visited, with a reach that stays.
struct Collector {
  double reach2;
  std::set<std::uint32_t> found = {};
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs = {};
  double reach() const { return reach2; }
  void operator()(std::uint32_t triangle) { found.insert(triangle); }
  void operator()(std::uint32_t a, std::uint32_t b) { pairs.insert({a, b}); }
};

TEST(Bvh, VisitsExactlyTheTrianglesWhoseBoxesAreWithinReach) {
  RandomPoses random(3);
  const TriangleMesh mesh = lumpMesh(random);
  const Bvh tree = buildBvh(mesh);
  for (int i = 0; i < 100; ++i) {
    const Vec3 point = random.vector(1), size = (random.vector(0.3)).cwiseAbs();
    const Bounds box(Vec3(point - size), Vec3(point + size));
    const double reach = random.number(0, 0.4);
    Collector nearPoint{reach * reach}, nearBox{reach * reach};
    visitNear(tree, point, nearPoint);
    visitNear(tree, box, nearBox);
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      const double toPoint = boxOf(mesh, triangle).exteriorDistance(point),
                   toBox = boxOf(mesh, triangle).exteriorDistance(box);
      if (std::abs(toPoint - reach) > 1e-14) {
        EXPECT_EQ(nearPoint.found.count(triangle), toPoint < reach);
      }
      if (std::abs(toBox - reach) > 1e-14) {
        EXPECT_EQ(nearBox.found.count(triangle), toBox < reach);
      }
    }
  }
}

// A search whose reach shrinks to the nearest box found so far ends at the nearest of all.
TEST(Bvh, FindsTheNearestWithAShrinkingReach) {
  struct Nearest {
    const TriangleMesh& mesh;
    Vec3 point;
    double best = INFINITY;
    int visits = 0;
    double reach() const { return best; }
    void operator()(std::uint32_t triangle) {
      ++visits;
      best = std::min(best, boxOf(mesh, triangle).squaredExteriorDistance(point));
    }
  };
  RandomPoses random(4);
  const TriangleMesh mesh = lumpMesh(random);
  const Bvh tree = buildBvh(mesh);
  int visits = 0;
  for (int i = 0; i < 100; ++i) {
    Nearest nearest{mesh, 2 * random.direction()};
    visitNear(tree, nearest.point, nearest);
    double expected = INFINITY;
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle)
      expected = std::min(expected, boxOf(mesh, triangle).squaredExteriorDistance(nearest.point));
    EXPECT_NEAR(nearest.best, expected, 1e-14);
    visits += nearest.visits;
  }
  EXPECT_LT(visits, 100 * static_cast<int>(mesh.triangles.size()) / 4);  // the nearer half first
}

// Boxes turned by 45 degrees: by the axes of A they are 2 - (0.5 + sqrt(0.5)) apart, and so for those of B.
TEST(BvhPair, BoundsTheDistanceOfTurnedBoxes) {
  const Bvh none;
  const Bvh::Node a{Vec3::Zero(), Vec3(0.5, 0.5, 0.5), 0, 0}, b{Vec3(0.1, 0.2, 0), Vec3(0.5, 0.5, 0.5), 0, 0};
  const Quat turn = rotationAbout(Vec3::UnitZ(), M_PI / 4);
  const RigidTransform aFromB{turn, Vec3(2, 0, 0) - turn * b.center};
  const double gap = 1.5 - std::sqrt(0.5);
  EXPECT_NEAR(BvhPair(none, none, aFromB).squaredDistance(a, b, INFINITY), gap * gap, 8 * kEpsilon);
  // Corner to corner along a diagonal: A's axes see no gap along y, B's axes see that along x + y.
  const RigidTransform aside{turn, Vec3(1.1, 1.1, 0) - turn * b.center};
  const double along = 1.1 * std::sqrt(2) - std::sqrt(0.5) - 0.5;
  EXPECT_NEAR(BvhPair(none, none, aside).squaredDistance(a, b, INFINITY), along * along, 8 * kEpsilon);
}

// No pair of triangles that has points within reach is missed.
TEST(BvhPair, VisitsAllPairsOfTrianglesWithinReach) {
  RandomPoses random(5);
  const TriangleMesh one = lumpMesh(random), other = lPrismMesh();
  const Bvh ofOne = buildBvh(one), ofOther = buildBvh(other);
  std::size_t visited = 0, near = 0;
  for (int i = 0; i < 20; ++i) {
    const RigidTransform pose{random.turn(), 1.5 * random.direction()};
    const double reach = random.number(0.05, 0.4);
    Collector collector{reach * reach};
    BvhPair(ofOne, ofOther, pose).visitNear(collector);
    visited += collector.pairs.size();
    for (std::uint32_t a = 0; a < one.triangles.size(); ++a)
      for (std::uint32_t b = 0; b < other.triangles.size(); ++b)
        for (const std::uint32_t vertex : other.triangles[b]) {
          if (distanceTo(one, one.triangles[a], pose * other.vertices[vertex]) > reach) continue;
          ++near;
          EXPECT_TRUE(collector.pairs.count({a, b}));
        }
  }
  EXPECT_GT(near, 50u);
  EXPECT_LT(visited, 20 * one.triangles.size() * other.triangles.size() / 2);
}

}  // namespace
}  // namespace cradle
