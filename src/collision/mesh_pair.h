#pragma once

#include <array>
#include <cmath>

#include "collision/mesh_nearest.h"

namespace cradle {

/// Two surfaces in a relative pose: all as seen from A's frame.
class MeshPair {
 public:
  /// Keeps references to the surfaces.
  MeshPair(const MeshSurface& surfaceA, const MeshSurface& surfaceB, const RigidTransform& pose)
      : a(surfaceA), b(surfaceB), aFromB(pose), rotation_(pose.rotation.toRotationMatrix()), shift_(pose.translation) {}

  Vec3 placed(const Vec3& pointOfB) const { return rotation_ * pointOfB + shift_; }
  Vec3 turned(const Vec3& directionOfB) const { return rotation_ * directionOfB; }
  Vec3 turnedBack(const Vec3& direction) const { return rotation_.transpose() * direction; }
  Vec3 placedBack(const Vec3& point) const { return rotation_.transpose() * (point - shift_); }

  FlatTriangle triangleOfB(std::uint32_t face) const {
    const FlatTriangle own = triangleOf(b, face);
    return {placed(own.a), placed(own.b), placed(own.c), turned(own.normal)};
  }
  Segment segmentOfB(std::uint32_t edge) const {
    const Segment own = segmentOf(b, edge);
    return {placed(own.from), turned(own.along)};
  }

  const MeshSurface &a, &b;
  const RigidTransform aFromB;

 private:
  Mat3 rotation_;
  Vec3 shift_;
};

/// Heights (m) of a triangle's corners over another one's plane.
using CornerHeights = std::array<double, 3>;

inline CornerHeights heightsOver(const FlatTriangle& plane, const FlatTriangle& corners) {
  return {plane.heightOf(corners.a), plane.heightOf(corners.b), plane.heightOf(corners.c)};
}

/// A lower bound (m) of the distance of a triangle from one in the plane that its corners' heights are over.
inline double leastDistance(const CornerHeights& heights) {
  const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
  return std::max({0.0, low, -high});
}

/// Calls pierces(i, part) for the sides i that the face owns and that go through `through`, given its corners' heights.
template <class Pierces>
void forEachPiercing(const MeshSurface::Face& face, const FlatTriangle& triangle, const CornerHeights& heights,
                     const FlatTriangle& through, const Pierces& pierces) {
  // Of a side: triangles reach beyond their sides by 90 unit roundoffs here, so that no edge slips through between two
  // of them, whose sides are rounded each for itself.
  constexpr double kSideOverlap = 1e-14;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    if (!face.ownsEdge[i] || !((heights[i] < 0) != (heights[next] < 0))) continue;
    const double part = heights[i] / (heights[i] - heights[next]);
    const Vec3 &from = cornerOf(triangle, i), &to = cornerOf(triangle, next);
    if (through.isAbove(from + part * (to - from), kSideOverlap)) pierces(i, part);
  }
}

}  // namespace cradle
