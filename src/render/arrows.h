#pragma once

#include "render/draw_list.h"

namespace cradle {

/// The cone at the tip of an arrow, its point in the origin, its axis along -y.
DrawnMesh makeArrowHead(double longestArrow);

/// Shares of the longest arrow: length and radius of its head.
inline constexpr double kHeadLength = 0.26;
inline constexpr double kHeadRadius = 0.085;

/// Appends an arrow from `tail` to `tip` (m, world), which is longer than its head.
void appendArrow(const Appearance& appearance, const ArrowLook& look, const Vec3& tail, const Vec3& tip,
                 DrawList& list);

/// Unit, across the axis of an arc: from its centre to its middle.
Vec3 middleOfArc(const Vec3& axis);

/// Appends an arc of `angle` (rad) that turns about `axis` (unit), its middle on top; it is longer than its head.
void appendArc(const Appearance& appearance, const ArrowLook& look, const Vec3& center, const Vec3& axis, double radius,
               double angle, DrawList& list);

}  // namespace cradle
