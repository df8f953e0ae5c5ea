#include "commands/sample_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "commands/data_set.h"
#include "commands/frame_folder.h"
#include "commands/picture_order.h"
#include "commands/sample_chain.h"
#include "commands/sample_folder.h"
#include "commands/shard.h"
#include "commands/tar_shard.h"
#include "commands/warnings.h"
#include "core/console.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "core/worker_processes.h"
#include "truth/passes.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxProcesses = 1000;
constexpr std::uint64_t kMaxSeed = std::uint64_t(1) << 53U;  // JSON has whole numbers up to there

void requireOptions(const SampleOptions& options) {
  if (options.count < 1 || options.count > kMaxSamples)
    throw Error(ErrorKind::usage, "-n",
                fmt::format("found {}; allowed are 1 to {} samples", options.count, kMaxSamples));
  if (options.chains && (*options.chains < 1 || *options.chains > options.count))
    throw Error(
        ErrorKind::usage, "--chains",
        fmt::format("found {}; allowed are 1 to {} chains, the number of samples", *options.chains, options.count));
  if (options.seed > kMaxSeed)
    throw Error(ErrorKind::usage, "--seed", fmt::format("found {}; allowed are 0 to {}", options.seed, kMaxSeed));
  if (options.processes < 1 || options.processes > kMaxProcesses)
    throw Error(ErrorKind::usage, "-j",
                fmt::format("found {}; allowed are 1 to {} processes", options.processes, kMaxProcesses));
  if (options.format != "folder" && options.format != "tar")
    throw Error(ErrorKind::usage, "--format", fmt::format("found \"{}\"; allowed are folder and tar", options.format));
}

/// Which samples are made, and by which units of work, each by one process: chains, or else the samples themselves.
class Work {
 public:
  explicit Work(const SampleOptions& options) : count_(options.count), units_(options.chains.value_or(options.count)) {
    if (!options.shard) return;
    const Shard shard = parseShard(*options.shard);
    firstUnit_ = shard.begin(units_), endUnit_ = shard.end(units_);
  }

  long firstUnit() const { return firstUnit_; }
  long units() const { return (endUnit_ < 0 ? units_ : endUnit_) - firstUnit_; }
  SampleRange samplesOf(long unit) const { return {unit * count_ / units_, (unit + 1) * count_ / units_}; }
  SampleRange samples() const { return {samplesOf(firstUnit_).first, samplesOf(firstUnit_ + units()).first}; }

 private:
  long count_, units_;
  long firstUnit_ = 0, endUnit_ = -1;
};

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

/// The end of the name of a tar file: in how many parts samples were packed.
std::string partsOf(const fs::path& tar) {
  const std::string name = tar.filename().string();
  const auto of = name.find("_of_");
  return of == name.npos ? "" : name.substr(of);
}

std::string tarNameOf(const SampleOptions& options) {
  if (!options.shard) return "samples.tar";
  const auto [part, parts] = parseShard(*options.shard);
  return fmt::format("samples_{}_of_{}.tar", part, parts);
}

std::vector<SampleRecord> recordsOf(const DataSet& set, const SampleRange& range) {
  std::vector<SampleRecord> records;
  for (long number = range.first; number < range.end; ++number)
    if (auto record = set.found(number)) records.push_back(std::move(*record));
  return records;
}

/// Samples are packed once, in one way. A tar file whose samples are all there beside it is of a run that was ended
/// before it had removed them.
void requireRoomForTar(const fs::path& tar, const DataSet& set, const SampleRange& range) {
  std::error_code missing;
  if (!fs::is_directory(tar.parent_path(), missing)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(tar.parent_path())) {
    if (entry.path().extension() != ".tar") continue;
    const bool isIt = entry.path().filename() == tar.filename();
    if (isIt && static_cast<long>(recordsOf(set, range).size()) < range.end - range.first)
      throw Error(ErrorKind::output, tar.string(),
                  "is there already, and holds these samples; remove it, or name a new folder");
    if (!isIt && partsOf(entry.path()) != partsOf(tar))
      throw Error(ErrorKind::output, entry.path().string(),
                  "holds samples that were packed in other parts, which would be there twice; name a new folder, or "
                  "remove it");
  }
}

/// Tells how many samples have warnings, and the first of these.
void tellWarnings(const std::vector<SampleRecord>& records) {
  const auto warned = [](const auto& record) { return !record.warnings.empty(); };
  const auto first = std::find_if(records.begin(), records.end(), warned);
  if (first == records.end()) return;
  warn(fmt::format("of {} of {} samples there are warnings, in their {}; the first is of {}: {}",
                   std::count_if(records.begin(), records.end(), warned), records.size(), kRecordFile,
                   sampleName(first->number), first->warnings.front()));
}

