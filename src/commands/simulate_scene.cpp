#include "commands/simulate_scene.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "commands/body_list.h"
#include "commands/run_cameras.h"
#include "commands/warnings.h"
#include "core/console.h"
#include "core/cpu_stopwatch.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/part_lock.h"
#include "core/printable.h"
#include "core/progress.h"
#include "overlay/caption_check.h"
#include "render/camera_path.h"
#include "scene/count_bodies.h"
#include "scene/load_scene.h"
#include "scene/named_accuracy.h"
#include "scene/parse_settings.h"
#include "scene/ranges.h"
#include "simulate/assembly.h"
#include "simulate/simulate.h"
#include "simulate/start_overlaps.h"
#include "simulate/strict_watch.h"
#include "simulate/world.h"
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

void apply(const SceneOptions& options, Scene& scene) {
  if (options.accuracy) {
    scene.accuracy = accuracyOf(*options.accuracy);
    scene.namesAccuracy = true;
  }
  if (options.duration) scene.duration = requireIn(kDurations, "--duration", *options.duration);
  if (options.method) {
    scene.method = Method{};
    scene.method->name = methodNamed(*options.method);
    scene.method->where = "--method";
  }
  if (options.timeStep) {
    if (!scene.method)
      throw Error(ErrorKind::usage, "--time-step", "found without --method; name the method it is for");
    scene.method->timeStep = requireIn(kTimeSteps, "--time-step", *options.timeStep);
  }
  if (const auto fault = frameCountFault(scene)) throw Error(ErrorKind::usage, "--duration", *fault);
  if (const auto fault = stepCountFault(scene))
    throw Error(ErrorKind::usage, options.timeStep ? "--time-step" : "--duration", *fault);
}

/// A slip of the command line does not cost a file of another kind, the scene's own for one.
void requireNoOtherFile(const std::string& path) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed || size == 0 || isTrajectoryFile(path)) return;
  throw Error(ErrorKind::output, path, "is there, and is no trajectory: it is not replaced; give another name");
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// ", 10 rods, 1 push": what there is of each kind.
std::string linksOf(const Scene& scene) {
  std::string text;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) text += ", " + counted(count, one, many);
  };
  forEachKindOfLink(scene, [&](const auto& links) {
    const std::string noun = LinkOf<decltype(links)>::kNoun;
    add(links.size(), noun, noun + "s");
  });
  add(scene.pushes.size(), "push", "pushes");
  return text;
}

void checkAccuracy(const Scene& scene, const std::string& output, bool prints, bool quiet) {
  const TrajectoryReader run(output);
  Progress progress("Checking", "frames", run.frameCount(), quiet);
  try {
    const AchievedAccuracy accuracy = achievedAccuracy(scene, run, [&](long done) {
      throwIfInterrupted();
      progress.update(done);
    });
    progress.endLine();
    addToMeta(output, kHorizonKey, accuracy.horizon ? std::to_string(accuracy.horizon->frame) : "none");
    if (prints) show("{}\n", describe(accuracy));
  } catch (const Error& error) {
    throw Error(error.kind(), "", fmt::format("{}; {} is whole, but its accuracy is not known", error.what(), output));
  }
}

}  // namespace

Scene loadSceneAndWarn(const std::string& path, const SceneOptions& options) {
  LoadedScene loaded = loadScene(path, options.assetRoot);
  warnOfAll(loaded.warnings);
  apply(options, loaded.scene);
  requireUsableCamera(loaded.scene);
  requireReadableWords(loaded.scene);
  return std::move(loaded.scene);
}

