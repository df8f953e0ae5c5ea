#pragma once

#include "surface.h"

namespace cradle::assets {

/// The union of two cylinders as one closed surface: a bar along x through the origin and a stem from it along +y.
Surface tHandle();

}  // namespace cradle::assets
