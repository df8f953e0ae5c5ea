#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "math/types.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// A bounding volume hierarchy (BVH) of axis-aligned boxes around the triangles of a mesh, in the mesh's frame. A
/// binary tree; a node is split at its median triangle along its longest side. Node 0 holds all; the first child of
/// node n is n + 1; a leaf is one triangle.
struct Bvh {
  struct Node {
    Vec3 center, halfSize;   // m
    std::uint32_t second;    // second child; 0: a leaf
    std::uint32_t triangle;  // of a leaf

    bool isLeaf() const { return second == 0; }
  };
  std::vector<Node> nodes;
};

/// At least one triangle. The same tree for the same mesh everywhere. O(n log^2 n).
Bvh buildBvh(const TriangleMesh& mesh);

/// Square of the distance (m^2) of a point from a node's box; 0 inside.
inline double squaredDistance(const Bvh::Node& node, const Vec3& point) {
  return ((point - node.center).cwiseAbs() - node.halfSize).cwiseMax(0.0).squaredNorm();
}

/// The same from a box along the same axes.
inline double squaredDistance(const Bvh::Node& node, const Bounds& box) {
  const Vec3 between = (box.center() - node.center).cwiseAbs() - box.sizes() / 2 - node.halfSize;
  return between.cwiseMax(0.0).squaredNorm();
}

/// Calls visit(triangle) for triangles whose box is nearer to a point or box than the square root of visit.reach(),
/// which may shrink on the way; the nearer half first.
template <class Place, class Visit>
void visitNear(const Bvh& tree, const Place& place, Visit& visit, std::uint32_t at = 0) {
  const Bvh::Node& node = tree.nodes[at];
  if (node.isLeaf()) return visit(node.triangle);
  std::uint32_t near = at + 1, far = node.second;
  double nearest = squaredDistance(tree.nodes[near], place), farthest = squaredDistance(tree.nodes[far], place);
  if (farthest < nearest) std::swap(near, far), std::swap(nearest, farthest);
  if (nearest <= visit.reach()) visitNear(tree, place, visit, near);
  if (farthest <= visit.reach()) visitNear(tree, place, visit, far);
}

/// Two trees in a relative pose. Distances of boxes are bounded from below along the axes of both.
class BvhPair {
 public:
  /// Keeps references to the trees. `aFromB` turns by a unit quaternion.
  BvhPair(const Bvh& a, const Bvh& b, const RigidTransform& aFromB)
      : a_(a), b_(b), rotation_(aFromB.rotation.toRotationMatrix()), shift_(aFromB.translation) {
    extent_ = rotation_.cwiseAbs();
  }

  /// Calls visit(triangleOfA, triangleOfB) for pairs whose boxes may be nearer than the square root of visit.reach(),
  /// which may shrink on the way; the nearer ones first.
  template <class Visit>
  void visitNear(Visit& visit) const {
    if (squaredDistance(a_.nodes[0], b_.nodes[0], visit.reach()) <= visit.reach()) descend(visit, 0, 0);
  }

  /// Lower bound (m^2) of the square of the distance of two boxes; a coarser one if that is above `reach`.
  double squaredDistance(const Bvh::Node& a, const Bvh::Node& b, double reach) const {
    const Vec3 between = rotation_ * b.center + shift_ - a.center;
    const Vec3 alongA = between.cwiseAbs() - a.halfSize - extent_ * b.halfSize;
    const double coarse = alongA.cwiseMax(0.0).squaredNorm();
    if (coarse > reach) return coarse;
    const Vec3 alongB = (rotation_.transpose() * between).cwiseAbs() - b.halfSize - extent_.transpose() * a.halfSize;
    return std::max(coarse, alongB.cwiseMax(0.0).squaredNorm());
  }

 private:
  template <class Visit>
  void descend(Visit& visit, std::uint32_t atA, std::uint32_t atB) const {
    const Bvh::Node &a = a_.nodes[atA], &b = b_.nodes[atB];
    if (a.isLeaf() && b.isLeaf()) return visit(a.triangle, b.triangle);
    // The larger box is halved.
    const bool halveA = !a.isLeaf() && (b.isLeaf() || a.halfSize.squaredNorm() >= b.halfSize.squaredNorm());
    std::uint32_t near = halveA ? atA + 1 : atB + 1, far = halveA ? a.second : b.second;
    const auto distanceOf = [&](std::uint32_t child) {
      return halveA ? squaredDistance(a_.nodes[child], b, visit.reach())
                    : squaredDistance(a, b_.nodes[child], visit.reach());
    };
    double nearest = distanceOf(near), farthest = distanceOf(far);
    if (farthest < nearest) std::swap(near, far), std::swap(nearest, farthest);
    if (nearest <= visit.reach()) descend(visit, halveA ? near : atA, halveA ? atB : near);
    if (farthest <= visit.reach()) descend(visit, halveA ? far : atA, halveA ? atB : far);
  }

  const Bvh &a_, &b_;
  Mat3 rotation_, extent_;
  Vec3 shift_;
};

}  // namespace cradle
