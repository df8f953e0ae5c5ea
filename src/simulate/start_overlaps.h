#pragma once

#include <utility>
#include <vector>

#include "simulate/assembly.h"

namespace cradle {

/// Moves apart what overlaps at the start, with a warning that says how deep, before anything is counted as energy.
/// Touching is fine: up to 1e-9 of the smaller body's size, and up to the rounding of single precision for models,
/// whose files hold no more digits. Throws Error(scene) that names all pairs which overlap by more than half of the
/// radius of a sphere inside the smaller body, or which cannot be moved apart, one a line (at most 50); overlaps that
/// would take long to mend are refused too. O(pairs), ended early by a thousand faults.
void correctStartPenetrations(const Scene& scene, std::vector<Assembly>& islands);

/// Pairs of scene bodies that overlap at the start by more than touching, of those that may touch at all. The scene
/// must have passed refuseUnsupported.
std::vector<std::pair<int, int>> bodiesInEachOther(const Scene& scene);

}  // namespace cradle
