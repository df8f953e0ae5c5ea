// A scene simulated by another engine, as a trajectory file: to be measured, compared and drawn as our own are.
//
//     peer_trajectory SCENE METHOD SETTING FILE.sqlite     METHOD: bullet, odeQuick, ... (docs/study.md); SETTING: its
//                                                          time step in s, or its accuracy
//
// Energies in the file know no dissipation.

#include <fmt/format.h>

#include <cstdlib>

#include "core/error.h"
#include "scene/load_scene.h"
#include "simulate/simulate.h"
#include "study/peers/peer_run.h"
#include "study/study_method.h"
#include "trajectory/trajectory_file.h"

namespace cradle {
namespace {

void runInto(const std::string& scenePath, const std::string& methodName, double setting, const std::string& path) {
  const Scene scene = loadScene(scenePath).scene;
  const StudyMethod method = studyMethodsNamed({methodName}).front();
  if (!method.peer) throw Error(ErrorKind::usage, methodName, "is no method of another engine");
  const Assembly assembly = assemble(scene, wholeScene(scene));
  if (const std::string what = method.peer->missingIn(scene, assembly); !what.empty())
    throw Error(ErrorKind::scene, scenePath, method.peer->engine + " does not have " + what);

  TrajectoryHeader header = headerOf(scene, planOf(scene));
  header.method = header.plan = fmt::format("{} at {}", method.title, setting);
  header.accuracy = "not promised";
  TrajectoryWriter writer(path, header);
  const auto take = [&](const Frame& frame) { writer.append(frame); };
  writer.finish(runPeer(*method.peer, setting, scene, assembly, take));
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  if (count != 5) {
    fmt::print(stderr, "usage: peer_trajectory SCENE METHOD SETTING FILE.sqlite\n");
    return 2;
  }
  try {
    cradle::runInto(arguments[1], arguments[2], std::strtod(arguments[3], nullptr), arguments[4]);
  } catch (const cradle::Error& error) {
    fmt::print(stderr, "peer_trajectory: {}\n", error.what());
    return static_cast<int>(error.kind());
  }
}
