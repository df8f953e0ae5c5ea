// A command becomes stages: a trajectory, parts of the pictures or samples, a look whether all are there, a film. What
// a task finds whole it leaves, so that no scheduler needs to know how far an ended one was.

#include "commands/submit.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>

#include "commands/frame_folder.h"
#include "commands/job_scripts.h"
#include "commands/picture_order.h"
#include "commands/sample_chain.h"
#include "commands/sample_folder.h"
#include "commands/trajectory_source.h"
#include "core/console.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/output_path.h"
#include "core/part_file.h"
#include "core/read_file.h"
#include "image/child_process.h"
#include "image/video.h"
#include "sampling/scene_sampler.h"
#include "trajectory/state_hash.h"
#include "trajectory/trajectory_file.h"
#include "truth/passes.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr long kPicturesOfATask = 60;            // some 30 s at half a second each
constexpr double kMinTaskTime = 30;              // s: a scheduler takes a second or so to start one
constexpr long kMaxTasks = 100'000;              // of a stage, where no scheduler says less
constexpr long kUsualMaxArraySize = 1001;        // of Slurm, unless it is configured; one more than the tasks
constexpr std::uint64_t kMaxScript = 1'000'000;  // bytes
// Beside the scripts: a sample that is made to see how long one takes; what becomes a film, and what it is drawn from.
constexpr const char *kPilot = "pilot", *kFrames = "frames", *kTrajectory = "trajectory.sqlite";

std::string absolute(const std::string& path) {
  return fs::absolute(path).lexically_normal().string();
}

/// The words of a command behind its name: its input first, then options.
class CommandWords {
 public:
  explicit CommandWords(const std::vector<std::string>& command) : options_(command.begin() + 2, command.end()) {}

  /// Takes an option with its value out; nothing if it is not there. Throws Error(usage) if it has none.
  std::optional<std::string> take(const std::vector<std::string>& names) {
    for (auto word = options_.begin(); word != options_.end(); ++word)
      for (const std::string& name : names) {
        const bool isShort = name.size() == 2;  // its value may follow at once
        const std::string before = isShort ? name : name + "=";
        if (word->starts_with(before) && word->size() > before.size()) {
          const std::string value = word->substr(before.size());
          options_.erase(word);
          return value;
        }
        if (*word != name) continue;
        if (word + 1 == options_.end()) throw Error(ErrorKind::usage, name, "is without its value");
        const std::string value = word[1];
        options_.erase(word, word + 2);
        return value;
      }
    return std::nullopt;
  }

  /// A path leads to the same place from another folder.
  void makeAbsolute(const std::string& name) {
    if (const auto path = take({name})) options_.insert(options_.end(), {name, absolute(*path)});
  }

  void refuse(const std::vector<std::string>& names, const std::string& why) const {
    for (const std::string& word : options_)
      for (const std::string& name : names)
        if (word == name || word.starts_with(name + "=")) throw Error(ErrorKind::usage, name, why);
  }

  const std::vector<std::string>& options() const { return options_; }

 private:
  std::vector<std::string> options_;
};

std::optional<std::string> shownValue(CommandWords words, const std::vector<std::string>& names) {
  return words.take(names);
}

long wholeNumber(const char* option, const std::optional<std::string>& text, long fallback) {
  if (!text) return fallback;
  long number = 0;
  const auto [end, fault] = std::from_chars(text->data(), text->data() + text->size(), number);
  if (fault != std::errc() || end != text->data() + text->size() || number < 1 || number > kMaxSamples)
    throw Error(ErrorKind::usage, option, fmt::format("found \"{}\"; allowed are 1 to {}", *text, kMaxSamples));
  return number;
}

/// The most tasks that an array may have.
long maxTasksOf(const std::string& scheduler) {
  if (scheduler != "slurm") return kMaxTasks;
  long arraySize = kUsualMaxArraySize;
  try {
    ChildProcess configuration({"scontrol", "show", "config"});
    const int code = configuration.finish();
    const std::string text = configuration.standardOutput();
    const auto key = text.find("MaxArraySize");
    const auto digits = key == text.npos ? key : text.find_first_of("0123456789", key);
    if (code == 0 && digits != text.npos) std::from_chars(text.data() + digits, text.data() + text.size(), arraySize);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::encoder) throw;  // that it cannot be started: this is no machine of the cluster
  }
  return std::max(1L, arraySize - 1);
}

