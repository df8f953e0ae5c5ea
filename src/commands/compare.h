#pragma once

#include <string>

namespace cradle {

/// `cradle compare EXPECTED ACTUAL`: two images, two folders of images, or two trajectories (differences up to
/// `tolerance`). Prints what was found to stdout; throws Error(different) if they differ.
void compareResults(const std::string& expected, const std::string& actual, double tolerance);

/// `cradle export TRAJECTORY -o FILE.csv`.
void exportTrajectory(const std::string& trajectory, const std::string& output);

}  // namespace cradle
