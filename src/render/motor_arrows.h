#pragma once

#include "render/draw_list.h"

namespace cradle {

/// m: of the arrow of a motor that gives all of its force, in proportion to the bodies that motors move; 0 without any.
/// The looks of bodies must be there.
double longestMotorArrow(const Scene& scene, const Appearance& appearance);

/// Appends the arrows of motors at `frame`, as long as the part of all its force that each gives then, on A: at a hinge
/// arcs about its axis on both sides of the smaller body, at a slider an arrow along its axis.
void appendMotorArrows(const Scene& scene, const Appearance& appearance, const Frame& frame,
                       const std::vector<RigidTransform>& worldFromBody, DrawList& list);

}  // namespace cradle
