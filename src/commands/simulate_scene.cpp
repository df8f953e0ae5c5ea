#include "commands/simulate_scene.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <vector>

#include "commands/run_cameras.h"
#include "commands/run_file.h"
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
#include "scene/load_scene.h"
#include "scene/named_accuracy.h"
#include "scene/parse_settings.h"
#include "scene/ranges.h"
#include "simulate/assembly.h"
#include "simulate/simulate.h"
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

/// Tells the fingerprint of a run, for its checkpoints; without one none are kept.
using Fingerprint = std::function<std::string()>;

/// A simulation into a trajectory file.
class FileRun {
 public:
  /// Keeps references; `watch` may be null.
  FileRun(TrajectoryWriter& writer, const Scene& scene, World& world, StrictWatch* watch, bool quiet)
      : writer_(writer),
        scene_(scene),
        world_(world),
        watch_(watch),
        cameras_(scene, [&writer](const CameraPose& camera) { writer.append(camera); }),
        progress_("Simulating", "frames", lastFrame(scene) + 1, quiet) {}

  /// Takes over the frames and events of an ended run.
  void note(RunFile& file) {
    const long kept = file.tellKept(
        [this](const Frame& frame) {
          cameras_.note(frame);
          if (watch_) watch_->check(frame);
        },
        [this](const Event& event) { cameras_.note(event); });
    progress_.skipTo(kept);
  }

  /// Simulates what is missing behind the record of a checkpoint, or all, and finishes the file.
  void finish(const std::string& record, const Fingerprint& fingerprint) {
    const RunCost cost = simulateMissing(record, fingerprint);
    cameras_.finish();
    if (watch_) watch_->finish();
    writer_.finish(cost);
  }

  /// The same, but a run that becomes unstable after its first frame is finished as far as it went.
  std::optional<std::string> finishOrFail(const std::string& record, const Fingerprint& fingerprint) {
    CpuStopwatch stopwatch;
    stopwatch.start();
    try {
      finish(record, fingerprint);
      return std::nullopt;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::unstable || !writer_.hasFrame()) throw;
      stopwatch.stop();
      writer_.finish({stopwatch.seconds(), world_.evaluations(), world_.correctionCounts(),
                      fmt::format("{}{}", kFailedRun, error.what())});
      return error.what();
    }
  }

 private:
  RunCost simulateMissing(const std::string& record, const Fingerprint& fingerprint) {
    SimulationSink sink{[this](const Frame& frame) {
                          writer_.append(frame);
                          cameras_.note(frame);
                          progress_.update(frame.number + 1);
                          if (watch_) watch_->check(frame);
                        },
                        [this](const Event& event) {
                          writer_.append(event);
                          cameras_.note(event);
                        },
                        [this](const std::string& warning) {
                          progress_.endLine();
                          warn(warning);
                        },
                        [this](const Correction& correction) {
                          if (watch_) watch_->note(correction);
                        },
                        [this](const PromiseEnd& end) {
                          if (watch_) watch_->note(end);
                        },
                        [this](const LastingContact& contact) { writer_.append(contact); }};
    if (fingerprint)
      sink.checkpoint = [&](Checkpoint checkpoint) {
        checkpoint.fingerprint = fingerprint();
        writer_.append(checkpoint);
      };
    sink.reached = [this](double time) { progress_.showTime(time); };
    try {
      return simulate(scene_, world_, sink, record);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::unstable) cameras_.finish();  // its frames may be kept
      throw;
    }
  }

  TrajectoryWriter& writer_;
  const Scene& scene_;
  World& world_;
  StrictWatch* watch_;
  RunCameras cameras_;
  Progress progress_;
};

}  // namespace

Scene loadSceneAndWarn(const std::string& path, const SceneOptions& options) {
  LoadedScene loaded = loadScene(path, options.assetRoot);
  warnOfAll(loaded.warnings);
  apply(options, loaded.scene);
  requireUsableCamera(loaded.scene);
  requireReadableWords(loaded.scene);
  return std::move(loaded.scene);
}

void simulateInto(TrajectoryWriter& writer, const Scene& scene, World& world, bool quiet) {
  FileRun(writer, scene, world, nullptr, quiet).finish("", {});
}

std::optional<std::string> simulateUntilItFails(TrajectoryWriter& writer, const Scene& scene, World& world,
                                                bool quiet) {
  return FileRun(writer, scene, world, nullptr, quiet).finishOrFail("", {});
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
  RunFile file(output, scene, world, options.isStrict, options.isFresh);
  std::optional<StrictWatch> watch;
  if (options.isStrict) watch.emplace(scene, world.plan());
  const auto tellWhatIsKept = [&file](ErrorKind kind, const std::string& what) {
    const std::string kept = file.writer().keptPath();
    throw Error(kind, "", kept.empty() ? what : fmt::format("{}; the frames up to then are in {}", what, kept));
  };
  try {
    FileRun run(file.writer(), scene, world, watch ? &*watch : nullptr, quiet);
    if (!quiet) file.tellOfCheckpoint("; --fresh begins anew");
    run.note(file);
    const Fingerprint fingerprint = [&file] { return file.fingerprint(); };
    const std::string record = file.record();
    if (!options.untilItFails)
      run.finish(record, fingerprint);
    else if (const auto failure = run.finishOrFail(record, fingerprint))
      return warn(fmt::format("{}; {} has the frames up to then, whole", *failure, output));
  } catch (const Error& error) {
    tellWhatIsKept(error.kind(), error.what());
  } catch (const std::bad_alloc&) {
    tellWhatIsKept(ErrorKind::limit, "out of memory");
  }
  if (options.checksAccuracy || options.findsHorizon) checkAccuracy(scene, output, options.checksAccuracy, quiet);
}

}  // namespace cradle
