// Scenes thrown together at random, each in a process of its own, two at a time: what goes wrong in them. Usage:
// random_scenes COUNT [FIRST] runs scenes FIRST (0) to FIRST + COUNT - 1; random_scenes --text NUMBER prints the scene;
// random_scenes --file SCENE runs a scene file in its place.

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "core/error.h"
#include "core/progress.h"
#include "experiments/random_scene.h"
#include "experiments/random_scene_figures.h"
#include "scene/load_scene.h"

namespace cradle {
namespace {

constexpr rlim_t kMostSeconds = 20;  // CPU time of a scene
constexpr int kAtOnce = 2;

Scene randomScene(unsigned number) {
  return parseScene(randomSceneText(number), "random.json", modelFilesBeside("random.json")).scene;
}

/// One line; what is wrong comes first.
std::string lineOf(const Scene& scene) {
  const RandomSceneFigures figures = runRandomScene(scene);
  const std::vector<std::string> faults = faultsOf(figures, scene.accuracy);
  return fmt::format(
      "{}|{} bodies, accuracy {:g}{}: energy {:+.1e}, balance {:.1e}, penetration {:.1e} m, ties {:.1e}, {:.2f} s",
      fmt::join(faults, "; "), scene.bodies.size(), scene.accuracy, figures.keepsAccuracy ? "" : " not kept",
      figures.energyGain / figures.energyScale, figures.energyError / figures.energyScale, figures.penetration,
      figures.tieError, figures.cpuSeconds);
}

template <class MakeScene>
std::string lineOrError(const MakeScene& makeScene) {
  try {
    return lineOf(makeScene());
  } catch (const Error& error) {
    return fmt::format("ends with exit code {}: {}|", static_cast<int>(error.kind()), error.what());
  }
}

/// Runs in a process of its own; the end of its pipe that is read comes back.
int start(unsigned number, pid_t& process) {
  std::array<int, 2> pipeEnds{};
  if (pipe(pipeEnds.data()) != 0) std::abort();
  process = fork();
  if (process == 0) {
    const rlimit limit{kMostSeconds, kMostSeconds + 1};
    setrlimit(RLIMIT_CPU, &limit);
    const std::string line = lineOrError([&] { return randomScene(number); }).substr(0, 4000);  // a pipe holds more
    if (write(pipeEnds[1], line.data(), line.size()) < 0) _exit(1);
    _exit(0);
  }
  close(pipeEnds[1]);
  return pipeEnds[0];
}

std::string readAll(int end) {
  std::array<char, 4096> buffer{};
  const ssize_t size = read(end, buffer.data(), buffer.size());
  close(end);
  return {buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

/// Waits for a scene to end; prints what went wrong. True if nothing did.
bool finish(std::map<pid_t, std::pair<unsigned, int>>& running, Progress& progress) {
  int status = 0;
  const pid_t ended = wait(&status);
  const auto [number, end] = running.at(ended);
  running.erase(ended);
  std::string line = readAll(end);
  if (WIFSIGNALED(status))
    line = WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL
               ? fmt::format("takes more than {} s|", kMostSeconds)
               : fmt::format("crashes with signal {}|", WTERMSIG(status));
  else if (WEXITSTATUS(status) != 0)
    line = fmt::format("ends with exit code {}|", WEXITSTATUS(status));
  const std::size_t bar = line.find('|');
  if (bar == 0) return true;
  progress.endLine();
  fmt::print("scene {}: {}\n    {}\n", number, line.substr(0, bar), line.substr(bar + 1));
  std::fflush(stdout);
  return false;
}

int runScenes(unsigned count, unsigned first) {
  Progress progress("Random scenes", "scenes", count, false);
  std::map<pid_t, std::pair<unsigned, int>> running;
  unsigned done = 0, bad = 0;
  for (unsigned next = 0; done < count;) {
    while (next < count && std::ssize(running) < kAtOnce) {
      pid_t process = 0;
      const int end = start(first + next, process);
      running[process] = {first + next, end};
      ++next;
    }
    bad += finish(running, progress) ? 0U : 1U;
    progress.update(++done);
  }
  progress.endLine();
  fmt::print("{} of {} scenes are as they should be\n", count - bad, count);
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  const std::string what = count > 1 ? arguments[1] : "1000", which = count > 2 ? arguments[2] : "0";
  if (what == "--text") {
    fmt::print("{}\n", cradle::randomSceneText(static_cast<unsigned>(std::stoul(which))));
    return 0;
  }
  if (what == "--file") {
    fmt::print("{}\n", cradle::lineOrError([&] { return cradle::loadScene(which).scene; }));
    return 0;
  }
  return cradle::runScenes(static_cast<unsigned>(std::stoul(what)), static_cast<unsigned>(std::stoul(which)));
}
