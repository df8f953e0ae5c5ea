#pragma once

#include <limits>

namespace cradle {

/// Of a double: the distance from 1 to the next larger number.
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

}  // namespace cradle
