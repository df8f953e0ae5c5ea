#pragma once

#include <string>
#include <vector>

namespace cradle {

/// Tells a warning on stderr.
void warn(const std::string& warning);

/// The first of them, and how many more there are: a file may give rise to a million.
void warnOfAll(const std::vector<std::string>& warnings);

/// No warning is told from now on. Trajectories keep theirs, and errors are told as ever.
void silenceWarnings();

}  // namespace cradle
