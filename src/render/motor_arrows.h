#pragma once

#include "render/draw_list.h"

namespace cradle {

/// m: of the arrow of a motor that gives all of its force, in proportion to the bodies that motors move; 0 without any.
/// `localBounds` are those of all bodies.
double longestMotorArrow(const Scene& scene, const std::vector<Bounds>& localBounds);

/// Appends the arrows of motors at `frame`, as long as the part of all its force that each gives then, on A: at a hinge
/// arcs about its axis on both sides of the smaller body, at a slider an arrow along its axis. Where the joint's other
/// body, or what is fixed, would hide them they stand outside of that.
void appendMotorArrows(const Scene& scene, const Appearance& appearance, const Frame& frame,
                       const std::vector<RigidTransform>& worldFromBody, DrawList& list);

/// Points (m, world) whose hull holds these arrows.
std::vector<Vec3> outlineOfMotorArrows(const Scene& scene, const std::vector<Bounds>& localBounds, const Frame& frame,
                                       const std::vector<RigidTransform>& worldFromBody);

}  // namespace cradle
