#pragma once

#include "render/draw_list.h"

namespace cradle {

/// What links are made of.
inline const Surface kSteel{Vec3f(0.56f, 0.57f, 0.58f), 1.0f, 0.28f};
inline const Surface kDarkSteel{Vec3f(0.16f, 0.165f, 0.175f), 0.6f, 0.45f};
inline const Surface kHemp{Vec3f(0.36f, 0.26f, 0.15f), 0.0f, 0.85f};

/// Appends what is seen of springs, rods, ropes and joints: coils, thin cylinders, small spheres at their ends, and
/// mounts where they hang from the world.
void appendLinks(const Scene& scene, const Appearance& appearance, const View& view,
                 const std::vector<RigidTransform>& worldFromBody, DrawList& list);

}  // namespace cradle
