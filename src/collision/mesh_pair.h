#pragma once

#include <array>
#include <cmath>

#include "collision/mesh_nearest.h"

namespace cradle {

/// One of the two surfaces of a pair.
enum class Partner : std::uint8_t { a, b };

inline Partner otherThan(Partner partner) {
  return partner == Partner::a ? Partner::b : Partner::a;
}

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

  const MeshSurface& surface(Partner partner) const { return partner == Partner::a ? a : b; }
  /// A point and a direction in the frame of one surface as seen from that of the other.
  Vec3 seenFromOther(Partner partner, const Vec3& point) const {
    return partner == Partner::a ? placedBack(point) : placed(point);
  }
  Vec3 turnedToOther(Partner partner, const Vec3& way) const {
    return partner == Partner::a ? turnedBack(way) : turned(way);
  }

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

/// A lower bound (m) of the distance of two triangles: of each from the plane of the other.
inline double leastDistance(const FlatTriangle& one, const FlatTriangle& other) {
  const auto fromPlane = [](const FlatTriangle& plane, const FlatTriangle& corners) {
    const auto [low, high] =
        std::minmax({plane.heightOf(corners.a), plane.heightOf(corners.b), plane.heightOf(corners.c)});
    return std::max({0.0, low, -high});
  };
  return std::max(fromPlane(one, other), fromPlane(other, one));
}

}  // namespace cradle
