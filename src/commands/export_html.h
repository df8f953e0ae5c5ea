#pragma once

#include <optional>
#include <string>

#include "trajectory/trajectory_file.h"

namespace cradle {

/// Writes a page that needs nothing else and plays a trajectory in a browser; over it another one of the same bodies,
/// if there is one. FILE is replaced when all is written. Throws as playerDocument does, and Error(output).
void exportHtml(TrajectoryReader reader, const std::optional<TrajectoryReader>& other, const std::string& path,
                bool quiet);

}  // namespace cradle
