#pragma once

#include "render/draw_list.h"

namespace cradle {

/// Appends what is seen of springs, rods, ropes and joints: coils, thin cylinders, small balls at their ends, and
/// mounts where they hang from the world.
void appendLinks(const Scene& scene, const Appearance& appearance, const View& view,
                 const std::vector<RigidTransform>& worldFromBody, DrawList& list);

}  // namespace cradle
