#include <cmath>

#include "simulate/simulate.h"
#include "study/motion_error.h"
#include "study/stability/hung_box.h"
#include "study/stability/smooth_motion_maps.h"

namespace cradle {
namespace {

constexpr double kInaccuratePlace = 0.01;  // m, or of a quaternion
constexpr double kReferenceAccuracy = 1e-10;
constexpr double kSoftestSpring = 1e3, kStiffestSpring = 1e9;     // N/m
constexpr double kShortestBoxStep = 5e-5, kLongestBoxStep = 0.5;  // s
constexpr double kDampedStiffness = 1e6;                          // N/m
constexpr double kMinBoxStepOmega = 0.2;
constexpr int kBoxColumns = 26, kBoxRows = 41, kBoxTheoryPoints = 65;
constexpr const char* kTheoryAtStart = "limit by theory, at the start";

std::vector<BodyState> referenceEnd(Scene scene) {
  scene.method.reset();
  scene.accuracy = kReferenceAccuracy;
  scene.duration = kBoxDuration;
  scene.output.framesPerSecond = 1 / kBoxDuration;
  return simulate(scene).frames.back().states;
}

/// What x and y of a map are.
struct BoxAxes {
  Scene (*scene)(double x);
  double (*stepUnit)(const Scene& scene);  // s, of y
  double (*dampingRatio)(double x);
};

/// The scene of a column, and where it ends.
struct Column {
  Scene scene;
  std::vector<BodyState> end;
};

/// A map under way.
struct BoxMap {
  StabilityMap& map;
  BoxAxes axes;
  std::vector<Column> columns;
};

Stability boxStability(Column& column, const FixedStepMethod& method, double timeStep) {
  if (!isBoxStable(column.scene, method, timeStep)) return Stability::unstable;
  const double steps = std::ceil(kBoxDuration / timeStep);
  const FixedStepTrial trial = tryFixedSteps(column.scene, method, {kBoxDuration / steps, static_cast<long>(steps), 1});
  if (trial.isUnstable) return Stability::unstable;
  return motionError(trial.frames.back().states, column.end) <= kInaccuratePlace ? Stability::stable
                                                                                 : Stability::inaccurate;
}

std::vector<double> boxCells(BoxMap& box, const FixedStepMethod& method, const MapProgress& progress) {
  std::size_t cell = 0;
  const auto trial = [&](double, double y) {
    Column& column = box.columns[cell++ % box.columns.size()];
    return static_cast<double>(boxStability(column, method, y * box.axes.stepUnit(column.scene)));
  };
  return cellsOf(box.map, trial, progress);
}

MapPanel panelOf(BoxMap& box, const FixedStepMethod& method, const MapProgress& progress) {
  const Axis& x = box.map.x;
  const BoxAxes& axes = box.axes;
  const bool isEverStable = oscillatorLimit(method, axes.dampingRatio(x.values.back())) > 0;
  MapPanel panel{
      isEverStable ? method.title : method.title + ": no step is stable for long", boxCells(box, method, progress), {}};
  MapCurve theory{kTheoryAtStart, CurveKind::theory, {}}, measured{kMeasuredName, CurveKind::measured, {}};
  for (const double value : someOf(x, kBoxTheoryPoints)) {
    const Scene scene = axes.scene(value);
    if (const double limit = oscillatorLimit(method, axes.dampingRatio(value)); limit > 0)
      theory.points.push_back({value, limit / boxOmega(scene) / axes.stepUnit(scene)});
  }
  for (const double value : someOf(x, kMeasured)) {
    if (!isEverStable) break;  // half a second does not show it: that is no limit
    Scene scene = axes.scene(value);
    if (const double found = measuredBoxLimit(scene, method); found > 0)
      measured.points.push_back({value, found / axes.stepUnit(scene)});
  }
  panel.curves = {theory, measured};
  return panel;
}

void addBoxPanels(StabilityMap& map, const BoxAxes& axes, const MapProgress& progress) {
  map.outcomes = stabilityOutcomes();
  map.subtitle =
      "2 kg, 0.4 x 0.2 x 0.6 m, 0.5 s, at least 300 steps. Unstable: energy from nowhere. Inaccurate: off by more than "
      "0.01 (m, quaternion) at the end";
  BoxMap box{map, axes, {}};
  for (const double x : map.x.values) box.columns.push_back({axes.scene(x), referenceEnd(axes.scene(x))});
  addPanels(
      map, [&](const FixedStepMethod& method, const MapProgress& part) { return panelOf(box, method, part); },
      progress);
}

}  // namespace

StabilityMap hungBoxStiffnessMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "hung_box_stiffness";
  map.title = "Step and stiffness: a box that hangs by one corner from a spring";
  map.paragraph =
      "The limits of the oscillator hold for a spring that pulls beside the centre of mass too, once omega is that of "
      "the mass which it really moves: 1 / m + (r x n)^T I^-1 (r x n) in place of 1 / m, here 0.9 kg of the 2 kg. "
      "While the spring is much faster than the swing of the box, the border is as sharp as the oscillator's. With a "
      "soft spring the box turns far within a few steps, and that ends semi-implicit Euler and DOP853 earlier than the "
      "spring would. Explicit Euler only seems stable: half a second is too short to show what it gains. What is asked "
      "here is where the box is, to a centimetre; how the spring trembles counts for little.";
  map.x = logarithmicAxis("stiffness", "N/m", logarithmicallySpaced(kSoftestSpring, kStiffestSpring, kBoxColumns));
  map.y = logarithmicAxis("time step", "s", logarithmicallySpaced(kShortestBoxStep, kLongestBoxStep, kBoxRows));
  addBoxPanels(map,
               {[](double stiffness) { return hungBox(stiffness, 0); }, [](const Scene&) { return 1.0; },
                [](double) { return 0.0; }},
               progress);
  return map;
}

StabilityMap hungBoxDampingMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "hung_box_damping";
  map.title = "Step and damping: a box that hangs by one corner from a damped spring";
  map.paragraph =
      "A spring of 1 000 000 N/m with a damper beside it, on the corner of a box. The borders are those of the damped "
      "oscillator, for the mass that the spring moves at the start: explicit Euler needs the damper to be stable at "
      "all, and every method pays for strong damping with shorter steps. Semi-implicit Euler takes the damper's force "
      "from the start of the step, as explicit Euler does.";
  map.x = linearAxis("damping ratio zeta (1: critical)", "", evenlySpaced(0, kMaxDamping, kBoxColumns));
  map.y = logarithmicAxis("step x omega", "rad", logarithmicallySpaced(kMinBoxStepOmega, kMaxStepOmega, kBoxRows));
  addBoxPanels(map,
               {[](double ratio) { return hungBox(kDampedStiffness, ratio); },
                [](const Scene& scene) { return 1 / boxOmega(scene); }, [](double ratio) { return ratio; }},
               progress);
  return map;
}

}  // namespace cradle
