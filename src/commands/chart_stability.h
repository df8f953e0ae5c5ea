#pragma once

#include <string>
#include <vector>

#include "study/stability/maps.h"

namespace cradle {

/// `cradle stability -o FOLDER`: NAME.csv, NAME.svg and NAME.png of each map. `names` are those of stabilityMaps(), all
/// of them if empty. Without gnuplot the tables are written, and Error(output) thrown in the end; interrupted, the maps
/// that are done stay.
void chartStability(const std::string& folder, const std::vector<std::string>& names, bool quiet);

}  // namespace cradle
