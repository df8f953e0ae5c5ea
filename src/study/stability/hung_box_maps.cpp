// A box that hangs by one corner from a spring, as in the scene hung_box: the spring pulls beside the centre of mass,
// so that it moves less mass than the box has. The limit that theory has is that of the start; the box swings away from
// there within some tenths of a second.

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "dynamics/spring.h"
#include "simulate/assembly.h"
#include "simulate/simulate.h"
#include "study/motion_error.h"
#include "study/stability/fixed_step_trial.h"
#include "study/stability/smooth_motion_maps.h"
#include "study/study_method.h"

namespace cradle {
namespace {

constexpr double kDuration = 0.5;     // s
constexpr double kInaccurate = 0.01;  // m, or of a quaternion
constexpr double kReferenceAccuracy = 1e-10;
constexpr long kLeastSteps = 300;                              // a growth of 1 % a step is then one of 20
constexpr double kLeastStiffness = 1e2, kMostStiffness = 1e7;  // N/m
constexpr double kShortestStep = 5e-4, kLongestStep = 0.5;     // s
constexpr double kDampedStiffness = 1e5;                       // N/m
constexpr double kMostDamping = 2;                             // times critical
constexpr int kColumns = 26, kRows = 37, kMeasured = 9, kTheoryPoints = 65;
constexpr const char* kTheory = "limit by theory, at the start";
constexpr const char* kMeasuredName = "limit as measured by bisection";

Scene hungBox(double stiffness) {
  static const Scene prototype = sceneOfText(
      R"({"schema": "cradle-scene/1", "name": "hung box", "duration": 1, "gravity": [0, 0, -9.81],
      "bodies": [{"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "collision": "none", "mass": 2,
      "position": [-0.2, -0.1, -0.8]}],
      "springs": [{"bodyA": "box", "anchorA": [0.2, 0.1, 0.3], "anchorB": [0, 0, 0], "stiffness": 1,
      "restLength": 0.5}]})");
  Scene scene = prototype;
  scene.springs[0].stiffness = stiffness;
  return scene;
}

/// Frequency (rad/s) of the spring at the start.
double omegaOf(const Scene& scene) {
  const Assembly assembly = assemble(scene, wholeScene(scene));
  return naturalFrequency(assembly.mechanism.springs[0], assembly.mechanism.bodies, assembly.state);
}

/// The same box with so much damping: k / omega^2 is the mass that the spring moves.
Scene dampedBox(double stiffness, double dampingRatio) {
  Scene scene = hungBox(stiffness);
  scene.springs[0].damping = 2 * dampingRatio * stiffness / omegaOf(scene);
  return scene;
}

std::vector<BodyState> referenceEnd(Scene scene) {
  scene.method.reset();
  scene.accuracy = kReferenceAccuracy;
  scene.duration = kDuration;
  scene.output.framesPerSecond = 1 / kDuration;
  return simulate(scene).frames.back().states;
}

/// Unstable if a run to the end, and of 300 steps at the least, is stopped.
Stability boxStability(Scene& scene, const std::vector<BodyState>& reference, const FixedStepMethod& method,
                       double timeStep) {
  if (!isStableFor(scene, method, timeStep, kLeastSteps)) return Stability::unstable;
  const double steps = std::ceil(kDuration / timeStep);
  const FixedStepTrial trial = tryFixedSteps(scene, method, {kDuration / steps, static_cast<long>(steps), 1});
  if (trial.isUnstable) return Stability::unstable;
  return motionError(trial.frames.back().states, reference) <= kInaccurate ? Stability::stable : Stability::inaccurate;
}

double measuredBoxLimit(Scene& scene, const FixedStepMethod& method) {
  const double omega = omegaOf(scene);
  return measuredLimit([&](double timeStep) { return isStableFor(scene, method, timeStep, kLeastSteps); }, 0.2 / omega);
}

/// A scene of each column with where it ends.
struct Column {
  Scene scene;
  std::vector<BodyState> reference;
};
Column columnOf(const Scene& scene) {
  return {scene, referenceEnd(scene)};
}

/// What a panel needs of its axes: `scene` makes that of a column, `stepUnit` (s) is what the step is told in there.
struct BoxAxes {
  Scene (*scene)(double x);
  double (*stepUnit)(const Scene& scene);
  double (*dampingRatio)(double x);
};

MapPanel panelOf(const StabilityMap& map, const BoxAxes& axes, const FixedStepMethod& method,
                 const MapProgress& progress) {
  MapPanel panel{method.title, {}, {}};
  std::vector<Column> columns;
  for (const double x : map.x.values) columns.push_back(columnOf(axes.scene(x)));
  std::size_t cell = 0;
  const auto trial = [&](double, double y) {
    Column& column = columns[cell++ % columns.size()];
    return boxStability(column.scene, column.reference, method, y * axes.stepUnit(column.scene));
  };
  panel.cells = cellsOf(map, trial, progress);
  MapCurve theory{kTheory, CurveKind::theory, {}}, measured{kMeasuredName, CurveKind::measured, {}};
  for (const double x : someOf(map.x, kTheoryPoints)) {
    const Scene scene = axes.scene(x);
    if (const double limit = oscillatorLimit(method, axes.dampingRatio(x)); limit > 0)
      theory.points.push_back({x, limit / omegaOf(scene) / axes.stepUnit(scene)});
  }
  for (const double x : someOf(map.x, kMeasured)) {
    Scene scene = axes.scene(x);
    if (const double found = measuredBoxLimit(scene, method); found > 0)
      measured.points.push_back({x, found / axes.stepUnit(scene)});
  }
  panel.curves = {theory, measured};
  return panel;
}

void addBoxPanels(StabilityMap& map, const BoxAxes& axes, const MapProgress& progress) {
  map.outcomes = stabilityOutcomes();
  map.subtitle =
      "2 kg, 0.4 x 0.2 x 0.6 m, 0.5 s, at least 300 steps. Unstable: energy from nowhere. Inaccurate: off by more than "
      "0.01 (m, quaternion) at the end";
  addPanels(
      map, [&](const FixedStepMethod& method, const MapProgress& part) { return panelOf(map, axes, method, part); },
      progress);
}

}  // namespace

