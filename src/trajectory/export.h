#pragma once

#include <functional>
#include <string>

#include "trajectory/trajectory_file.h"

namespace cradle {

/// Writes the states as comma-separated values: a header line with units, then for each frame one line for each body
/// that moves and, in columns of their own, one for each hinge and slider. Numbers have as many digits as give the same
/// bits when read back; names are quoted as RFC 4180 says where they need it. `progress` is told after each frame how
/// many are done, and may throw. FILE is replaced when all is written. Throws Error(output), and what reading throws.
void exportCsv(const TrajectoryReader& reader, const std::string& path, const std::function<void(long done)>& progress);

/// The same of contacts that last: for each frame one line for each contact there, with its force, and when it lasts.
void exportContactsCsv(const TrajectoryReader& reader, const std::string& path,
                       const std::function<void(long done)>& progress);

}  // namespace cradle
