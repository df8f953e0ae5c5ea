// `accuracy` bounds the local error; what the end of a run has of it depends on how much the scene makes of errors.

#include <cmath>

#include "dynamics/free_rotation.h"
#include "simulate/simulate.h"
#include "study/motion_error.h"
#include "study/stability/fixed_step_trial.h"
#include "study/stability/oscillator.h"
#include "study/stability/smooth_motion_maps.h"

namespace cradle {
namespace {

constexpr int kFirstTenths = 2, kLastTenths = 12;  // accuracies 10^-2 ... 10^-12
constexpr double kLeastError = 1e-15;              // shown

/// A scene of which the end is known.
struct KnownScene {
  const char* name;
  Scene scene;
  std::vector<BodyState> end;
};

std::vector<BodyState> endOf(Scene scene, double accuracy) {
  scene.method = Method{MethodName::dop853, std::nullopt, "scene"};
  scene.accuracy = accuracy;
  scene.output.framesPerSecond = 1 / scene.duration;
  return simulate(scene).frames.back().states;
}

/// Ten periods.
KnownScene knownOscillator() {
  const Oscillator oscillator{2 * 3.14159265358979323846, 0.05};
  KnownScene known{"mass on a damped spring, 10 s", oscillatorScene(oscillator), {}};
  known.scene.duration = 10;
  known.end = {{{1 + oscillatorStretch(oscillator, 10), 0, 0}, Quat::Identity()}};
  return known;
}

KnownScene knownTumbling() {
  KnownScene known{"free body that turns over, 10 s",
                   sceneOfText(
                       R"({"schema": "cradle-scene/1", "name": "tumbling", "duration": 10, "gravity": [0, 0, 0],
      "bodies": [{"name": "body", "shape": {"box": {"size": [1, 1, 1]}}, "collision": "none", "mass": 1,
      "centerOfMass": [0, 0, 0], "inertiaTensor": [[1, 0, 0], [0, 2, 0], [0, 0, 3]],
      "angularVelocityBody": [0.05, 5, 0.05]}]})"),
                   {}};
  const FreeRotation truth(known.scene.bodies[0].massProperties.inertiaTensor,
                           {Quat::Identity(), known.scene.bodies[0].angularVelocity});
  known.end = {{Vec3::Zero(), truth.at(known.scene.duration).worldFromBody}};
  return known;
}

/// Scenes without a closed form: their ends are from the finest run.
KnownScene knownByItself(const char* name, const char* text) {
  KnownScene known{name, sceneOfText(text), {}};
  known.end = endOf(known.scene, std::pow(10, -kLastTenths));
  return known;
}

std::vector<KnownScene> knownScenes() {
  return {knownOscillator(), knownTumbling(),
          knownByItself("box on a corner spring, 5 s",
                        R"({"schema": "cradle-scene/1", "name": "hung box", "duration": 5, "gravity": [0, 0, -9.81],
      "bodies": [{"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "collision": "none", "mass": 2,
      "position": [-0.2, -0.1, -0.8]}],
      "springs": [{"bodyA": "box", "anchorA": [0.2, 0.1, 0.3], "anchorB": [0, 0, 0], "stiffness": 200,
      "restLength": 0.5}]})"),
          knownByItself("pendulum on a rod, 10 s",
                        R"({"schema": "cradle-scene/1", "name": "rod pendulum", "duration": 10,
      "bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.1}}, "collision": "none", "mass": 1,
      "position": [1, 0, 0]}],
      "rods": [{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}]})"),
          knownByItself("double pendulum on rods, 5 s",
                        R"({"schema": "cradle-scene/1", "name": "double pendulum", "duration": 5,
      "bodies": [{"name": "upper", "shape": {"sphere": {"radius": 0.1}}, "collision": "none", "mass": 1,
      "position": [1, 0, 0]}, {"name": "lower", "shape": {"sphere": {"radius": 0.1}}, "collision": "none", "mass": 1,
      "position": [2, 0, 0]}],
      "rods": [{"bodyA": "upper", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]},
      {"bodyA": "lower", "anchorA": [0, 0, 0], "bodyB": "upper", "anchorB": [0, 0, 0]}]})")};
}

}  // namespace

StabilityMap accuracyMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "accuracy";
  map.title = "Accuracy asked, and error at the end: adaptive DOP853";
  map.subtitle =
      "Error: max |x - x_ref| / (1 + |x_ref|) over positions (m) and quaternions, against closed forms or the finest "
      "run";
  map.paragraph =
      "The accuracy that a scene asks for bounds the error of each step, and the error at the end goes down with it, a "
      "tenth for a tenth, as far as rounding allows. How far above or below it lies is the scene's own: a damped "
      "spring forgets its errors, a pendulum keeps them, and a free body that turns over makes them 5000 times larger "
      "in 10 s, since a small error in the time of each turn over is a large one in where the body points. `cradle "
      "simulate --check-accuracy` finds that factor for any scene.";
  map.x = logarithmicAxis("accuracy asked", "", {std::pow(10, -kLastTenths - 0.3), std::pow(10, -kFirstTenths + 0.3)});
  map.y = logarithmicAxis("error at the end", "", {kLeastError, 1});
  MapPanel panel{"", {}, {{"error = accuracy", CurveKind::theory, {{1e-13, 1e-13}, {1, 1}}}}};
  const std::vector<KnownScene> scenes = knownScenes();
  for (const KnownScene& known : scenes) {
    MapCurve curve{known.name, CurveKind::series, {}};
    for (int tenths = kFirstTenths; tenths <= kLastTenths; ++tenths) {
      const double accuracy = std::pow(10, -tenths), error = motionError(endOf(known.scene, accuracy), known.end);
      if (error > 0) curve.points.push_back({accuracy, std::max(error, kLeastError)});
    }
    panel.curves.push_back(curve);
    progress(static_cast<double>(panel.curves.size() - 1) / static_cast<double>(scenes.size()));
  }
  map.panels = {panel};
  return map;
}

}  // namespace cradle
