#include "study/stability/fixed_step_trial.h"

#include "core/error.h"
#include "scene/load_scene.h"
#include "simulate/simulate.h"
#include "study/study_method.h"

namespace cradle {
namespace {

constexpr double kLimitTolerance = 1e-3;  // relative
constexpr int kMaxDoublings = 60;         // a method without a limit is our mistake

}  // namespace

Scene sceneOfText(const std::string& text) {
  return parseScene(text, "scene", [](const MeshReference&) { return LoadedModel{}; }).scene;
}

FixedStepTrial tryFixedSteps(Scene& scene, const FixedStepMethod& method, const TrialLength& length) {
  choose(studyMethodsNamed({method.name}).front(), length.timeStep, scene);
  const double frameTime = static_cast<double>(length.stepsAFrame) * length.timeStep;
  scene.duration = static_cast<double>(length.frames) * frameTime;
  scene.output.framesPerSecond = 1 / frameTime;
  FixedStepTrial trial;
  try {
    simulate(scene, {[&](const Frame& frame) { trial.frames.push_back(frame); }, [](const Event&) {},
                     [](const std::string&) {}});
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::unstable) throw;
    trial.isUnstable = true;
  }
  return trial;
}

double measuredLimit(const std::function<bool(double)>& isStable, double first) {
  if (!isStable(first)) return 0;
  double stable = first, unstable = 2 * first;
  for (int i = 0; isStable(unstable); ++i) {
    CRADLE_CHECK(i < kMaxDoublings);
    stable = unstable, unstable *= 2;
  }
  while (unstable - stable > kLimitTolerance * stable) {
    const double middle = (stable + unstable) / 2;
    (isStable(middle) ? stable : unstable) = middle;
  }
  return stable;
}

bool isStableFor(Scene& scene, const FixedStepMethod& method, double timeStep, long steps) {
  return !tryFixedSteps(scene, method, {timeStep, steps, 1}).isUnstable;
}

std::vector<double> cellsOf(const StabilityMap& map, const std::function<double(double, double)>& trial,
                            const MapProgress& done) {
  std::vector<double> cells;
  for (std::size_t row = 0; row < map.y.values.size(); ++row) {
    for (const double x : map.x.values) cells.push_back(trial(x, map.y.values[row]));
    done(static_cast<double>(row + 1) / static_cast<double>(map.y.values.size()));
  }
  return cells;
}

void addPanels(StabilityMap& map, const std::function<MapPanel(const FixedStepMethod&, const MapProgress&)>& make,
               const MapProgress& progress) {
  const double methods = static_cast<double>(fixedStepMethods().size());
  for (const FixedStepMethod& method : fixedStepMethods()) {
    const double before = static_cast<double>(map.panels.size());
    map.panels.push_back(make(method, [&](double part) { progress((before + part) / methods); }));
  }
}

std::vector<double> someOf(const Axis& axis, int count) {
  const double first = axis.values.front(), last = axis.values.back();
  return axis.quantity.isLogarithmic ? logarithmicallySpaced(first, last, count) : evenlySpaced(first, last, count);
}

}  // namespace cradle
