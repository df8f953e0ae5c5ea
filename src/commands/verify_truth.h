#pragma once

#include <string>

namespace cradle {

/// `cradle verify FOLDER`: the ground truth in a folder that `cradle render --passes` filled, against its trajectory.
/// Prints to stdout, in words or as JSON, how much of each kind was checked, and the worst of it. Throws
/// Error(different) with what does not hold, and Error(usage) for a folder that cannot be read.
void verifyTruth(const std::string& folder, bool asJson, bool quiet);

}  // namespace cradle
