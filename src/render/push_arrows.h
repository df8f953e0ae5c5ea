#pragma once

#include "render/draw_list.h"

namespace cradle {

/// The cone at the tip of an arrow, its point in the origin, its axis along -y.
DrawnMesh makeArrowHead(double longestArrow);

/// Appends the arrows of the pushes that are to be seen at `frame`: each points along its force and ends where that
/// acts.
void appendPushArrows(const Appearance& appearance, const View& view, const Frame& frame,
                      const std::vector<RigidTransform>& worldFromBody, DrawList& list);

}  // namespace cradle