void simulateInto(TrajectoryWriter& writer, const Scene& scene, World& world, StrictWatch* watch, bool quiet) {
  Progress progress("Simulating", "frames", lastFrame(scene) + 1, quiet);
  RunCameras cameras(scene, [&writer](const CameraPose& camera) { writer.append(camera); });
  const SimulationSink sink{[&](const Frame& frame) {
                              writer.append(frame);
                              cameras.note(frame);
                              progress.update(frame.number + 1);
                              if (watch) watch->check(frame);
                            },
                            [&](const Event& event) {
                              writer.append(event);
                              cameras.note(event);
                            },
                            [&](const std::string& warning) {
                              progress.endLine();
                              warn(warning);
                            },
                            [&](const Correction& correction) {
                              if (watch) watch->note(correction);
                            },
                            [&](const PromiseEnd& end) {
                              if (watch) watch->note(end);
                            },
                            [&](const LastingContact& contact) { writer.append(contact); },
                            [&](double time) { progress.showTime(time); }};
  RunCost cost;
  try {
    cost = simulate(scene, world, sink);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::unstable) cameras.finish();  // its frames may be kept
    throw;
  }
  cameras.finish();
  if (watch) watch->finish();
  writer.finish(cost);
}

std::optional<std::string> simulateUntilItFails(TrajectoryWriter& writer, const Scene& scene, World& world,
                                                bool quiet) {
  CpuStopwatch stopwatch;
  stopwatch.start();
  try {
    simulateInto(writer, scene, world, nullptr, quiet);
    return std::nullopt;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::unstable || !writer.hasFrame()) throw;
    stopwatch.stop();
    writer.finish({stopwatch.seconds(), world.evaluations(), world.correctionCounts(),
                   fmt::format("{}{}", kFailedRun, error.what())});
    return error.what();
  }
}

void simulateScene(const std::string& scenePath, const std::string& output, const SimulateOptions& options,
                   bool quiet) {
  requireWritableFile(output);
  requireNoOtherFile(output);
  requireNoWriter(partPath(output));
  const Scene scene = loadSceneAndWarn(scenePath, options.scene);
  refuseUnsupported(scene);
  World world(scene);
  requireNoWriter(partPath(output));  // planning may have taken long
  TrajectoryWriter writer(output, headerOf(scene, world.plan()));
  std::optional<StrictWatch> watch;
  if (options.isStrict) watch.emplace(scene, world.plan());
  const auto tellWhatIsKept = [&writer](ErrorKind kind, const std::string& what) {
    const std::string kept = writer.keptPath();
    throw Error(kind, "", kept.empty() ? what : fmt::format("{}; the frames up to then are in {}", what, kept));
  };
  try {
    if (!options.untilItFails)
      simulateInto(writer, scene, world, watch ? &*watch : nullptr, quiet);
    else if (const auto failure = simulateUntilItFails(writer, scene, world, quiet))
      return warn(fmt::format("{}; {} has the frames up to then, whole", *failure, output));
  } catch (const Error& error) {
    tellWhatIsKept(error.kind(), error.what());
  } catch (const std::bad_alloc&) {
    tellWhatIsKept(ErrorKind::limit, "out of memory");
  }
  if (options.checksAccuracy || options.findsHorizon) checkAccuracy(scene, output, options.checksAccuracy, quiet);
}

void checkScene(const std::string& scenePath, const SceneOptions& options) {
  const Scene scene = loadSceneAndWarn(scenePath, options);
  refuseUnsupported(scene);
  std::vector<Assembly> islands;
  // Bodies alone have nothing to be checked, and may be a million.
  for (const IslandPlan& island : planOf(scene).islands)
    if (!island.touching.empty() || !island.links.empty()) islands.push_back(assemble(scene, island));
  correctStartPenetrations(scene, islands);
  std::vector<std::string> warnings;
  for (const Assembly& assembly : islands)
    warnings.insert(warnings.end(), assembly.warnings.begin(), assembly.warnings.end());
  warnOfAll(warnings);
  const std::size_t driven = countBodies(scene, Motion::driven);
  show("{}: \"{}\" is in order: {} ({} dynamic{}){}; {} s, {} frames\n", printableLine(scenePath),
       printableLine(scene.name), counted(scene.bodies.size(), "body", "bodies"), countBodies(scene, Motion::dynamic),
       driven > 0 ? fmt::format(", {} driven", driven) : "", linksOf(scene), scene.duration, lastFrame(scene) + 1);
  for (const std::string& line : describeBodies(scene)) show("  {}\n", line);
}

}  // namespace cradle
