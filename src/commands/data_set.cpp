#include "commands/data_set.h"

#include <fmt/format.h>

#include <vector>

#include "commands/frame_folder.h"
#include "commands/simulate_scene.h"
#include "commands/trajectory_source.h"
#include "commands/warnings.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/output_path.h"
#include "core/part_file.h"
#include "core/part_lock.h"
#include "core/read_file.h"
#include "trajectory/state_hash.h"
#include "trajectory/trajectory_file.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

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

/// Removes the files that a run which was ended left of a sample, with which options nobody knows; an unfinished
/// trajectory of the same scene stays, to be gone on with: of a whole one nobody knows the warnings. Throws
/// Error(output) where another run fills the folder, or where others' files are.
void clearUnfinished(const fs::path& folder, bool keepsTrajectory) {
  requireFramesAlone(folder.string());
  const FolderLock lock(folder.string(), FolderUse::alone);
  if (!keepsTrajectory) requireNoWriter(partPath((folder / kKeptTrajectory).string()));
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    const bool isUnfinished = name.starts_with(kKeptTrajectory) && name != kKeptTrajectory;
    if (!keepsTrajectory || !(name == kSceneFile || isUnfinished)) fs::remove(file);
  }
}

bool areOfOneChain(const SampleRecord& a, const SampleRecord& b) {
  if (!a.chain || !b.chain) return a.chain.has_value() == b.chain.has_value();
  return a.chain->chain == b.chain->chain && a.chain->iteration == b.chain->iteration;
}

/// A whole sample is never replaced by another one.
void requireSame(const SampleRecord& found, const SampleRecord& wanted, const std::string& folder) {
  if (!areOfOneChain(found, wanted))
    throw Error(
        ErrorKind::output, folder,
        "is of another chain, or of another number of samples or chains, and is not replaced; name a new folder, "
        "or remove it");
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

/// What a whole trajectory says of its horizon; empty if it does not, or is not there.
std::string horizonIn(const std::string& trajectory) {
  if (!fs::exists(trajectory)) return "";
  const TrajectoryReader run(trajectory);
  const auto text = run.meta().find(kHorizonKey);
  return text == run.meta().end() ? "" : text->second;
}

/// What came of the wishes of a scene in a whole trajectory.
std::vector<WishOutcome> outcomesOf(const std::string& trajectory, const Scene& scene) {
  const TrajectoryReader run(trajectory);
  WishWatch watch(scene);
  for (long number = 0; number < run.frameCount(); ++number) watch.note(run.readFrame(number));
  for (const Event& event : run.events()) watch.note(event);
  for (const LastingContact& contact : run.contacts()) watch.note(contact);
  return watch.outcomes();
}

/// What was not asked for now, but when the sample was made.
void keepKnown(const SampleRecord& found, SampleRecord& record) {
  record.horizon = found.horizon, record.warnings = found.warnings, record.stateHash = found.stateHash;
  if (record.pictures.empty()) record.pictures = found.pictures;
}

}  // namespace

bool DataSet::isWhole(const SampleRecord& found, const SampleRecord& wanted) const {
  if (found.failure) return true;
  return (!options_.simulates || !found.stateHash.empty()) && (!options_.findsHorizon || !found.horizon.empty()) &&
         (wanted.pictures.empty() || !found.pictures.empty());
}

void DataSet::simulate(const fs::path& folder, const Scene& scene, SampleRecord& record) const {
  const std::string trajectory = (folder / kKeptTrajectory).string();
  const CollectedWarnings warnings;
  try {
    const bool isSimulated = !record.stateHash.empty() && stateHashOf(trajectory) == record.stateHash;
    if (!isSimulated || (options_.findsHorizon && record.horizon.empty())) {
      SimulateOptions simulation;
      simulation.scene.assetRoot = pictures_.assetRoot, simulation.findsHorizon = options_.findsHorizon;
      simulateScene((folder / kSceneFile).string(), trajectory, simulation, true);
      record.stateHash = stateHashOf(trajectory);
      if (options_.findsHorizon) record.horizon = horizonIn(trajectory);
    }
    if (!scene.wishes.empty()) record.wishes = outcomesOf(trajectory, scene);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::unstable) throw;
    record.failure = error.what(), record.wishes = unmet(scene.wishes.size());
  }
  if (!warnings.texts().empty()) record.warnings = warnings.texts();
}

void DataSet::render(const fs::path& folder) const {
  renderFrames((folder / kKeptTrajectory).string(), folder.string(), pictures_, true);
}

std::optional<SampleRecord> DataSet::found(long number) const {
  return readRecord(folderOf(number).string());
}

void DataSet::make(const SampleRecord& asked, const DrawnScene& drawn) const {
  const fs::path folder = folderOf(asked.number);
  const std::string text = textInFolder(drawn, sampler_.path(), folder.string());
  SampleRecord record = asked;
  record.seed = options_.seed, record.sceneHash = textHash(text);
  record.redrawn = drawn.redrawn, record.draws = drawn.values;
  const bool isRepeated = record.chain && record.chain->sameAs != record.number;
  record.pictures = isRepeated ? "" : describedPictures(options_, pictures_);
  const auto found = readRecord(folder.string());
  if (found) requireSame(*found, record, folder.string());
  if (found && isWhole(*found, record)) return;
  if (found) keepKnown(*found, record);
  makeFolder(folder.string());
  const bool hasScene = holdsText((folder / kSceneFile).string(), text);
  if (!found) clearUnfinished(folder, hasScene);
  if (!hasScene) writeWholeFile((folder / kSceneFile).string(), text);
  if (isRepeated) {
    const auto same = DataSet::found(record.chain->sameAs);
    if (same) record.stateHash = same->stateHash, record.horizon = same->horizon, record.failure = same->failure;
  } else {
    if (options_.simulates) simulate(folder, drawn.loaded.scene, record);
    if (record.failure)
      record.pictures.clear();
    else if (options_.renders)
      render(folder);
  }
  writeRecord(record, folder.string());
}

}  // namespace cradle
