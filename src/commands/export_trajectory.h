#pragma once

#include <string>

namespace cradle {

/// `cradle export TRAJECTORY -o FILE.csv|FILE.glb [--contacts]`: the ending says which; a table is of lasting contacts
/// if `exportsContacts`, else of states.
void exportTrajectory(const std::string& trajectory, const std::string& output, bool exportsContacts, bool quiet);

}  // namespace cradle
