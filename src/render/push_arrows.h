#pragma once

#include "render/draw_list.h"

namespace cradle {

/// Appends the arrows of the pushes that are to be seen at `frame`: each points along its force and ends where that
/// acts.
void appendPushArrows(const Appearance& appearance, const View& view, const Frame& frame,
                      const std::vector<RigidTransform>& worldFromBody, DrawList& list);

}  // namespace cradle
