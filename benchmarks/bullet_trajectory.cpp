// A scene simulated by Bullet, as a trajectory file: to be measured, compared and drawn as our own are.
//
//     bullet_trajectory SCENE METHOD TIME_STEP FILE.sqlite     METHOD: bullet, bullet100, bulletTuned or bulletTuned100
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

void runInto(const std::string& scenePath, const std::string& methodName, double timeStep, const std::string& path) {
  const Scene scene = loadScene(scenePath).scene;
  const StudyMethod method = studyMethodsNamed({methodName}).front();
  if (!method.bullet) throw Error(ErrorKind::usage, methodName, "is no method of Bullet");
  if (const std::string what = missingInBullet(scene); !what.empty())
    throw Error(ErrorKind::scene, scenePath, "Bullet does not have " + what);
  const Assembly assembly = assemble(scene, wholeScene(scene));

  TrajectoryHeader header = headerOf(scene);
  header.method = header.plan = fmt::format("{}, step {} s", method.title, timeStep);
  header.accuracy = "not promised";
  TrajectoryWriter writer(path, header);
  const auto take = [&](const Frame& frame) { writer.append(frame); };
  writer.finish(runBullet(scene, assembly, *method.bullet, timeStep, take));
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  if (count != 5) {
    fmt::print(stderr, "usage: bullet_trajectory SCENE METHOD TIME_STEP FILE.sqlite\n");
    return 2;
  }
  try {
    cradle::runInto(arguments[1], arguments[2], std::strtod(arguments[3], nullptr), arguments[4]);
  } catch (const cradle::Error& error) {
    fmt::print(stderr, "bullet_trajectory: {}\n", error.what());
    return static_cast<int>(error.kind());
  }
}
