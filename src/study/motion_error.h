#pragma once

#include <vector>

#include "trajectory/trajectory.h"

namespace cradle {

/// max |x - x_ref| / (1 + |x_ref|) over all numbers x of positions (m) of centres of mass and of orientations of the
/// same bodies; q and -q are the same orientation. NaN if a state is.
double motionError(const std::vector<BodyState>& states, const std::vector<BodyState>& reference);

}  // namespace cradle
