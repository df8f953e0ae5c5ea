#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

// What models that move, and pages, show of links and joints, which have no thickness in physics.

namespace cradle {

/// Radius (m) of a drawn rod: a share of a typical body's, and of the diagonal of `bounds`, around all bodies, at
/// least.
double linkRadius(const Scene& scene, const Bounds& bounds);

enum class JointPartKind { bar, rail, ball };

/// A part of a joint: a cylinder of radius 1 and length 1 along y, or a ball of radius 1, scaled along its own axes.
struct JointPart {
  JointPartKind kind;
  std::string name;
  int body;  // that holds it, or kWorld
  RigidTransform bodyFromPart;
  Vec3 scale;  // m
};

/// Joints as pictures show them: the pin of a hinge, the sleeve of a slider, balls of ball joints and welds, and arms
/// to joints that are outside of their bodies. `radius` (m) is that of a drawn rod.
std::vector<JointPart> jointParts(const Scene& scene, double radius);

/// The least and the greatest coordinate (m) of each slider so far; begins empty.
using SliderReach = std::vector<std::pair<double, double>>;
void include(const Frame& frame, const Scene& scene, SliderReach& reach);

/// The rails of sliders, which reach as far as their sleeves go.
std::vector<JointPart> railParts(const Scene& scene, const SliderReach& reach, double radius);

}  // namespace cradle
