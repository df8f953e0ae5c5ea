// `accuracy` bounds the local error; what the end of a run has of it depends on how much the scene makes of errors.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "dynamics/free_rotation.h"
#include "simulate/simulate.h"
#include "study/motion_error.h"
#include "study/stability/hung_box.h"
#include "study/stability/oscillator.h"
#include "study/stability/smooth_motion_maps.h"
#include "study/stability/tumbling.h"

namespace cradle {
namespace {

constexpr int kFirstTenths = 2, kLastTenths = 12;  // accuracies 10^-2 ... 10^-12
constexpr double kMinError = 1e-15;                // shown

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
  const Oscillator oscillator{2 * std::numbers::pi, 0.05};
  KnownScene known{"mass on a damped spring, 10 s", oscillatorScene(oscillator), {}};
  known.scene.duration = 10;
  known.end = {{{1 + oscillatorStretch(oscillator, 10), 0, 0}, Quat::Identity()}};
  return known;
}

KnownScene knownTumbling() {
  KnownScene known{"free body that turns over, 10 s", tumblingScene(5), {}};
  known.scene.duration = 10;
  const FreeRotation truth(known.scene.bodies[0].massProperties.inertiaTensor,
                           {Quat::Identity(), known.scene.bodies[0].angularVelocity});
  known.end = {{Vec3::Zero(), truth.at(known.scene.duration).worldFromBody}};
  return known;
}

/// Scenes without a closed form: their ends are from the finest run.
KnownScene knownByItself(const char* name, Scene scene, double duration) {
  scene.duration = duration;
  KnownScene known{name, std::move(scene), {}};
  known.end = endOf(known.scene, std::pow(10, -kLastTenths));
  return known;
}

/// Balls in a row from the origin, each hung by a rod of 1 m from the one before, let go from the horizontal.
Scene horizontalPendulum(int balls) {
  std::vector<std::string> bodies, rods;
  for (int i = 0; i < balls; ++i) {
    bodies.push_back(fmt::format(R"({{"name": "ball{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none",
      "mass": 1, "position": [{}, 0, 0]}})",
                                 i, i + 1));
    const std::string above = i > 0 ? fmt::format(R"("bodyB": "ball{}", )", i - 1) : "";
    rods.push_back(fmt::format(R"({{"bodyA": "ball{}", "anchorA": [0, 0, 0], {}"anchorB": [0, 0, 0]}})", i, above));
  }
  return sceneOfText(
      fmt::format(R"({{"schema": "cradle-scene/1", "name": "pendulum", "duration": 1, "bodies": [{}], "rods": [{}]}})",
                  fmt::join(bodies, ", "), fmt::join(rods, ", ")));
}

std::vector<KnownScene> knownScenes() {
  return {knownOscillator(), knownTumbling(), knownByItself("box on a corner spring, 5 s", hungBox(200, 0), 5),
          knownByItself("pendulum on a rod, 10 s", horizontalPendulum(1), 10),
          knownByItself("double pendulum on rods, 5 s", horizontalPendulum(2), 5)};
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
      "tenth for a tenth, as far as rounding allows; from 1e-2 to 1e-3 more than that, for the longest steps are "
      "judged "
      "less strictly. How far above or below it lies is the scene's own: a damped spring forgets its errors, a "
      "pendulum "
      "keeps them, and a free body that turns over is off by 4000 times the accuracy after 10 s, since a small error "
      "in "
      "the time of each turn over is a large one in where the body points. `cradle simulate --check-accuracy` finds "
      "that factor for any scene.";
  map.x = logarithmicAxis("accuracy asked", "", {std::pow(10, -kLastTenths - 0.3), std::pow(10, -kFirstTenths + 0.3)});
  map.y = logarithmicAxis("error at the end", "", {kMinError, 1});
  MapPanel panel{"", {}, {{"error = accuracy", CurveKind::theory, {{1e-13, 1e-13}, {1, 1}}}}};
  const std::vector<KnownScene> scenes = knownScenes();
  for (const KnownScene& known : scenes) {
    MapCurve curve{known.name, CurveKind::series, {}};
    for (int tenths = kFirstTenths; tenths <= kLastTenths; ++tenths) {
      const double accuracy = std::pow(10, -tenths), error = motionError(endOf(known.scene, accuracy), known.end);
      if (error > 0) curve.points.push_back({accuracy, std::max(error, kMinError)});
    }
    panel.curves.push_back(curve);
    progress(static_cast<double>(panel.curves.size() - 1) / static_cast<double>(scenes.size()));
  }
  map.panels = {panel};
  return map;
}

}  // namespace cradle
