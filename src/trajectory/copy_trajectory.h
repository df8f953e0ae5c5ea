#pragma once

#include <string>

#include "trajectory/trajectory_file.h"

namespace cradle {

/// Writes a finished trajectory, with its cameras and all that is known of it, as another file. Throws what
/// TrajectoryWriter throws, and reading, and Error(interrupted).
void copyTrajectory(const TrajectoryReader& trajectory, const std::string& path);

}  // namespace cradle
