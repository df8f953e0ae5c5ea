#pragma once

#include <string>
#include <vector>

#include "commands/sample_folder.h"

namespace cradle {

/// Packs samples of a data set into one tar file, in the form of WebDataset: files of one frame have names that are
/// equal up to the first point, and stand together: sample_000003_000017.rgb.png, sample_000003_000017.depth.npy; those
/// of a whole sample are sample_000003.scene.json and so on. Times and owners are 0: scenes, pictures and passes that
/// are equal are so in the file, too; a trajectory tells its CPU time, which differs. Throws Error(output); the folders
/// stay.
void packSamples(const std::string& folder, const std::string& tar, const std::vector<SampleRecord>& samples);

}  // namespace cradle
