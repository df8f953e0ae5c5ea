#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace cradle {

/// The word that scene files have for a motion: "static", "driven" or "dynamic".
const char* nameOf(Motion motion);

/// What the shape of a body is called, and its size (m) along the axes of the body's frame; a plane has none.
struct ShapeFacts {
  const char* kind;
  std::optional<Vec3> size;
};

/// Of each body, in the order of the scene. O(bodies + vertices of the models).
std::vector<ShapeFacts> shapesOf(const Scene& scene);

/// A line for each body of a scene with its shape, its size along the axes of its frame and its mass. Bodies that are
/// alike in all of that, one after the other, share a line; many lines are cut short.
std::vector<std::string> describeBodies(const Scene& scene);

}  // namespace cradle