long tasksFor(double work, double ofATask, long most) {
  return std::clamp(static_cast<long>(std::ceil(work / ofATask)), 1L, most);
}

/// The program that runs.
std::string programPath() {
  return fs::read_symlink("/proc/self/exe").string();
}

std::string programCall(std::vector<std::string> words) {
  words.insert(words.begin(), programPath());
  words.push_back("-q");
  return quoted(words);
}

std::vector<std::string> joined(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// What is drawn: how many pictures, how fast.
struct Film {
  long frames = 0;
  double framesPerSecond = 60;
  bool hasTitleCard = false;
  bool isTrajectory = false;
};

/// Throws what is wrong with the input, or with its pictures.
Film filmOf(const std::string& input, const PictureOptions& pictures) {
  Film film;
  film.isTrajectory = isDatabaseFile(input);
  const TrajectorySource source(input, true, {.assetRoot = pictures.assetRoot});
  if (pictures.passes) parsePasses(*pictures.passes);
  pictureOrderOf(pictures, source.scene());
  film.frames = source.pictureCount();
  film.framesPerSecond = source.scene().output.framesPerSecond;
  film.hasTitleCard = source.scene().titleCard.has_value();
  return film;
}

void addSimulation(const std::string& scene, const std::string& trajectory, const std::vector<std::string>& options,
                   JobPlan& plan) {
  plan.stages.push_back({"simulate", 1, programCall(joined({"simulate", scene, "-o", trajectory}, options)) + "\n"});
}

/// What printf makes the name of a file of each frame of, for one kind of those that are drawn.
std::string patternOf(const CommandWords& words) {
  const std::string passes = shownValue(words, {"--passes"}).value_or("rgb");
  const std::string first = passes.substr(0, passes.find(','));
  if (passes == "all" || ("," + passes + ",").find(",rgb,") != passes.npos) return "frame_%06d.png";
  if (shownValue(words, {"--pass-format"}) == "exr") return kPassesKind + "_%06d.exr";
  return first + "_%06d.npy";
}

void planPictures(const SubmitOptions& options, const std::string& input, const std::string& output,
                  CommandWords& words, JobPlan& plan) {
  const bool encodes = options.command[0] == "video";
  words.refuse(
      {"--frames", "--shard", "--skip-existing", "--overwrite", "--side-by-side"},
      "is not for jobs, which draw all pictures that are not there yet; leave it out, or give the command itself");
  const Film film = filmOf(input, options.pictures);
  if (encodes && film.hasTitleCard)
    throw Error(ErrorKind::usage, input, "has a title card, which only `cradle video` itself puts before a film");
  if (encodes) requireFilmName(output);
  const std::string trajectory = film.isTrajectory ? input : (fs::path(plan.folder) / kTrajectory).string();
  const std::string frames = encodes ? (fs::path(plan.folder) / kFrames).string() : output;
  if (!film.isTrajectory) {
    const auto assetRoot = shownValue(words, {"--asset-root"});
    addSimulation(input, trajectory,
                  assetRoot ? std::vector<std::string>{"--asset-root", *assetRoot} : std::vector<std::string>{}, plan);
    plan.stages.back().script = fmt::format("[ -e {} ] || {}", quoted(trajectory), plan.stages.back().script);
  }
  const long tasks = tasksFor(static_cast<double>(film.frames), kPicturesOfATask, maxTasksOf(options.scheduler));
  const std::string draw =
      programCall(joined({"render", trajectory, "-o", frames, "--skip-existing"}, words.options()));
  plan.stages.push_back({"render", tasks, fmt::format("{} --shard \"$task/{}\"\n", draw, tasks)});
  plan.stages.push_back(checkStage(frames, patternOf(words), 0, film.frames));
  if (!encodes) plan.pictures = output;
  if (encodes)
    plan.stages.push_back({"encode", 1,
                           fmt::format("{}\n", programCall({"encode", frames, "-o", output, "--frames-per-second",
                                                            fmt::format("{}", film.framesPerSecond)}))});
}

std::string firstLineOf(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// s: wall time of one sample, which is made and thrown away.
double timeOfASample(const std::string& scene, const CommandWords& words, long count, const std::string& folder) {
  const std::string pilot = (fs::path(folder) / kPilot).string();
  fs::remove_all(pilot);  // of a call that was ended
  std::vector<std::string> command = {programPath(), "sample", scene, "-o", pilot, "-n", std::to_string(count)};
  command = joined(joined(command, words.options()), {"--shard", fmt::format("1/{}", count), "-q"});
  const auto start = std::chrono::steady_clock::now();
  ChildProcess sample(command);
  const int code = sample.finish();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fs::remove_all(pilot);
  if (code != 0 && code != static_cast<int>(ErrorKind::unstable))
    throw Error(
        static_cast<ErrorKind>(code), "",
        fmt::format("a first sample, to see how long one takes, failed: {}", firstLineOf(sample.standardError())));
  return seconds;
}

/// Makes the samples, and looks whether all are there.
std::vector<JobStage> sampleStages(const std::vector<std::string>& make, const std::string& output, bool packs,
                                   long tasks, long count) {
  // A sample that becomes unstable is told in its record, and is there.
  const std::string script = fmt::format("{} --shard \"$task/{}\" || [ $? = {} ]\n", programCall(make), tasks,
                                         static_cast<int>(ErrorKind::unstable));
  if (!packs) return {{"sample", tasks, script}, checkStage(output, "sample_%06d/sample.json", 0, count)};
  return {{"sample", tasks,
           fmt::format("[ -e {}/samples_\"$task\"_of_{}.tar ] || {{\n{}}}\n", quoted(output), tasks, script)},
          checkStage(output, fmt::format("samples_%d_of_{}.tar", tasks), 1, tasks)};
}

/// Of the samples' stage of the jobs in a folder; 1 if there are none.
long tasksThatAreThere(const std::string& folder) {
  const std::string path = (fs::path(folder) / "1_sample.sh").string();
  if (!fs::exists(path)) return 1;
  const std::string text = readFile(path, kMaxScript, ErrorKind::output), key = "--array=1-";
  const auto found = text.find(key);
  long tasks = 1;
  if (found != text.npos) std::from_chars(text.data() + found + key.size(), text.data() + text.size(), tasks);
  return std::max(1L, tasks);
}

void planSamples(const std::string& scheduler, const std::string& scene, const std::string& output, CommandWords& words,
                 bool quiet, JobPlan& plan) {
  words.refuse({"--shard"}, "is what the jobs divide the samples by; leave it out");
  const long count = wholeNumber("-n", words.take({"-n", "--count"}), 1);
  const auto format = words.take({"--format"});
  const auto chains = words.take({"--chains"});
  plan.processors = wholeNumber("-j", shownValue(words, {"-j", "--processes"}), 1);
  if (format && format != "folder" && format != "tar")
    throw Error(ErrorKind::usage, "--format", fmt::format("found \"{}\"; allowed are folder and tar", *format));
  const long units = wholeNumber("--chains", chains, count);
  if (units > count)
    throw Error(ErrorKind::usage, "--chains",
                fmt::format("found {}; allowed are 1 to {}, the number of samples", units, count));
  const SceneSampler sampler(scene);
  if (chains) requireChains(sampler);
  std::vector<std::string> make = joined({"sample", scene, "-o", output, "-n", std::to_string(count)}, words.options());
  if (chains) make = joined(make, {"--chains", *chains});
  if (format) make = joined(make, {"--format", *format});
  const auto setTasks = [&](long tasks) { plan.stages = sampleStages(make, output, format == "tar", tasks, count); };
  // The time of a sample differs from call to call: the same jobs as those that are there are in as many tasks.
  setTasks(tasksThatAreThere(plan.folder));
  if (areThere({stageScript(plan, 0)})) return;
  if (!quiet) show(stderr, "Making one sample, to see how long they take\n");
  const double time = timeOfASample(scene, words, count, plan.folder);
  setTasks(tasksFor(time * static_cast<double>(count) / static_cast<double>(plan.processors), kMinTaskTime,
                    std::min(maxTasksOf(scheduler), units)));
}

bool isOfJobs(const std::string& name) {
  return name == kRunScript || name == kPilot || name == kFrames || name.starts_with(kTrajectory) || isOfStage(name);
}

/// Removes what earlier jobs have left in their folder: they were others. Throws Error(output) if it is not theirs.
void clearJobs(const fs::path& folder) {
  if (!fs::exists(folder / kRunScript) && !fs::is_empty(folder))
    throw Error(ErrorKind::output, folder.string(),
                "holds files of other origin, where scripts of jobs are to be written; move them away, or name another "
                "output");
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (isOfJobs(entry.path().filename().string())) files.push_back(entry.path());
  for (const fs::path& file : files) fs::remove_all(file);
}

JobPlan planOf(const SubmitOptions& options, bool quiet, std::optional<ResultFolder>& made) {
  const std::vector<std::string>& command = options.command;
  const std::string input = absolute(command[1]);
  CommandWords words(command);
  const auto output = words.take({"-o", "--output"});
  if (!output || output->empty())
    throw Error(ErrorKind::usage, command[0], "-o is missing or empty; say where its results go");
  words.refuse({"-o", "--output"}, "is there twice; say once where its results go");
  const fs::path target = fs::path(absolute(*output) + "/").parent_path();
  words.makeAbsolute("--shaders"), words.makeAbsolute("--asset-root");
  JobPlan plan;
  plan.folder = target.string() + ".jobs";
  plan.inputHash = isDatabaseFile(input) ? TrajectoryReader(input).stateHash() : textHash(readSceneText(input));
  requireOwnFolder(plan.folder, "job", isOfJobs);
  made.emplace(plan.folder);
  if (command[0] == "simulate") {
    if (filmOf(input, {}).isTrajectory)
      throw Error(ErrorKind::usage, input, "is a trajectory; a scene file is simulated");
    addSimulation(input, target.string(), words.options(), plan);
  } else if (command[0] == "sample") {
    planSamples(options.scheduler, input, target.string(), words, quiet, plan);
  } else {
    planPictures(options, input, target.string(), words, plan);
  }
  return plan;
}

/// Jobs leave pictures that are there: those of another scene, or of other options, would be among theirs.
void requireNoPictures(const std::string& folder) {
  std::error_code missing;
  if (folder.empty() || !fs::is_directory(folder, missing)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (parseFrameFile(entry.path().filename().string()))
      throw Error(
          ErrorKind::output, folder,
          "holds pictures that other jobs, or none, have drawn, and jobs leave what is there; name a new folder, "
          "or remove it");
}

}  // namespace

void requireScheduler(const std::string& scheduler) {
  if (scheduler != "slurm" && scheduler != "parallel" && scheduler != "local")
    throw Error(ErrorKind::usage, scheduler, "is no scheduler; allowed are slurm, parallel (GNU parallel) and local");
}

void requireSubmittable(const std::vector<std::string>& command) {
  constexpr std::array kCommands = {"simulate", "render", "video", "sample"};
  if (command.empty() || std::find(kCommands.begin(), kCommands.end(), command[0]) == kCommands.end())
    throw Error(ErrorKind::usage, command.empty() ? "submit" : command[0],
                fmt::format("a command is to follow the scheduler; allowed are {}", fmt::join(kCommands, ", ")));
  if (command.size() < 2 || command[1].starts_with('-'))
    throw Error(ErrorKind::usage, command[0], "its input is to follow the command, before all options");
  if (command[1].empty()) throw Error(ErrorKind::usage, command[0], "its input is empty; name a file");
}

void submitCommand(const SubmitOptions& options, bool quiet) {
  std::optional<ResultFolder> made;
  const JobPlan plan = planOf(options, quiet, made);
  const fs::path folder = plan.folder;
  const std::vector<JobScript> scripts = scriptsOf(options.scheduler, plan);
  if (!areThere(scripts)) {
    requireNoPictures(plan.pictures);
    clearJobs(folder);
    for (const JobScript& script : scripts) writeWholeFile(script.path, script.text);
  }
  const std::string& run = scripts.back().path;
  for (const JobStage& stage : plan.stages)
    show("{}: {} task{}\n", stage.name, stage.tasks, stage.tasks == 1 ? "" : "s");
  if (!options.starts) return show("start them with: sh {}\n", quoted(run));
  flushOutput();
  execlp("sh", "sh", run.c_str(), nullptr);
  throw Error(ErrorKind::output, run, "cannot be started: there is no sh");
}

}  // namespace cradle
