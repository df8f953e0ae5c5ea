#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "commands/pictures.h"
#include "commands/sample_folder.h"
#include "commands/sample_scenes.h"
#include "sampling/scene_sampler.h"

namespace cradle {

/// The folder of the samples of one scene with draws.
class DataSet {
 public:
  /// Keeps references to all but the folder.
  DataSet(const SceneSampler& sampler, std::string folder, const SampleOptions& options, const PictureOptions& pictures)
      : sampler_(sampler), folder_(std::move(folder)), options_(options), pictures_(pictures) {}

  std::filesystem::path folderOf(long number) const { return std::filesystem::path(folder_) / sampleName(number); }

  /// What is known of a whole sample; none if it is not there.
  std::optional<SampleRecord> found(long number) const;

  /// Makes what is not there yet of the sample that `asked` numbers, of its scene: the scene file, and what the options
  /// ask for. A state that a chain was in before is not simulated again. Throws Error(output) where another sample is.
  void make(const SampleRecord& asked, const DrawnScene& drawn) const;

 private:
  bool isWhole(const SampleRecord& found, const SampleRecord& wanted) const;
  void simulate(const std::filesystem::path& folder, const Scene& scene, SampleRecord& record) const;
  void render(const std::filesystem::path& folder) const;

  const SceneSampler& sampler_;
  std::string folder_;
  const SampleOptions& options_;
  const PictureOptions& pictures_;
};

}  // namespace cradle
