#include "commands/sample_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "commands/frame_folder.h"
#include "commands/sample_folder.h"
#include "commands/shard.h"
#include "commands/simulate_scene.h"
#include "commands/tar_shard.h"
#include "commands/trajectory_source.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/output_path.h"
#include "core/part_file.h"
#include "core/part_lock.h"
#include "core/progress.h"
#include "core/read_file.h"
#include "core/worker_processes.h"
#include "sampling/scene_sampler.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxProcesses = 1000;
constexpr std::uint64_t kMaxSeed = std::uint64_t(1) << 53U;  // JSON has whole numbers up to there

/// The numbers of the samples of one of several parts that are as many as each other, but for one.
struct SampleRange {
  long first, end;  // half-open
};

SampleRange samplesOfShard(const SampleOptions& options) {
  if (options.count < 1 || options.count > kMaxSamples)
    throw Error(ErrorKind::usage, "-n",
                fmt::format("found {}; allowed are 1 to {} samples", options.count, kMaxSamples));
  if (!options.shard) return {0, options.count};
  const Shard shard = parseShard(*options.shard);
  return {shard.begin(options.count), shard.end(options.count)};
}

/// What pictures are asked for, and how, in words; empty for none.
std::string describedPictures(const SampleOptions& options, const PictureOptions& pictures) {
  if (!options.renders) return "";
  std::string text = fmt::format("passes {}", pictures.passes.value_or("rgb"));
  if (pictures.passes) text += fmt::format(", format {}", pictures.passFormat);
  if (pictures.size) text += fmt::format(", size {}", *pictures.size);
  if (pictures.frames) text += fmt::format(", frames {}", *pictures.frames);
  if (pictures.overlay) text += fmt::format(", overlay {}", *pictures.overlay);
  return text;
}

/// Removes the files that a run which was ended left of a sample, with which options nobody knows; a trajectory of the
/// same scene stays. Throws Error(output) where another run fills the folder, or where others' files are.
void clearUnfinished(const fs::path& folder, bool keepsTrajectory) {
  requireFramesAlone(folder.string());
  const FolderLock lock(folder.string(), FolderUse::alone);
  if (!keepsTrajectory) requireNoWriter(partPath((folder / kKeptTrajectory).string()));
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    if (!keepsTrajectory || (name != kSceneFile && !name.starts_with(kKeptTrajectory))) fs::remove(file);
  }
}

/// A whole sample is never replaced by another one.
void requireSame(const SampleRecord& found, const SampleRecord& wanted, const std::string& folder) {
  if (found.sceneHash != wanted.sceneHash || found.seed != wanted.seed)
    throw Error(
        ErrorKind::output, folder,
        fmt::format(
            "holds a sample of another scene or seed ({}), and is not replaced; name a new folder, or remove it",
            found.seed));
  if (!found.pictures.empty() && !wanted.pictures.empty() && found.pictures != wanted.pictures)
    throw Error(ErrorKind::output, folder,
                fmt::format("has pictures of another kind ({}; asked are {}), which are not replaced; name a new "
                            "folder, or remove it",
                            found.pictures, wanted.pictures));
}

bool holdsText(const fs::path& path, const std::string& text) {
  std::error_code missing;
  return fs::file_size(path, missing) == text.size() && !missing &&
         readFile(path.string(), text.size(), ErrorKind::output) == text;
}

/// Makes the samples of one scene with draws.
class DataSet {
 public:
  DataSet(const SceneSampler& sampler, std::string folder, const SampleOptions& options, const PictureOptions& pictures)
      : sampler_(sampler), folder_(std::move(folder)), options_(options), pictures_(pictures) {}

  fs::path folderOf(long number) const { return fs::path(folder_) / sampleName(number); }

  /// Makes what is not there yet of a sample. Throws Error(scene) where what was drawn is no scene.
  void make(long number) const;

 private:
  bool isWhole(const SampleRecord& found, const SampleRecord& wanted) const;
  void simulate(const fs::path& folder, SampleRecord& record) const;
  void render(const fs::path& folder) const;

  const SceneSampler& sampler_;
  std::string folder_;
  const SampleOptions& options_;
  const PictureOptions& pictures_;
};

bool DataSet::isWhole(const SampleRecord& found, const SampleRecord& wanted) const {
  if (found.failure) return true;
  return (!options_.simulates || !found.stateHash.empty()) && (wanted.pictures.empty() || !found.pictures.empty());
}

void DataSet::simulate(const fs::path& folder, SampleRecord& record) const {
  const std::string trajectory = (folder / kKeptTrajectory).string();
  record.stateHash = stateHashOf(trajectory);
  if (!record.stateHash.empty()) return;
  SimulateOptions simulation;
  simulation.scene.assetRoot = pictures_.assetRoot;
  try {
    simulateScene((folder / kSceneFile).string(), trajectory, simulation, true);
    record.stateHash = stateHashOf(trajectory);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::unstable) throw;
    record.failure = error.what();
  }
}

