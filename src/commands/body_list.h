#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace cradle {

/// A line for each body of a scene with its shape, its size along the axes of its frame and its mass. Bodies that are
/// alike in all of that, one after the other, share a line; many lines are cut short.
std::vector<std::string> describeBodies(const Scene& scene);

}  // namespace cradle
