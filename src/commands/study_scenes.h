#pragma once

#include <string>
#include <vector>

namespace cradle {

/// `cradle study SCENE... -o FOLDER`: study.csv, and a chart of each scene. Meshes are below `assetRoot`, if that is
/// not empty; `methods` are names, all of them if empty. Prints what was found to stdout. Without gnuplot the table is
/// written, and Error(output) thrown in the end; interrupted, study.csv.part keeps what is done, and the same command
/// goes on from there.
void studyScenes(const std::vector<std::string>& scenes, const std::string& assetRoot, const std::string& folder,
                 const std::vector<std::string>& methods, bool quiet);

}  // namespace cradle
