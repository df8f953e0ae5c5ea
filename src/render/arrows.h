#pragma once

#include "render/draw_list.h"

namespace cradle {

/// The cone at the tip of an arrow, its point in the origin, its axis along -y.
DrawnMesh makeArrowHead(double longestArrow);

/// Share of the longest arrow that is its head.
inline constexpr double kHeadLength = 0.26;

/// Appends an arrow from `tail` to `tip` (m, world), which is longer than its head.
void appendArrow(const Appearance& appearance, const ArrowLook& look, const Vec3& tail, const Vec3& tip,
                 DrawList& list);

/// Appends an arc of `angle` (rad) that turns about `axis` (unit), its middle on top; it is longer than its head.
void appendArc(const Appearance& appearance, const ArrowLook& look, const Vec3& center, const Vec3& axis, double radius,
               double angle, DrawList& list);

}  // namespace cradle
