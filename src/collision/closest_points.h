#pragma once

#include <algorithm>

#include "math/types.h"

// Nearest points of segments and triangles (C. Ericson, "Real-Time Collision Detection", 2005, 5.1), in forms that keep
// the distance exact to rounding for any angles.

namespace cradle {

// Of a side: a point as far outside a triangle or beyond an edge is on it. Contacts on the common side of two triangles
// are then found by both, and none is lost between them; reduceContacts makes them one.
inline constexpr double kBeyondEnd = 1e-9;

/// A straight line's part from `from` to from + along.
struct Segment {
  Vec3 from, along;  // m

  Vec3 at(double part) const { return from + part * along; }
  /// The part (0..1) of it that is nearest to a point.
  double nearestPart(const Vec3& point) const {
    const double length2 = along.squaredNorm();
    return length2 > 0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
  }
};

/// The parts (0..1) of two segments that are nearest to each other.
struct SegmentParts {
  double a = 0, b = 0;
};

/// The nearest points of two lines by their common normal. Its error grows as the angle of the lines shrinks, just as
/// its effect on the distance shrinks (the error of the usual determinant grows with the square). If one of the points
/// is beyond an end of its segment, the point of the other segment nearest to that end takes its place.
inline SegmentParts nearestParts(const Segment& a, const Segment& b) {
  const Vec3 normal = a.along.cross(b.along), between = b.from - a.from;
  const double normal2 = normal.squaredNorm();
  SegmentParts parts;
  if (normal2 > 0) {
    parts.a = between.cross(b.along).dot(normal) / normal2;
    parts.b = between.cross(a.along).dot(normal) / normal2;
    if (parts.a >= 0 && parts.a <= 1 && parts.b >= 0 && parts.b <= 1) return parts;
    parts.a = std::clamp(parts.a, 0.0, 1.0);
  }
  parts.b = b.nearestPart(a.at(parts.a));
  parts.a = a.nearestPart(b.at(parts.b));
  return parts;
}

/// Corners of a triangle and its unit normal, which is zero if it has no area.
struct FlatTriangle {
  Vec3 a, b, c;  // m
  Vec3 normal;

  double heightOf(const Vec3& point) const { return normal.dot(point - a); }
  /// Whether the foot of the perpendicular is in the triangle, or beyond a side by at most `slack` of the side's
  /// length.
  bool isAbove(const Vec3& point, double slack = 0) const {
    return isLeftOf(a, b, point, slack) && isLeftOf(b, c, point, slack) && isLeftOf(c, a, point, slack) &&
           normal != Vec3::Zero();
  }

 private:
  bool isLeftOf(const Vec3& from, const Vec3& to, const Vec3& point, double slack) const {
    const Vec3 along = to - from;
    return normal.cross(along).dot(point - from) >= -slack * along.squaredNorm();
  }
};

inline const Vec3& cornerOf(const FlatTriangle& triangle, std::size_t corner) {
  return corner == 0 ? triangle.a : corner == 1 ? triangle.b : triangle.c;
}

}  // namespace cradle
