#pragma once

#include "surface.h"

namespace cradle::assets {

/// Twelve convex stones of 12 to 15 corners, about 2 m across at scale 1, each an object of its own.
std::vector<Surface> rocks();

}  // namespace cradle::assets
