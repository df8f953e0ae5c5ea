#include "study/work_precision.h"

#include <algorithm>
#include <cmath>

#include "study/ladder.h"
#include "study/motion_error.h"

namespace cradle {
namespace {

constexpr double kCpuLimit = 3;  // s, of one run: with its coarser ones, 6 s a method
constexpr double kExactEnough = 1e-12;

StudyRow runRow(StudyScene& scene, const StudyMethod& method, double setting, const Reference& reference) {
  const StudyRun run = scene.run(method, setting, kCpuLimit);
  StudyRow row;
  row.engine = method.engine();
  row.method = method.name;
  row.setting = run.setting;
  row.status = run.status;
  row.message = run.message;
  if (run.status != RunStatus::ok) return row;
  row.error = motionError(run.end, reference.end);
  row.cpuSecondsPerSimulatedSecond = run.cost.cpuSeconds / scene.duration();
  row.evaluations = static_cast<double>(run.cost.evaluations);
  row.energyDrift = run.energyDrift;
  row.constraintDrift = run.constraintDrift;
  row.penetration = run.penetration;
  return row;
}

const StudyRow* findRow(const std::vector<StudyRow>& rows, const StudyMethod& method, double setting) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const StudyRow& row) {
    return row.method == method.name && row.setting == setting;
  });
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace

void sweep(StudyScene& scene, const std::string& sceneName, const StudyMethod& method, const Reference& reference,
           const RowStream& rows) {
  if (!scene.missingIn(method).empty()) return;
  const double floor =
      std::isfinite(reference.uncertainty) ? std::max(reference.uncertainty, kExactEnough) : kExactEnough;
  Ladder ladder(method, scene);
  GainWatch watch;
  bool goesOn = true;
  while (goesOn) {
    const StudyRow* earlier = findRow(rows.earlier, method, ladder.setting());
    StudyRow row = earlier != nullptr ? *earlier : runRow(scene, method, ladder.setting(), reference);
    row.scene = sceneName;
    rows.take(row);
    if (row.status == RunStatus::failed) return;
    const bool isUnstable = row.status == RunStatus::unstable;
    const double cpuSeconds = isUnstable ? 0 : row.cpuSecondsPerSimulatedSecond * scene.duration();
    const bool gains = isUnstable || watch.goesOn(row.error, floor) || method.isPlan();
    goesOn = gains && ladder.descend(cpuSeconds, kCpuLimit);
  }
}

void timeInAnotherTurn(StudyScene& scene, const std::vector<StudyMethod>& methods, std::vector<StudyRow>& rows,
                       const std::function<void()>& done) {
  for (StudyRow& row : rows) {
    done();
    const auto method =
        std::find_if(methods.begin(), methods.end(), [&](const StudyMethod& one) { return one.name == row.method; });
    if (row.status != RunStatus::ok || method == methods.end()) continue;
    double& cost = row.cpuSecondsPerSimulatedSecond;
    if (const auto again = scene.costInAnotherTurn(*method, row.setting, cost * scene.duration()))
      cost = std::min(cost, *again / scene.duration());
  }
}

}  // namespace cradle