StabilityMap hungBoxStiffnessMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "hung_box_stiffness";
  map.title = "Step and stiffness: a box that hangs by one corner from a spring";
  map.paragraph =
      "The same limits hold for a spring that pulls beside the centre of mass, once omega is that of the mass which "
      "the "
      "spring really moves: 1 / m + (r x n)^T I^-1 (r x n) in place of 1 / m, here 0.9 kg of the 2 kg. The box swings, "
      "and with it that mass changes, so that the border is not as sharp as that of the oscillator. Beside it, "
      "accuracy is another matter: explicit and semi-implicit Euler are right to a centimetre only in steps far below "
      "their limits, RK4 and DOP853 nearly up to them.";
  map.x = logarithmicAxis("stiffness", "N/m", logarithmicallySpaced(kLeastStiffness, kMostStiffness, kColumns));
  map.y = logarithmicAxis("time step", "s", logarithmicallySpaced(kShortestStep, kLongestStep, kRows));
  addBoxPanels(map, {hungBox, [](const Scene&) { return 1.0; }, [](double) { return 0.0; }}, progress);
  return map;
}

StabilityMap hungBoxDampingMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "hung_box_damping";
  map.title = "Step and damping: a box that hangs by one corner from a damped spring";
  map.paragraph =
      "A spring of 100 000 N/m with a damper beside it, on the corner of a box. The borders are those of the damped "
      "oscillator, for the mass that the spring moves.";
  map.x = linearAxis("damping ratio zeta (1: critical)", "", evenlySpaced(0, kMostDamping, kColumns));
  map.y = logarithmicAxis("step x omega", "rad", logarithmicallySpaced(0.1, 10, kRows));
  addBoxPanels(map,
               {[](double ratio) { return dampedBox(kDampedStiffness, ratio); },
                [](const Scene& scene) { return 1 / omegaOf(scene); }, [](double ratio) { return ratio; }},
               progress);
  return map;
}

}  // namespace cradle
