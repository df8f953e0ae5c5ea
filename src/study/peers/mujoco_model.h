#pragma once

#include <string>

#include "scene/scene.h"
#include "simulate/assembly.h"
#include "study/peers/joint_tree.h"

namespace cradle {

/// What is not MuJoCo's default.
struct MujocoSettings {
  std::string integrator = "Euler";  // or implicit, RK4
  bool isTuned = false;              // stiff constraints, elliptic friction cones, friction stiffer than what pushes
};

/// A scene as MuJoCo's own file has it (MJCF). Moving body i is "body<i>", with its frame at the centre of mass along
/// the body's axes. Driven bodies are free, and so heavy that what acts on them from others does not show; their
/// moments of inertia are equal.
std::string mujocoModelOf(const Scene& scene, const Assembly& assembly, const JointTree& tree,
                          const MujocoSettings& settings, double timeStep);

}  // namespace cradle
