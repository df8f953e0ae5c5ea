// Prints "NAME SECONDS HASH" for each scene and each of the ascending times: the stateHash of the frames until then.
// Only the physics is linked, so that one more compiler, or one more level of optimisation, costs a small build.
//
//     state_hashes SECONDS... -- SCENE...

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "scene/load_scene.h"
#include "simulate/simulate.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

constexpr double kRounding = 1e-9;  // s, of frame times
constexpr double kDuration = 2;     // s, of all runs, whatever is asked: bits depend on where a run would end

struct Done {};

/// One run a scene, until all times are past: they are looked at on the way.
void printHashes(const std::string& path, const std::vector<double>& times) {
  Scene scene = loadScene(path).scene;
  scene.duration = std::min(scene.duration, kDuration);
  const std::string name = std::filesystem::path(path).stem().string();
  Hash hash;
  std::size_t next = 0;
  const auto printUntil = [&](double time) {
    for (; next < times.size() && times[next] < time; ++next) fmt::print("{} {} {}\n", name, times[next], hash.hex());
  };
  const auto take = [&](const Frame& frame) {
    printUntil(frame.time - kRounding);
    if (next == times.size()) throw Done();
    addFrame(frame, hash);
  };
  try {
    simulate(scene, {take, [](const Event&) {}, [](const std::string&) {}});
  } catch (const Done&) {
  }
  printUntil(std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  try {
    char** const end = arguments + count;
    char** const scenes = std::find(arguments + 1, end, std::string("--"));
    std::vector<double> times;
    for (char** time = arguments + 1; time != scenes; ++time) times.push_back(std::stod(*time));
    for (char** scene = scenes + 1; scene < end; ++scene) cradle::printHashes(*scene, times);
  } catch (const cradle::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.kind());
  }
}