/// What a data set with wishes is worth.
void tellWishes(const std::vector<SampleRecord>& records) {
  const std::vector<ChainSummary> chains = summariesOf(records);
  if (!chains.empty()) show("chain  samples  accepted  autocorrelation time  effective samples  all wishes met\n");
  for (const ChainSummary& chain : chains)
    show("{:5}  {:7}  {:6.1f} %  {:20.1f}  {:17.1f}  {:14}\n", chain.chain, chain.samples,
         100.0 * static_cast<double>(chain.accepted) / static_cast<double>(std::max(1L, chain.samples - 1)),
         chain.autocorrelationTime, chain.effectiveSamples(), chain.met);
  const auto told =
      std::count_if(records.begin(), records.end(), [](const auto& record) { return !record.wishes.empty(); });
  const auto met = std::count_if(records.begin(), records.end(),
                                 [](const auto& record) { return !record.wishes.empty() && areAllMet(record.wishes); });
  if (chains.empty() && told > 0) show("{} of {} samples meet all wishes\n", met, told);
}

/// What is wrong with a scene and its pictures shows before a folder is made.
void requireWork(const SceneSampler& sampler, const SampleOptions& options, const PictureOptions& pictures,
                 const Work& work) {
  if (options.chains) requireChains(sampler);
  if (work.units() == 0) return;
  const DrawnScene first = sampler.sample(options.seed, work.firstUnit());
  if (pictures.passes) parsePasses(*pictures.passes);
  if (options.renders) pictureOrderOf(pictures, first.loaded.scene);
}

/// Makes a sample that no chain comes to.
void makeDrawn(const SceneSampler& sampler, const DataSet& set, const SampleOptions& options, long number) {
  const DrawnScene drawn = sampler.sample(options.seed, number);
  SampleRecord record;
  record.number = number;
  if (const auto found = set.found(number)) record.wishes = found->wishes;
  if (record.wishes.empty() && !drawn.loaded.scene.wishes.empty() && !options.simulates)
    record.wishes = simulateWishes(drawn.loaded.scene).outcomes;
  set.make(record, drawn);
}

/// Mesa's threads wait for each other longer than they help with small pictures, of which a data set has many: of
/// 320x240 a film takes an eighth less time without them. Processes beside each other (-j) are what uses processors.
/// Who has set Mesa's variable keeps it.
void drawInOneThread() {
  setenv("LP_NUM_THREADS", "0", false);
}

}  // namespace

void sampleScenes(const std::string& scene, const std::string& folder, const SampleOptions& asked,
                  const PictureOptions& pictures, bool quiet) {
  SampleOptions options = asked;
  options.renders = asked.renders || pictures.passes.has_value();
  options.simulates = asked.simulates || options.renders || asked.findsHorizon;
  requireOptions(options);
  const Work work(options);
  requireSamplesAlone(folder);
  const SceneSampler sampler(scene, pictures.assetRoot);
  const DataSet set(sampler, folder, options, pictures);
  const SampleRange range = work.samples();
  const bool packs = options.format == "tar";
  const fs::path tar = fs::path(folder) / tarNameOf(options);
  if (packs) requireRoomForTar(tar, set, range);
  requireWork(sampler, options, pictures, work);
  const ResultFolder made(folder);
  const FolderLock lock(folder, FolderUse::shared);
  drawInOneThread();
  try {
    Progress progress("Sampling", "samples", std::max(1L, range.end - range.first), quiet);
    shareAmongProcesses(
        options.processes, work.units(),
        [&](long number, const std::function<void()>& tell) {
          const long unit = work.firstUnit() + number;
          if (options.chains) return SampleChain(sampler, set, options.seed, unit).make(work.samplesOf(unit), tell);
          makeDrawn(sampler, set, options, unit);
          tell();
        },
        [&](long done) { progress.update(done); });
  } catch (const Error&) {
    if (!recordsOf(set, range).empty()) writeIndex(folder, scene, {});  // of those that are there
    throw;
  }
  std::vector<SampleRecord> records = recordsOf(set, range);
  if (static_cast<long>(records.size()) < range.end - range.first)
    throw Error(ErrorKind::output, folder, "has lost samples while it was made; make it again");
  if (packs) {
    for (SampleRecord& record : records) record.tar = tar.filename().string();
    if (!fs::exists(tar)) packSamples(folder, tar.string(), records);
  }
  writeIndex(folder, scene, packs ? records : std::vector<SampleRecord>{});
  if (packs)
    for (const SampleRecord& record : records) fs::remove_all(set.folderOf(record.number));
  tellWarnings(records);
  tellWishes(records);
  tellFailures(records);
}

}  // namespace cradle
