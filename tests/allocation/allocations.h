#pragma once

namespace cradle {

/// Calls of malloc in this program so far: all of Eigen's and the standard library's allocations go through it.
long allocations();

}  // namespace cradle
