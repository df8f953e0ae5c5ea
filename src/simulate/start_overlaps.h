#pragma once

#include "simulate/assembly.h"

namespace cradle {

/// Throws Error(scene) that names all pairs of bodies which overlap at the start, and how deep, one a line (at most
/// 50). Touching is fine: up to 1e-9 of the smaller body's size, and up to the rounding of single precision for models,
/// whose files hold no more digits. O(pairs).
void refuseStartOverlaps(const Scene& scene, const std::vector<Assembly>& islands);

}  // namespace cradle
