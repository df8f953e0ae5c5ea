#pragma once

#include <optional>
#include <string>

namespace cradle {

struct ExportOptions {
  bool ofContacts = false;           // a table of contacts that last, in place of states
  std::optional<std::string> other;  // a trajectory that a page shows over the first one
};

/// `cradle export TRAJECTORY -o FILE.csv|FILE.glb|FILE.html`: the ending says which.
void exportTrajectory(const std::string& trajectory, const std::string& output, const ExportOptions& options,
                      bool quiet);

}  // namespace cradle
