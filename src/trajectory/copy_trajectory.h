#pragma once

#include <string>

#include "trajectory/trajectory_file.h"

namespace cradle {

/// Writes the frames, events, contacts and cameras of a trajectory as another file. Throws what TrajectoryWriter
/// throws, and reading, and Error(interrupted).
void copyTrajectory(const TrajectoryReader& trajectory, const std::string& path);

}  // namespace cradle
