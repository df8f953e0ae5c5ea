#include "commands/simulate_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "render/camera_path.h"
#include "scene/load_scene.h"
#include "scene/named_accuracy.h"
#include "scene/ranges.h"
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

MethodName methodNamed(const std::string& name) {
  for (const auto& [text, method] : kMethodNames)
    if (name == text) return method;
  throw Error(ErrorKind::usage, "--method",
              fmt::format("found \"{}\"; allowed are explicitEuler, semiImplicitEuler, rk4, dop853", name));
}

/// A number, or a word as in scene files.
double accuracyOf(const std::string& text) {
  if (const std::optional<double> named = accuracyNamed(text)) return *named;
  char* end = nullptr;
  const double accuracy = std::strtod(text.c_str(), &end);
  const bool isNumber = end != text.c_str() && *end == '\0';
  if (isNumber && accuracy >= kFinestAccuracy && accuracy <= kCoarsestAccuracy) return accuracy;
  throw Error(
      ErrorKind::usage, "--accuracy",
      fmt::format("found {}; allowed are {} to {}, {}", text, kFinestAccuracy, kCoarsestAccuracy, kAccuracyWords));
}

double requireIn(const Range& range, const char* option, double value) {
  if (range.holds(value)) return value;
  throw Error(
      ErrorKind::usage, option,
      fmt::format("found {}; allowed are numbers of seconds > 0, from {:g} to {:g}", value, range.least, range.most));
}

void apply(const SceneOverrides& overrides, Scene& scene) {
  if (overrides.accuracy) {
    scene.accuracy = accuracyOf(*overrides.accuracy);
    scene.namesAccuracy = true;
  }
  if (overrides.duration) scene.duration = requireIn(kDurations, "--duration", *overrides.duration);
  if (overrides.method) {
    scene.method = Method{};
    scene.method->name = methodNamed(*overrides.method);
    scene.method->where = "--method";
  }
  if (!overrides.timeStep) return;
  if (!scene.method) throw Error(ErrorKind::usage, "--time-step", "found without --method; name the method it is for");
  scene.method->timeStep = requireIn(kTimeSteps, "--time-step", *overrides.timeStep);
}

/// A slip of the command line does not cost a file of another kind, the scene's own for one.
void requireNoOtherFile(const std::string& path) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed || size == 0 || isTrajectoryFile(path)) return;
  throw Error(ErrorKind::output, path, "is there, and is no trajectory: it is not replaced; give another name");
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// ", 10 rods, 1 push": what there is of each kind.
std::string linksOf(const Scene& scene) {
  std::string text;
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) text += ", " + counted(count, one, many);
  };
  add(scene.springs.size(), "spring", "springs"), add(scene.rods.size(), "rod", "rods");
  add(scene.ropes.size(), "rope", "ropes"), add(scene.ballJoints.size(), "ball joint", "ball joints");
  add(scene.hinges.size(), "hinge", "hinges"), add(scene.pushes.size(), "push", "pushes");
  return text;
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
  requireNoOtherFile(output);
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
  const std::string asked = fmt::format("{:.3g}", plan.accuracy), promised = accuracyPromised(plan);
  fmt::print("{}: accuracy {} asked, {}\n{}\n", scenePath, asked, promised == asked ? "and promised" : promised,
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
  const auto dynamic = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                     [](const Body& body) { return body.motion == Motion::dynamic; });
  fmt::print("{}: \"{}\" is in order: {} ({} dynamic){}; {} s, {} frames\n", scenePath, scene.name,
             counted(scene.bodies.size(), "body", "bodies"), dynamic, linksOf(scene), scene.duration,
             lastFrame(scene) + 1);
}

}  // namespace cradle
