// Frames between steps cost evaluations of their own in methods with dense output, so that the cost is taken from runs
// that have only the two ends.

#include "study/study_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include "core/error.h"
#include "simulate/simulate.h"
#include "study/drift_meter.h"
#include "study/peers/peer_run.h"

namespace cradle {
namespace {

constexpr long kDriftFrames = 16;    // a power of two: halved steps end on them
constexpr double kShortRun = 0.2;    // s of CPU time: beyond, one run is exact to some per cent
constexpr double kRepeatFor = 0.05;  // s of CPU time in all
constexpr int kMinRepeats = 3, kMaxRepeats = 50;

double cpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// A scene that any method can be tried on.
Scene withSafeMethod(Scene scene) {
  choose(studyMethods().front(), scene.duration, scene);
  refuseUnsupported(scene);
  return scene;
}

StudyRun failedRun(const Error& error) {
  if (error.kind() == ErrorKind::interrupted) throw Error(error);
  StudyRun run;
  run.status = error.kind() == ErrorKind::unstable ? RunStatus::unstable : RunStatus::failed;
  run.message = error.what();
  return run;
}

}  // namespace

StudyScene::StudyScene(Scene scene)
    : scene_(withSafeMethod(std::move(scene))), assembly_(assemble(scene_, wholeScene(scene_))) {}

std::string StudyScene::missingIn(const StudyMethod& method) const {
  return method.peer ? method.peer->missingIn(scene_, assembly_) : "";
}

double StudyScene::fastestFrequency() const {
  double fastest = 0;
  for (const SpringForce& spring : assembly_.mechanism.springs)
    fastest = std::max(fastest, naturalFrequency(spring, assembly_.mechanism.bodies, assembly_.state));
  return fastest;
}

StudyRun StudyScene::run(const StudyMethod& method, double setting, double cpuLimit) {
  if (!method.peer) choose(method, setting, scene_);
  StudyRun result = runOnce(method, setting, kDriftFrames, cpuLimit);
  if (result.status == RunStatus::ok && result.cost.cpuSeconds < kShortRun)
    result.cost = leastCost(method, setting, cpuLimit).value_or(result.cost);
  result.setting = setting;
  return result;
}

std::optional<double> StudyScene::costInAnotherTurn(const StudyMethod& method, double setting, double cpuSeconds) {
  if (!(cpuSeconds < kShortRun)) return std::nullopt;
  if (!method.peer) choose(method, setting, scene_);
  const std::optional<RunCost> cost = leastCost(method, setting, INFINITY);
  return cost ? std::optional(cost->cpuSeconds) : std::nullopt;
}

std::optional<RunCost> StudyScene::leastCost(const StudyMethod& method, double setting, double cpuLimit) {
  std::optional<RunCost> least;
  double sum = 0;
  for (int i = 0; i < kMaxRepeats; ++i) {
    if (i >= kMinRepeats && sum > kRepeatFor) break;
    const StudyRun again = runOnce(method, setting, 1, cpuLimit);
    if (again.status != RunStatus::ok) break;  // two frames show less kinetic energy, by which what appears is measured
    sum += again.cost.cpuSeconds;
    if (!least || again.cost.cpuSeconds < least->cpuSeconds) least = again.cost;
  }
  return least;
}

StudyRun StudyScene::runOnce(const StudyMethod& method, double setting, long frames, double cpuLimit) {
  scene_.output.playbackSpeed = 1;
  scene_.output.framesPerSecond = static_cast<double>(frames) / scene_.duration;
  StudyRun run;
  DriftMeter meter(assembly_);
  const double start = cpuSeconds();
  const auto take = [&](const Frame& frame) {
    meter.add(frame);
    if (frame.number == frames) run.end = frame.states;
    if (frame.number < frames && cpuSeconds() - start > cpuLimit)
      throw Error(ErrorKind::limit, "", fmt::format("takes more than {} s of CPU time", cpuLimit));
  };
  try {
    if (method.peer) {
      run.cost = runPeer(*method.peer, setting, scene_, assembly_, take);
    } else {
      refuseUnsupported(scene_);
      run.cost = simulate(scene_, {take, [](const Event&) {}, [](const std::string&) {}});
    }
  } catch (const Error& error) {
    return failedRun(error);
  }
  CRADLE_CHECK(!run.end.empty() || assembly_.sceneBodies.empty());
  const bool knowsEnergy = !method.peer || !mayChangeEnergy(assembly_);
  run.energyDrift = knowsEnergy ? meter.energyDrift() : std::numeric_limits<double>::quiet_NaN();
  run.constraintDrift = meter.constraintDrift();
  run.penetration = meter.penetration();
  return run;
}

}  // namespace cradle
