#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "commands/pictures.h"

namespace cradle {

struct SampleOptions {
  long count = 1;
  std::uint64_t seed = 1;
  bool simulates = false, renders = false;  // rendering simulates
  bool findsHorizon = false;                // of each sample, by finer runs; simulates
  std::optional<std::string> shard;         // "PART/PARTS", from 1/PARTS on: of the samples, or of the chains
  std::optional<long> chains;               // the samples are of so many Markov chains, for the wishes of the scene
  int processes = 1;
  std::string format = "folder";  // or tar
};

/// `cradle sample SCENE -n COUNT --seed SEED -o FOLDER`: scenes drawn from one with draws, each in a folder of its own,
/// with their trajectories and pictures if asked; what came of wishes is printed. Samples that are there already,
/// whole, are left as they are. A sample whose simulation fails is told in its record, and at the end: throws
/// Error(unstable) then.
void sampleScenes(const std::string& scene, const std::string& folder, const SampleOptions& options,
                  const PictureOptions& pictures, bool quiet);

}  // namespace cradle
