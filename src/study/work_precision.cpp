#include "study/work_precision.h"

#include <cmath>

#include "study/ladder.h"
#include "study/motion_error.h"

namespace cradle {
namespace {

constexpr double kCpuLimit = 6;  // s, of one run: with its coarser ones, 12 s a method
constexpr double kExactEnough = 1e-12;

}  // namespace

void sweep(StudyScene& scene, const std::string& sceneName, const StudyMethod& method, const Reference& reference,
           const std::function<void(const StudyRow&)>& take) {
  if (!scene.missingIn(method).empty()) return;
  const double floor =
      std::isfinite(reference.uncertainty) ? std::max(reference.uncertainty, kExactEnough) : kExactEnough;
  Ladder ladder(method, scene);
  GainWatch watch;
  bool goesOn = true;
  while (goesOn) {
    const StudyRun run = scene.run(method, ladder.setting(), kCpuLimit);
    StudyRow row;
    row.scene = sceneName;
    row.engine = method.engine();
    row.method = method.name;
    row.setting = run.setting;
    row.status = run.status;
    row.message = run.message;
    if (run.status == RunStatus::ok) {
      row.error = motionError(run.end, reference.end);
      row.cpuSecondsPerSimulatedSecond = run.cost.cpuSeconds / scene.duration();
      row.evaluations = static_cast<double>(run.cost.evaluations);
      row.energyDrift = run.energyDrift;
      row.constraintDrift = run.constraintDrift;
      row.penetration = run.penetration;
    }
    take(row);
    if (run.status == RunStatus::failed) return;
    goesOn = (run.status == RunStatus::unstable || watch.goesOn(row.error, floor)) &&
             ladder.descend(run.cost.cpuSeconds, kCpuLimit);
  }
}

}  // namespace cradle
