#include "commands/simulate_scene.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "render/camera_path.h"
#include "scene/load_scene.h"
#include "simulate/assembly.h"
#include "simulate/plan/plan_text.h"
#include "simulate/simulate.h"
#include "simulate/start_overlaps.h"
#include "study/achieved_accuracy.h"
#include "trajectory/trajectory_file.h"

namespace cradle {
namespace {

constexpr std::array<std::pair<const char*, MethodName>, 4> kMethodNames = {
    {{"explicitEuler", MethodName::explicitEuler},
     {"semiImplicitEuler", MethodName::semiImplicitEuler},
     {"rk4", MethodName::rk4},
     {"dop853", MethodName::dop853}}};
constexpr double kFinestAccuracy = 1e-12, kCoarsestAccuracy = 1e-2;  // as in scene files

MethodName methodNamed(const std::string& name) {
  for (const auto& [text, method] : kMethodNames)
    if (name == text) return method;
  throw Error(ErrorKind::usage, "--method",
              fmt::format("found \"{}\"; allowed are explicitEuler, semiImplicitEuler, rk4, dop853", name));
}

double requirePositive(const char* option, double value) {
  if (value > 0 && std::isfinite(value)) return value;
  throw Error(ErrorKind::usage, option, fmt::format("found {}; allowed are numbers of seconds > 0", value));
}

void apply(const SceneOverrides& overrides, Scene& scene) {
  if (overrides.accuracy) {
    if (!(*overrides.accuracy >= kFinestAccuracy && *overrides.accuracy <= kCoarsestAccuracy))
      throw Error(
          ErrorKind::usage, "--accuracy",
          fmt::format("found {}; allowed are {} to {}", *overrides.accuracy, kFinestAccuracy, kCoarsestAccuracy));
    scene.accuracy = *overrides.accuracy;
    scene.namesAccuracy = true;
  }
  if (overrides.duration) scene.duration = requirePositive("--duration", *overrides.duration);
  if (overrides.method) {
    scene.method = Method{};
    scene.method->name = methodNamed(*overrides.method);
    scene.method->where = "--method";
  }
  if (!overrides.timeStep) return;
  if (!scene.method) throw Error(ErrorKind::usage, "--time-step", "found without --method; name the method it is for");
  scene.method->timeStep = requirePositive("--time-step", *overrides.timeStep);
}

void printAchievedAccuracy(const Scene& scene, const std::string& output, bool quiet) {
  const TrajectoryReader run(output);
  Progress progress("Checking", "frames", run.frameCount(), quiet);
  try {
    const AchievedAccuracy accuracy = achievedAccuracy(scene, run, [&](long done) {
      throwIfInterrupted();
      progress.update(done);
    });
    progress.endLine();
    fmt::print("{}\n", describe(accuracy));
  } catch (const Error& error) {
    throw Error(error.kind(), "", fmt::format("{}; {} is whole, but its accuracy is not known", error.what(), output));
  }
}

}  // namespace

void warn(const std::string& warning) {
  fmt::print(stderr, "warning: {}\n", warning);
}

Scene loadSceneAndWarn(const std::string& path, const SceneOverrides& overrides) {
  LoadedScene loaded = loadScene(path);
  for (const std::string& warning : loaded.warnings) warn(warning);
  apply(overrides, loaded.scene);
  requireUsableCamera(loaded.scene);
  return std::move(loaded.scene);
}

void simulateInto(TrajectoryWriter& writer, const Scene& scene, bool quiet) {
  Progress progress("Simulating", "frames", lastFrame(scene) + 1, quiet);
  const SimulationSink sink{[&](const Frame& frame) {
                              writer.append(frame);
                              progress.update(frame.number + 1);
                            },
                            [&](const Event& event) { writer.append(event); },
                            [&](const std::string& warning) {
                              progress.endLine();
                              warn(warning);
                            }};
  const RunCost cost = simulate(scene, sink);
  writer.finish(cost);
}

void simulateScene(const std::string& scenePath, const std::string& output, const SimulateOptions& options,
                   bool quiet) {
  requireWritableFile(output);
  const Scene scene = loadSceneAndWarn(scenePath, options.overrides);
  refuseUnsupported(scene);
  TrajectoryWriter writer(output, headerOf(scene));
  try {
    simulateInto(writer, scene, quiet);
  } catch (const Error& error) {
    const std::string kept = writer.keptPath();
    if (kept.empty()) throw;
    throw Error(error.kind(), "", fmt::format("{}; the frames up to then are in {}", error.what(), kept));
  }
  if (options.checksAccuracy) printAchievedAccuracy(scene, output, quiet);
}

void printPlan(const std::string& scenePath, const SceneOverrides& overrides) {
  const Scene scene = loadSceneAndWarn(scenePath, overrides);
  refuseUnsupported(scene);
  const Plan plan = planOf(scene);
  fmt::print("{}: accuracy {:.3g} asked, {}\n{}\n", scenePath, plan.accuracy, accuracyPromised(plan),
             describe(plan, scene));
}

void checkScene(const std::string& scenePath) {
  const Scene scene = loadSceneAndWarn(scenePath, {});
  refuseUnsupported(scene);
  std::vector<Assembly> islands;
  for (const IslandPlan& island : planOf(scene).islands) islands.push_back(assemble(scene, island));
  settleStartOverlaps(scene, islands);
  for (const Assembly& assembly : islands)
    for (const std::string& warning : assembly.warnings) warn(warning);
  std::size_t dynamic = 0;
  for (const Body& body : scene.bodies) dynamic += body.motion == Motion::dynamic ? 1 : 0;
  fmt::print("{}: \"{}\" is in order: {} bodies ({} dynamic), {} springs, {} rods; {} s, {} frames\n", scenePath,
             scene.name, scene.bodies.size(), dynamic, scene.springs.size(), scene.rods.size(), scene.duration,
             lastFrame(scene) + 1);
}

}  // namespace cradle