void DataSet::render(const fs::path& folder) const {
  renderFrames((folder / kKeptTrajectory).string(), folder.string(), pictures_, true);
}

void DataSet::make(long number) const {
  const fs::path folder = folderOf(number);
  const DrawnScene drawn = sampler_.sample(options_.seed, number);
  const std::string text = textInFolder(drawn, sampler_.path(), folder.string());
  SampleRecord record;
  record.number = number, record.seed = options_.seed, record.sceneHash = textHash(text);
  record.redrawn = drawn.redrawn, record.draws = drawn.values;
  record.pictures = describedPictures(options_, pictures_);
  const auto found = readRecord(folder.string());
  if (found) requireSame(*found, record, folder.string());
  if (found && isWhole(*found, record)) return;
  makeFolder(folder.string());
  const bool hasScene = holdsText(folder / kSceneFile, text);
  if (!found) clearUnfinished(folder, hasScene);
  if (!hasScene) writeWholeFile((folder / kSceneFile).string(), text);
  if (options_.simulates) simulate(folder, record);
  if (record.failure)
    record.pictures.clear();
  else if (options_.renders)
    render(folder);
  writeRecord(record, folder.string());
}

/// Throws Error(unstable) if simulations of samples failed, naming the first.
void tellFailures(const std::vector<SampleRecord>& records) {
  const auto failed =
      std::count_if(records.begin(), records.end(), [](const auto& record) { return record.failure.has_value(); });
  if (failed == 0) return;
  const auto first =
      std::find_if(records.begin(), records.end(), [](const auto& record) { return record.failure.has_value(); });
  throw Error(
      ErrorKind::unstable, "",
      fmt::format("{} of {} samples could not be simulated to their end, the others are whole; the first is {}: {}",
                  failed, records.size(), sampleName(first->number), *first->failure));
}

std::string tarNameOf(const SampleOptions& options) {
  if (!options.shard) return "samples.tar";
  const auto [part, parts] = parseShard(*options.shard);
  return fmt::format("samples_{}_of_{}.tar", part, parts);
}

void requireFormat(const std::string& format) {
  if (format == "folder" || format == "tar") return;
  throw Error(ErrorKind::usage, "--format", fmt::format("found \"{}\"; allowed are folder and tar", format));
}

void requireNoTar(const fs::path& path) {
  std::error_code missing;
  if (fs::exists(path, missing))
    throw Error(ErrorKind::output, path.string(),
                "is there already, and holds these samples; remove it, or name a new folder");
}

}  // namespace

void sampleScenes(const std::string& scene, const std::string& folder, const SampleOptions& asked,
                  const PictureOptions& pictures, bool quiet) {
  SampleOptions options = asked;
  options.renders = asked.renders || pictures.passes.has_value();
  options.simulates = asked.simulates || options.renders;
  const SampleRange range = samplesOfShard(options);
  requireFormat(options.format);
  if (options.seed > kMaxSeed)
    throw Error(ErrorKind::usage, "--seed", fmt::format("found {}; allowed are 0 to {}", options.seed, kMaxSeed));
  if (options.processes < 1 || options.processes > kMaxProcesses)
    throw Error(ErrorKind::usage, "-j",
                fmt::format("found {}; allowed are 1 to {} processes", options.processes, kMaxProcesses));
  requireSamplesAlone(folder);
  const bool packs = options.format == "tar";
  const fs::path tar = fs::path(folder) / tarNameOf(options);
  if (packs) requireNoTar(tar);
  const SceneSampler sampler(scene, pictures.assetRoot);
  sampler.sample(options.seed, range.first);  // what is wrong with the scene shows before a folder is made
  const ResultFolder made(folder);
  const FolderLock lock(folder, FolderUse::shared);

  const DataSet set(sampler, folder, options, pictures);
  {
    Progress progress("Sampling", "samples", std::max(1L, range.end - range.first), quiet);
    shareAmongProcesses(
        options.processes, range.end - range.first, [&](long number) { set.make(range.first + number); },
        [&](long done) { progress.update(done); });
  }
  std::vector<SampleRecord> records;
  for (long number = range.first; number < range.end; ++number) {
    auto record = readRecord(set.folderOf(number).string());
    if (!record)
      throw Error(ErrorKind::output, set.folderOf(number).string(),
                  "is gone while its data set was made; make it again");
    records.push_back(std::move(*record));
    if (packs) records.back().tar = tar.filename().string();
  }
  if (packs) packSamples(folder, tar.string(), records);
  writeIndex(folder, scene, packs ? records : std::vector<SampleRecord>{});
  if (packs)
    for (const SampleRecord& record : records) fs::remove_all(set.folderOf(record.number));
  tellFailures(records);
}

}  // namespace cradle
