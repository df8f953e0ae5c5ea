#include "study/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "scene/named_accuracy.h"
#include "study/ladder.h"
#include "study/motion_error.h"

namespace cradle {
namespace {

constexpr double kConverged = 1e-11;       // between two runs at h and h/2
constexpr double kReferenceCpuLimit = 20;  // s, of one run
constexpr double kBestKnown = 1e-15;       // no motion is known better

/// The best of the runs of a method at halved steps, and how far the one before was from it.
struct Converged {
  std::optional<StudyRun> run;
  double change = std::numeric_limits<double>::infinity();
};

const StudyMethod& methodNamed(const char* name) {
  const auto& methods = studyMethods();
  return *std::find_if(methods.begin(), methods.end(), [&](const StudyMethod& method) { return method.name == name; });
}

Converged converge(StudyScene& scene, const StudyMethod& method, const std::function<void()>& tick) {
  Ladder ladder(method, scene);
  GainWatch watch;
  Converged best;
  std::optional<StudyRun> last;
  while (true) {
    StudyRun run = scene.run(method, ladder.setting(), kReferenceCpuLimit);
    tick();
    if (run.status == RunStatus::failed) return best;
    bool goesOn = true;
    if (run.status == RunStatus::ok) {
      const double change = last ? motionError(run.end, last->end) : std::numeric_limits<double>::infinity();
      goesOn = !last || watch.goesOn(change, kConverged);
      if (!best.run || change <= best.change) best = {run, change};
      last = run;
    }
    if (!goesOn || !ladder.descend(run.cost.cpuSeconds, kReferenceCpuLimit)) return best;
  }
}

}  // namespace

Reference findReference(StudyScene& scene, const std::function<void()>& tick) {
  const StudyMethod &rk4 = methodNamed("rk4"), &dop853 = methodNamed("dop853");
  const Converged check = converge(scene, rk4, tick);
  const StudyRun adaptive = scene.run(dop853, kFinestAccuracy, kReferenceCpuLimit);
  tick();
  if (!check.run && adaptive.status != RunStatus::ok)
    throw Error(ErrorKind::limit, "", fmt::format("\"{}\" has no reference: no method reaches its end", scene.name()));
  if (adaptive.status != RunStatus::ok)
    return {check.run->end, std::max(check.change, kBestKnown), fmt::format("RK4, step {:.3g} s", check.run->setting),
            fmt::format("at twice the step it ends {:.1e} away", check.change)};
  const std::string madeBy = fmt::format("DOP853, accuracy {}", kFinestAccuracy);
  if (!check.run)
    return {adaptive.end, std::numeric_limits<double>::infinity(), madeBy, "no second method confirms it"};
  const double distance = std::max(motionError(check.run->end, adaptive.end), kBestKnown);
  return {adaptive.end, distance, madeBy,
          fmt::format("RK4, step {:.3g} s, ends {:.1e} away", check.run->setting, distance)};
}

}  // namespace cradle
