#pragma once

#include <string>

namespace cradle {

/// `cradle export TRAJECTORY -o FILE.csv|FILE.glb`: the ending says which.
void exportTrajectory(const std::string& trajectory, const std::string& output, bool quiet);

}  // namespace cradle
