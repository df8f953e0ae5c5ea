// Prints "NAME SECONDS HASH" for each scene: the stateHash of its first seconds. Only the physics is linked, so that
// one more compiler, or one more level of optimisation, costs a small build.
//
//     state_hashes SECONDS SCENE...

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "core/error.h"
#include "scene/load_scene.h"
#include "simulate/simulate.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

std::string stateHash(const std::string& path, double seconds) {
  Scene scene = loadScene(path).scene;
  scene.duration = std::min(scene.duration, seconds);
  Hash hash;
  simulate(scene, {[&](const Frame& frame) { addFrame(frame, hash); }, [](const Event&) {}, [](const std::string&) {}});
  return hash.hex();
}

void printHashes(int count, const char* const* arguments) {
  const double seconds = std::stod(arguments[1]);
  for (int i = 2; i < count; ++i) {
    const std::string name = std::filesystem::path(arguments[i]).stem().string();
    fmt::print("{} {} {}\n", name, seconds, stateHash(arguments[i], seconds));
  }
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  try {
    cradle::printHashes(count, arguments);
  } catch (const cradle::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.kind());
  }
}
