// Scenes thrown together at random, each in a process of its own: what goes wrong in them (--help).

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/progress.h"
#include "experiments/random_scene.h"
#include "experiments/random_scene_figures.h"
#include "experiments/random_sketch.h"
#include "experiments/sketch_oracles.h"
#include "scene/load_scene.h"

namespace cradle {
namespace {

constexpr rlim_t kMaxThrownSeconds = 20;     // CPU time of a scene
constexpr rlim_t kMaxSketchSeconds = 60;     // with all its runs, up to some thirty
constexpr std::size_t kMaxCharacters = 600;  // of a message: a pipe holds them all
constexpr unsigned kFamilies = kSketchFamilyNames.size();

/// What to run, and where to leave it.
struct Order {
  std::string family = "thrown", folder, file;
  std::optional<unsigned> text;
  int atOnce = 2;
  unsigned count = 1000, first = 0;
};

/// One scene of an order: thrown, or of a family of sketches.
struct Task {
  std::optional<SketchFamily> family;
  unsigned number = 0;

  std::string name() const {
    return fmt::format("{} {}", family ? kSketchFamilyNames[static_cast<std::size_t>(*family)] : "thrown", number);
  }
  rlim_t mostSeconds() const { return family ? kMaxSketchSeconds : kMaxThrownSeconds; }
  std::string text() const { return family ? textOf(randomSketch(*family, number)) : randomSceneText(number); }
};

Task taskOf(const Order& order, unsigned number) {
  if (order.family == "thrown") return {{}, number};
  if (order.family == "all") {
    const unsigned kind = number % (kFamilies + 1);
    if (kind == kFamilies) return {{}, number / (kFamilies + 1)};
    return {static_cast<SketchFamily>(kind), number / (kFamilies + 1)};
  }
  const auto found = std::find(kSketchFamilyNames.begin(), kSketchFamilyNames.end(), order.family);
  return {static_cast<SketchFamily>(found - kSketchFamilyNames.begin()), number};
}

/// One line; what is wrong comes first.
std::string lineOf(const Scene& scene) {
  const RandomSceneFigures figures = runRandomScene(scene);
  const std::vector<std::string> faults = faultsOf(figures, scene.accuracy);
  return fmt::format(
      "{}|{} bodies, accuracy {:g}{}: energy {:+.1e}, balance {:.1e}, penetration {:.1e} m, ties {:.1e}, {:.2f} s",
      fmt::join(faults, "; "), scene.bodies.size(), scene.accuracy, figures.keepsAccuracy ? "" : " not kept",
      figures.energyGain / figures.energyScale, figures.energyError / figures.energyScale, figures.penetration,
      figures.constraintError, figures.cpuSeconds);
}

template <class MakeScene>
std::string lineOrError(const MakeScene& makeScene) {
  try {
    return lineOf(makeScene());
  } catch (const Error& error) {
    return fmt::format("ends with exit code {}: {}|", static_cast<int>(error.kind()), error.what());
  }
}

void save(const Order& order, const Task& task, const std::string& oracle, const std::string& text) {
  if (order.folder.empty()) return;
  std::string name = task.name() + " " + oracle;
  std::replace(name.begin(), name.end(), ' ', '_');
  std::ofstream(order.folder + "/" + name + ".json") << text;
}

/// "begin WHAT" lines, and at last what comes of it, as in lineOf; a process that is killed has told what it began.
std::string checkLine(const Order& order, const Task& task, const std::function<void(const std::string&)>& begin) {
  const SceneSketch sketch = randomSketch(*task.family, task.number);
  const std::vector<SketchFault> faults = checkSketch(sketch, begin);
  std::string line;
  for (const SketchFault& fault : faults) {
    save(order, task, fault.oracle, textOf(sketch));
    line += fmt::format("{}{}: {}", line.empty() ? "" : "; ", fault.oracle, fault.text.substr(0, kMaxCharacters));
  }
  if (order.folder.empty() || faults.empty()) return line + "|";
  begin(line + "|not reduced");
  for (const SketchFault& fault : faults) save(order, task, fault.oracle, textOf(reduceSketch(sketch, fault.oracle)));
  return line + "|";
}

void runTask(const Order& order, const Task& task, int pipeEnd) {
  const auto say = [&](const std::string& line) {
    if (write(pipeEnd, line.data(), line.size()) < 0) _exit(1);
  };
  if (!task.family) {
    const auto scene = [&] {
      return parseScene(randomSceneText(task.number), "random.json", modelFilesBeside("random.json")).scene;
    };
    say(lineOrError(scene).substr(0, 4 * kMaxCharacters));
    return;
  }
  say(checkLine(order, task, [&](const std::string& what) { say(what + "\n"); }));
}

/// Runs in a process of its own; the end of its pipe that is read comes back.
int start(const Order& order, const Task& task, pid_t& process) {
  std::array<int, 2> pipeEnds{};
  if (pipe(pipeEnds.data()) != 0) std::abort();
  process = fork();
  if (process == 0) {
    const rlimit limit{task.mostSeconds(), task.mostSeconds() + 1};
    setrlimit(RLIMIT_CPU, &limit);
    runTask(order, task, pipeEnds[1]);
    _exit(0);
  }
  close(pipeEnds[1]);
  return pipeEnds[0];
}

std::string readAll(int end) {
  std::string all;
  std::array<char, 4096> buffer{};
  for (ssize_t size = 0; (size = read(end, buffer.data(), buffer.size())) > 0;)
    all.append(buffer.data(), static_cast<std::size_t>(size));
  close(end);
  return all;
}

/// The last line of a text that may end with an end of line.
std::string lastLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

struct Running {
  Task task;
  int pipeEnd = 0;
};

/// Waits for a scene to end; prints what went wrong. True if nothing did.
bool finish(const Order& order, std::map<pid_t, Running>& running, Progress& progress) {
  int status = 0;
  const pid_t ended = wait(&status);
  const auto [task, end] = running.at(ended);
  running.erase(ended);
  std::string line = lastLine(readAll(end));
  // What a scene showed before it took too long to reduce is all that there is to know.
  const bool isKnown = line.ends_with("|not reduced");
  const std::string begun = task.family ? fmt::format("|in {}", line) : "|";
  const bool isKilled = WIFSIGNALED(status), isFailed = isKilled || WEXITSTATUS(status) != 0;
  if (isKilled && !isKnown)
    line = WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL
               ? fmt::format("takes more than {} s{}", task.mostSeconds(), begun)
               : fmt::format("crashes with signal {}{}", WTERMSIG(status), begun);
  else if (isFailed && !isKnown)
    line = fmt::format("ends with exit code {}{}", WEXITSTATUS(status), begun);
  if (isFailed && !isKnown) save(order, task, "ends badly", task.text());
  const std::size_t bar = line.find('|');
  if (bar == 0) return true;
  progress.endLine();
  fmt::print("{}: {}\n    {}\n", task.name(), line.substr(0, bar), line.substr(bar + 1));
  std::fflush(stdout);
  return false;
}

int runScenes(const Order& order) {
  Progress progress("Random scenes", "scenes", order.count, false);
  std::map<pid_t, Running> running;
  unsigned done = 0, bad = 0;
  for (unsigned next = 0; done < order.count;) {
    while (next < order.count && std::ssize(running) < order.atOnce) {
      const Task task = taskOf(order, order.first + next);
      pid_t process = 0;
      const int end = start(order, task, process);
      running[process] = {task, end};
      ++next;
    }
    bad += finish(order, running, progress) ? 0U : 1U;
    progress.update(++done);
  }
  progress.endLine();
  fmt::print("{} of {} scenes are as they should be\n", order.count - bad, order.count);
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  CLI::App app("Scenes thrown together at random, each in a process of its own, and what goes wrong in them.");
  cradle::Order order;
  std::vector<std::string> families{"thrown", "all"};
  families.insert(families.end(), cradle::kSketchFamilyNames.begin(), cradle::kSketchFamilyNames.end());
  app.add_option("--family", order.family, "a family of scenes; of all, each in its turn")
      ->check(CLI::IsMember(families))
      ->capture_default_str();
  app.add_option("-j", order.atOnce, "processes at once")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("-o", order.folder, "a folder for what fails: FAMILY_NUMBER_ORACLE.json, reduced")
      ->check(CLI::ExistingDirectory);
  app.add_option("--text", order.text, "prints the scene of that number, and runs nothing");
  app.add_option("--file", order.file, "runs a scene file with the oracles of the family thrown")
      ->check(CLI::ExistingFile);
  app.add_option("COUNT", order.count, "how many scenes")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("FIRST", order.first, "number of the first")->capture_default_str();
  app.footer("Example: random_scenes --family pinned -j 4 120 33000");
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (order.text) {
    fmt::print("{}\n", cradle::taskOf(order, *order.text).text());
    return 0;
  }
  if (!order.file.empty()) {
    fmt::print("{}\n", cradle::lineOrError([&] { return cradle::loadScene(order.file).scene; }));
    return 0;
  }
  return cradle::runScenes(order);
}
