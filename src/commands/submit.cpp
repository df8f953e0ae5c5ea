// A command becomes stages: a trajectory, parts of the pictures or samples, a look whether all are there, a film. A
// stage is a script that does one of its tasks, the same for all schedulers; run.sh alone differs. What a task finds
// whole it leaves, so that no scheduler needs to know how far an ended one was.

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
#include <thread>

#include "commands/sample_folder.h"
#include "commands/simulate_scene.h"
#include "core/console.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/output_path.h"
#include "core/part_file.h"
#include "core/read_file.h"
#include "image/child_process.h"
#include "sampling/scene_sampler.h"
#include "trajectory/state_hash.h"
#include "trajectory/trajectory_file.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr long kPicturesOfATask = 60;      // some 30 s at half a second each
constexpr double kMinTaskTime = 30;        // s: a scheduler takes a second or so to start one
constexpr long kMaxTasks = 100'000;        // of a stage, where no scheduler says less
constexpr long kUsualMaxArraySize = 1001;  // of Slurm, unless it is configured; one more than the tasks
constexpr const char* kRunScript = "run.sh";
constexpr const char* kCheck = "check";  // the stage

/// A word of a shell command.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char letter : word)
    if (letter == '\'')
      text += "'\\''";
    else
      text += letter;
  return text + "'";
}

std::string quoted(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += ' ';
    text += quoted(word);
  }
  return text;
}

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
        if (word->starts_with(name + "=")) {
          const std::string value = word->substr(name.size() + 1);
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

/// Tasks that may run beside each other, behind those of the stage before.
struct JobStage {
  std::string name;
  long tasks = 1;
  std::string script;  // of shell commands, in which $task is 1 .. tasks
};

/// What is to be done, and where what belongs to it is kept.
struct JobPlan {
  std::string folder;
  std::string inputHash;
  std::vector<JobStage> stages;
  long processors = 1;  // of a task
};

std::string scriptFile(std::size_t stage, const JobStage& of) {
  return fmt::format("{}_{}.sh", stage + 1, of.name);
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

/// Ends with the name of the first file in a folder that is not there, of those that printf makes of a pattern and
/// numbers.
JobStage checkStage(const std::string& folder, const std::string& pattern, long first, long count) {
  return {kCheck, 1,
          fmt::format(
              "number={}\nwhile [ \"$number\" -lt {} ]; do\n"
              "  file={}/$(printf {} \"$number\")\n"
              "  [ -e \"$file\" ] || {{ echo \"$file is missing; start run.sh again to have it made\" >&2; exit 5; }}\n"
              "  number=$((number + 1))\ndone\n",
              first, first + count, quoted(folder), quoted(pattern))};
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

Film filmOf(const std::string& input, const std::string& assetRoot) {
  const bool isTrajectory = isDatabaseFile(input);
  Film film;
  if (isTrajectory) {
    const TrajectoryReader trajectory(input);
    film.frames = std::max(1L, trajectory.frameCount() - 1);
    film.isTrajectory = true;
    const Scene scene =
        parseScene(trajectory.header().scene, input, modelFilesBeside(trajectory.header().scenePath)).scene;
    film.framesPerSecond = scene.output.framesPerSecond, film.hasTitleCard = scene.titleCard.has_value();
    return film;
  }
  const Scene scene = loadSceneAndWarn(input, {.assetRoot = assetRoot});
  film.frames = std::max(1L, lastFrame(scene));
  film.framesPerSecond = scene.output.framesPerSecond, film.hasTitleCard = scene.titleCard.has_value();
  return film;
}

void addSimulation(const std::string& scene, const std::string& trajectory, const std::vector<std::string>& options,
                   JobPlan& plan) {
  plan.stages.push_back({"simulate", 1, programCall(joined({"simulate", scene, "-o", trajectory}, options)) + "\n"});
}

void planPictures(const std::string& scheduler, const std::string& input, const std::string& output, bool encodes,
                  CommandWords& words, JobPlan& plan) {
  words.refuse(
      {"--frames", "--shard", "--skip-existing", "--overwrite", "--side-by-side"},
      "is not for jobs, which draw all pictures that are not there yet; leave it out, or give the command itself");
  const std::string assetRoot = shownValue(words, {"--asset-root"}).value_or("");
  const Film film = filmOf(input, assetRoot);
  if (encodes && film.hasTitleCard)
    throw Error(ErrorKind::usage, input, "has a title card, which only `cradle video` itself puts before a film");
  const std::string trajectory = film.isTrajectory ? input : (fs::path(plan.folder) / "trajectory.sqlite").string();
  const std::string frames = encodes ? (fs::path(plan.folder) / "frames").string() : output;
  if (!film.isTrajectory) {
    addSimulation(input, trajectory,
                  assetRoot.empty() ? std::vector<std::string>{} : std::vector{std::string("--asset-root"), assetRoot},
                  plan);
    plan.stages.back().script = fmt::format("[ -e {} ] || {}", quoted(trajectory), plan.stages.back().script);
  }
  const long tasks = tasksFor(static_cast<double>(film.frames), kPicturesOfATask, maxTasksOf(scheduler));
  const std::string draw =
      programCall(joined({"render", trajectory, "-o", frames, "--skip-existing"}, words.options()));
  plan.stages.push_back({"render", tasks, fmt::format("{} --shard \"$task/{}\"\n", draw, tasks)});
  plan.stages.push_back(checkStage(frames, "frame_%06d.png", 0, film.frames));
  if (encodes)
    plan.stages.push_back({"encode", 1,
                           fmt::format("{}\n", programCall({"encode", frames, "-o", output, "--frames-per-second",
                                                            fmt::format("{}", film.framesPerSecond)}))});
}

/// s: wall time of one sample, which is made and thrown away.
double timeOfASample(const std::string& scene, const CommandWords& words, long count, const std::string& folder) {
  const std::string pilot = (fs::path(folder) / "pilot").string();
  std::vector<std::string> command = {programPath(), "sample", scene, "-o", pilot, "-n", std::to_string(count)};
  command = joined(joined(command, words.options()), {"--shard", fmt::format("1/{}", count), "-q"});
  const auto start = std::chrono::steady_clock::now();
  ChildProcess sample(command);
  const int code = sample.finish();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fs::remove_all(pilot);
  if (code != 0 && code != static_cast<int>(ErrorKind::unstable))
    throw Error(static_cast<ErrorKind>(code), "",
                fmt::format("a first sample, to see how long one takes, failed: {}", sample.standardError()));
  return seconds;
}

void planSamples(const std::string& scheduler, const std::string& scene, const std::string& output, CommandWords& words,
                 bool quiet, JobPlan& plan) {
  words.refuse({"--shard"}, "is what the jobs divide the samples by; leave it out");
  const long count = wholeNumber("-n", words.take({"-n", "--count"}), 1);
  const auto format = words.take({"--format"});
  const auto chains = words.take({"--chains"});
  plan.processors = wholeNumber("-j", shownValue(words, {"-j", "--processes"}), 1);
  const SceneSampler sampler(scene);
  if (!quiet) show(stderr, "Making one sample, to see how long they take\n");
  const double time = timeOfASample(scene, words, count, plan.folder);
  const long most = std::min(maxTasksOf(scheduler), chains ? wholeNumber("--chains", chains, 1) : count);
  const long tasks =
      tasksFor(time * static_cast<double>(count) / static_cast<double>(plan.processors), kMinTaskTime, most);
  std::vector<std::string> make = joined({"sample", scene, "-o", output, "-n", std::to_string(count)}, words.options());
  if (chains) make = joined(make, {"--chains", *chains});
  if (format) make = joined(make, {"--format", *format});
  // A sample that becomes unstable is told in its record, and is there.
  plan.stages.push_back({"sample", tasks,
                         fmt::format("{} --shard \"$task/{}\" || [ $? = {} ]\n", programCall(make), tasks,
                                     static_cast<int>(ErrorKind::unstable))});
  if (format != "tar") {
    plan.stages.push_back(checkStage(output, "sample_%06d/sample.json", 0, count));
    return;
  }
  plan.stages.back().script = fmt::format("[ -e {}/samples_\"$task\"_of_{}.tar ] || {{\n{}}}\n", quoted(output), tasks,
                                          plan.stages.back().script);
  plan.stages.push_back(checkStage(output, fmt::format("samples_%d_of_{}.tar", tasks), 1, tasks));
}

bool isOfJobs(const std::string& name) {
  return name.ends_with(".sh") || name.ends_with(".log") || name.starts_with("trajectory.sqlite") || name == "frames";
}

/// Removes what earlier jobs have left in their folder: they were others.
void clearJobs(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (isOfJobs(entry.path().filename().string())) files.push_back(entry.path());
  for (const fs::path& file : files) fs::remove_all(file);
}

JobPlan planOf(const SubmitOptions& options, bool quiet, std::optional<ResultFolder>& made) {
  constexpr std::array kCommands = {"simulate", "render", "video", "sample"};
  const std::vector<std::string>& command = options.command;
  if (command.empty() || std::find(kCommands.begin(), kCommands.end(), command[0]) == kCommands.end())
    throw Error(ErrorKind::usage, command.empty() ? "submit" : command[0],
                fmt::format("a command is to follow the scheduler; allowed are {}", fmt::join(kCommands, ", ")));
  if (command.size() < 2 || command[1].starts_with('-'))
    throw Error(ErrorKind::usage, command[0], "its input is to follow the command, before all options");
  const std::string input = absolute(command[1]);
  CommandWords words(command);
  const auto output = words.take({"-o", "--output"});
  if (!output) throw Error(ErrorKind::usage, command[0], "-o is missing; say where its results go");
  const fs::path target = fs::path(absolute(*output) + "/").parent_path();
  words.makeAbsolute("--shaders"), words.makeAbsolute("--asset-root");
  JobPlan plan;
  plan.folder = target.string() + ".jobs";
  plan.inputHash = isDatabaseFile(input) ? TrajectoryReader(input).stateHash() : textHash(readSceneText(input));
  requireOwnFolder(plan.folder, "job", isOfJobs);
  made.emplace(plan.folder);
  if (command[0] == "simulate") {
    filmOf(input, "");
    addSimulation(input, target.string(), words.options(), plan);
  } else if (command[0] == "sample") {
    planSamples(options.scheduler, input, target.string(), words, quiet, plan);
  } else {
    planPictures(options.scheduler, input, target.string(), command[0] == "video", words, plan);
  }
  return plan;
}

/// The script of a stage: $task is what the scheduler says, or its first argument.
std::string stageText(const JobPlan& plan, std::size_t number) {
  const JobStage& stage = plan.stages[number];
  const std::string log = quoted((fs::path(plan.folder) / fmt::format("{}_{}_", number + 1, stage.name)).string());
  std::string text = "#!/bin/sh\n";
  // Without --time, account and partition: those are of the site, which SBATCH_TIMELIMIT, SBATCH_ACCOUNT and
  // SBATCH_PARTITION name.
  text += fmt::format("#SBATCH --job-name=cradle-{}\n#SBATCH --requeue\n#SBATCH --open-mode=append\n", stage.name);
  text += fmt::format("#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={}\n#SBATCH --output=/dev/null\n", plan.processors);
  if (stage.tasks > 1) text += fmt::format("#SBATCH --array=1-{}\n", stage.tasks);
  return text +
         fmt::format("task=${{SLURM_ARRAY_TASK_ID:-${{1:-1}}}}\nexec >>{}\"$task.log\" 2>&1\n{}", log, stage.script);
}

/// Starts the stages one after the other, and tells which has not come to its end.
std::string runText(const std::string& scheduler, const JobPlan& plan) {
  std::string text = fmt::format(
      "#!/bin/sh\n# Does all that is not there yet; may be started again at any time.\n"
      "# Of an input with the hash {}.\ncd {} || exit 5\n",
      plan.inputHash, quoted(plan.folder));
  std::string after;
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const JobStage& stage = plan.stages[i];
    const std::string script = scriptFile(i, stage);
    if (scheduler == "slurm") {
      text +=
          fmt::format("job=$(sbatch --parsable{} ./{}) || exit 5\njob=${{job%%;*}}\necho \"{}: job $job, {} task{}\"\n",
                      after, script, stage.name, stage.tasks, stage.tasks == 1 ? "" : "s");
      after = " --dependency=\"afterok:$job\" --kill-on-invalid-dep=yes";
      continue;
    }
    const std::string numbers = fmt::format("seq {} | ", stage.tasks);
    text += scheduler == "parallel" ? fmt::format("{}parallel --joblog {}_{}.joblog.log --resume-failed sh ./{} {{}}",
                                                  numbers, i + 1, stage.name, script)
                                    : fmt::format("{}xargs -P \"$(nproc)\" -I{{}} sh ./{} {{}}", numbers, script);
    // What is missing was made once, as the logs of GNU parallel say: all tasks look again for what they lack.
    const bool forgets = scheduler == "parallel" && stage.name == kCheck;
    text += fmt::format(
        " ||\n  {{ {}echo \"{} has not come to its end, see {}_{}_*.log in $PWD; start $0 again to go on\" >&2; exit "
        "5; "
        "}}\n",
        forgets ? "rm -f ./*.joblog.log; " : "", stage.name, i + 1, stage.name);
  }
  return text;
}

void requireScheduler(const std::string& scheduler) {
  if (scheduler != "slurm" && scheduler != "parallel" && scheduler != "local")
    throw Error(ErrorKind::usage, scheduler, "is no scheduler; allowed are slurm, parallel (GNU parallel) and local");
}

}  // namespace

void submitCommand(const SubmitOptions& options, bool quiet) {
  requireScheduler(options.scheduler);
  std::optional<ResultFolder> made;
  const JobPlan plan = planOf(options, quiet, made);
  const fs::path folder = plan.folder;
  const std::string run = (folder / kRunScript).string(), text = runText(options.scheduler, plan);
  if (!holdsText(run, text)) clearJobs(folder);
  for (std::size_t i = 0; i < plan.stages.size(); ++i)
    writeWholeFile((folder / scriptFile(i, plan.stages[i])).string(), stageText(plan, i));
  writeWholeFile(run, text);
  for (const JobStage& stage : plan.stages)
    show("{}: {} task{}\n", stage.name, stage.tasks, stage.tasks == 1 ? "" : "s");
  if (!options.starts) return show("start them with: sh {}\n", quoted(run));
  flushOutput();
  execlp("sh", "sh", run.c_str(), nullptr);
  throw Error(ErrorKind::output, run, "cannot be started: there is no sh");
}

}  // namespace cradle
