#include "experiments/sketch_oracles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "collision/random_poses.h"
#include "core/error.h"
#include "experiments/experiment.h"
#include "experiments/scene_twins.h"
#include "experiments/tie_error.h"
#include "experiments/touching_places.h"
#include "math/rotation.h"
#include "study/drift_meter.h"

namespace cradle {
namespace {

// Times the accuracy, where it is promised: errors of some tens of steps, each a tenth of it.
constexpr double kMaxErrors = 10;
// Runs that differ in rounding alone differ by as little; two runs of one accuracy by both their errors, with some
// growth; beyond that, sensitivity is measured.
constexpr double kMaxTwinErrors = 10, kMaxGrowth = 10;
// Where steps of one length promise nothing, but that pictures are right: parts of the energy, the size.
constexpr double kStepsGain = 1e-3, kStepsBalance = 5e-3, kStepsPlace = 0.02, kStepsMomentum = 1e-6;
constexpr double kStepsSpeed = 1e-3;  // m/s: a tenth of what gravity does in a step of 1/960 s, their error at impacts
constexpr double kChaos = 0.05;       // of the size: where disturbances grow to that, runs are not compared
constexpr double kCpuPerSecond = 5;   // s of CPU time per simulated second, beside
constexpr double kCpuAtStart = 0.5;   // s: of 500 changes of contacts, which end the promise
constexpr double kReferenceAccuracy = 1e-9;
// Runs until a difference is explained: where contact ends in one of two ways, one disturbance in six may take the
// other; and half of them a thousandth as large, as small ones may do more.
constexpr unsigned kMaxDisturbed = 10;
constexpr double kSmallRatio = 1e-3;
constexpr double kRoundedSpeed = 1e-12;   // m/s: what rounding may do to a mirror image
constexpr double kFileRounding = 1.2e-7;  // of models: files have single precision

double massOf(const SceneSketch& sketch) {
  double mass = 0;
  for (const SketchBody& body : sketch.bodies) mass += body.isDynamic() ? body.mass : 0;
  return mass;
}

double largestSizeOf(const SceneSketch& sketch) {
  double size = 0;
  for (const SketchBody& body : sketch.bodies)
    if (body.isDynamic()) size = std::max(size, sizeOf(body));
  return size;
}

bool isModel(const SketchBody& body) {
  return body.shape >= SketchShape::prismHull && body.shape != SketchShape::plane;
}

/// m: where bodies are and go, for errors that are relative to 1 + |x|.
double extentOf(const SceneRun& run) {
  double extent = 1;
  for (const Frame& frame : run.frames)
    for (const BodyState& state : frame.states) extent = std::max(extent, 1 + state.position.norm());
  return extent;
}

const char* const kSymmetry = "symmetry";

/// m: how far a body is from the mirror image of its image, in any frame.
double asymmetryOf(const SceneSketch& sketch, const SceneRun& run) {
  double broken = 0;
  for (const Frame& frame : run.frames) {
    const std::vector<RigidTransform> places = placesIn(frame, run.scene);
    for (std::size_t i = 0; i < sketch.images.size(); ++i) {
      const SketchBody& body = sketch.bodies[i];
      const RigidTransform image = mirrorImage(places[static_cast<std::size_t>(sketch.images[i])], body, 0);
      if (!body.isStatic) broken = std::max(broken, (image.translation - places[i].translation).norm());
    }
  }
  return broken;
}

/// m: so far it may be; a mirror image stays one.
double mostAsymmetryOf(const SceneSketch& sketch, const SceneRun& run) {
  const double size = smallestSizeOf(sketch);
  const double errors = run.keepsAccuracy ? kMaxErrors * sketch.accuracy * extentOf(run) : 0.1 * kStepsPlace * size;
  return std::max(1e-9 * size, errors);
}

class RunOracles {
 public:
  RunOracles(const SceneSketch& sketch, const SceneRun& run) : sketch_(sketch), run_(run) {
    const double gravity = sketch.gravity.norm(), speed = sketch.accuracy;  // m/s: errors of what rests
    energyScale_ = massOf(sketch) * (gravity * largestSizeOf(sketch) + speed * speed);
    const double potential = run.frames[0].energy.potential;
    for (const Frame& frame : run.frames)
      energyScale_ = std::max({energyScale_, frame.energy.kinetic, std::abs(frame.energy.potential - potential),
                               std::abs(frame.energy.work)});
  }

  std::vector<SketchFault> faults() {
    if (!checkFinite()) return faults_;
    checkEnergy();
    checkMomentum();
    checkPlaces();
    checkJoints();
    checkSymmetry();
    checkDisplacements();
    const double most = kCpuAtStart + kCpuPerSecond * sketch_.duration;
    require(run_.cpuSeconds < most, "cpu",
            fmt::format("{:.2g} s of CPU for {:.3g} s", run_.cpuSeconds, sketch_.duration));
    return faults_;
  }

 private:
  void require(bool holds, const std::string& oracle, const std::string& text) {
    if (!holds)
      faults_.push_back(
          {oracle, fmt::format("{}, accuracy {:g}{}", text, sketch_.accuracy, run_.keepsAccuracy ? "" : " not kept")});
  }
  double bound(double stepped) const { return run_.keepsAccuracy ? kMaxErrors * sketch_.accuracy : stepped; }

  bool checkFinite() {
    const bool holds = std::all_of(run_.frames.begin(), run_.frames.end(), [](const Frame& f) { return isFinite(f); });
    require(holds, "finite", "not finite");
    return holds;
  }

  void checkEnergy() {
    const auto ownOf = [](const Frame& frame) { return mechanicalEnergy(frame) - frame.energy.work; };
    double least = ownOf(run_.frames[0]), most = 0, gain = 0, fall = 0, balance = 0;
    for (const Frame& frame : run_.frames) {
      const double own = ownOf(frame);
      gain = std::max(gain, own - least);
      least = std::min(least, own);
      fall = std::max(fall, most - frame.energy.dissipated);
      most = std::max(most, frame.energy.dissipated);
      balance = std::max(balance, std::abs(energyConstantOf(frame) - energyConstantOf(run_.frames[0])));
    }
    require(gain <= bound(kStepsGain) * energyScale_, "gain",
            fmt::format("gains {:.2g} of its energy", gain / energyScale_));
    require(fall <= bound(kStepsGain) * energyScale_, "ledger",
            fmt::format("dissipated falls by {:.2g} of the energy", fall / energyScale_));
    // Places have errors of the accuracy x 1 m at least, however small bodies are.
    const double ofPlaces = run_.keepsAccuracy ? massOf(sketch_) * sketch_.gravity.norm() : 0;
    require(balance <= bound(kStepsBalance) * (energyScale_ + ofPlaces), "balance",
            fmt::format("balance of energy off by {:.2g} of it", balance / energyScale_));
  }

  /// Momentum along what no fixed thing can change, and angular momentum about the vertical through the origin: of all
  /// directions without fixed things, of level ones over level floors without friction.
  void checkMomentum() {
    const bool isTied =
        std::any_of(sketch_.links.begin(), sketch_.links.end(), [](const SketchLink& link) { return link.bodyB < 0; });
    bool isFree = !isTied, isLevel = !isTied;
    for (const SketchBody& body : sketch_.bodies) {
      if (body.isDynamic()) continue;
      isFree = false;
      const Vec3 normal = body.worldFromBody.rotation * Vec3::UnitY();
      const double friction = sketch_.materials[static_cast<std::size_t>(body.material)].staticFriction;
      isLevel = isLevel && body.isStatic && body.shape == SketchShape::plane &&
                normal.cross(Vec3::UnitY()).norm() == 0 && friction == 0;
    }
    if (!isLevel) return;
    double scale = 0, change = 0, turning = 0;
    const EnergyBalance& start = run_.frames[0].energy;
    for (const Frame& frame : run_.frames) {
      const EnergyBalance& now = frame.energy;
      scale = std::max(scale, massOf(sketch_) * std::sqrt(2 * energyScale_ / massOf(sketch_)));
      Vec3 lost = now.momentum - start.momentum - massOf(sketch_) * frame.time * sketch_.gravity;
      if (!isFree) lost.y() = 0;
      change = std::max(change, lost.norm());
      turning = std::max(turning, std::abs(now.angularMomentum.y() - start.angularMomentum.y()));
    }
    require(change <= bound(kStepsMomentum) * scale, "momentum", fmt::format("momentum off by {:.2g}", change / scale));
    require(turning <= bound(kStepsMomentum) * scale, "momentum",
            fmt::format("angular momentum off by {:.2g} m", turning / scale));
  }

  void checkPlaces() {
    const double size = smallestSizeOf(sketch_);
    const Assembly assembly = assemble(run_.scene, touchingScene(run_.scene));
    DriftMeter meter(assembly);
    double ties = 0;
    for (const Frame& frame : run_.frames) {
      meter.add(frame);
      ties = std::max({ties, constraintError(frame, run_.scene), ropeExcess(frame, run_.scene)});
    }
    // Models touch as exactly as their files are: single precision.
    const bool hasModels = std::any_of(sketch_.bodies.begin(), sketch_.bodies.end(), isModel);
    const double most = std::max(bound(kStepsPlace) * size, (hasModels ? kFileRounding : 1e-9) * size);
    require(meter.penetration() <= most, "penetration",
            fmt::format("penetration {:.2g} m, {:.2g} of the size", meter.penetration(), meter.penetration() / size));
    require(ties <= bound(kStepsPlace) * std::max(1.0, size), "ties", fmt::format("ties off by {:.2g} m or rad", ties));
  }

  /// Coordinates beyond their stops; motors that give more than they have, or less while they miss their target.
  void checkJoints() {
    double beyond = 0, force = 0, idle = 0;
    for (const Frame& frame : run_.frames) {
      auto state = frame.joints.begin();
      const auto add = [&](const auto& joints) {
        for (const auto& joint : joints) {
          const double coordinate = state->coordinate, velocity = state->velocity, given = (state++)->force;
          if (joint.limits)
            beyond = std::max({beyond, joint.limits->lower - coordinate, coordinate - joint.limits->upper});
          if (!joint.motor || !joint.motor->targetVelocity || joint.motor->force == 0) continue;
          const double missing = *joint.motor->targetVelocity - velocity, part = given / joint.motor->force;
          force = std::max(force, std::abs(part) - 1);
          idle = std::max(idle, std::min(std::abs(missing), 1 - std::copysign(part, missing * part)));
        }
      };
      add(run_.scene.hinges), add(run_.scene.sliders);
    }
    const double most = bound(kStepsPlace) * std::max(1.0, smallestSizeOf(sketch_));
    require(beyond <= most, "stops", fmt::format("{:.2g} m or rad beyond a stop", beyond));
    require(force <= bound(kStepsPlace), "motors",
            fmt::format("a motor gives {:.2g} more than all that it has", force));
    require(!run_.keepsAccuracy || idle <= most, "motors",
            fmt::format("a motor misses its target by {:.2g} m/s or rad/s, or does not push there", idle));
  }

  void checkSymmetry() {
    const double broken = asymmetryOf(sketch_, run_), most = mostAsymmetryOf(sketch_, run_);
    require(broken <= most, kSymmetry,
            fmt::format("symmetry broken by {:.2g} of the size", broken / smallestSizeOf(sketch_)));
  }

  void checkDisplacements() {
    for (const SceneSketch::Displacement& known : sketch_.displacements) {
      const auto body = static_cast<std::size_t>(known.body);
      const Vec3 way =
          placesIn(run_.frames.back(), run_.scene)[body].translation - sketch_.bodies[body].worldFromBody.translation;
      const double error = (way - known.value).norm(), most = bound(kStepsPlace * smallestSizeOf(sketch_));
      require(error <= most, "closed form",
              fmt::format("goes {:.3g} m, {:.2g} m off the closed form", way.norm(), error));
    }
  }

  const SceneSketch& sketch_;
  const SceneRun& run_;
  double energyScale_ = 0;  // J
  std::vector<SketchFault> faults_;
};

/// Largest distance (m) of a body from where it is in another run, in any frame; of its surface, when it is turned.
double distanceOf(const SceneSketch& sketch, const SceneRun& run, const SceneTwin& twin, const SceneRun& other) {
  double largest = 0;
  for (std::size_t frame = 0; frame < std::min(run.frames.size(), other.frames.size()); ++frame) {
    const std::vector<RigidTransform> here = placesIn(run.frames[frame], run.scene),
                                      there = placesIn(other.frames[frame], other.scene);
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (sketch.bodies[i].isStatic) continue;
      const RigidTransform back = twin.back(there[twin.bodies[i]], i);
      largest = std::max({largest, (back.translation - here[i].translation).norm(),
                          sizeOf(sketch.bodies[i]) * orientationError(back.rotation, here[i].rotation)});
    }
  }
  return largest;
}

SceneTwin sameScene(const SceneSketch& sketch) {
  SceneTwin twin = renumberedTwin(sketch);
  twin.sketch = sketch;
  for (std::size_t i = 0; i < twin.bodies.size(); ++i) twin.bodies[i] = i;
  return twin;
}

/// How far (m) a run of `sketch` comes apart from one whose start velocities differ by up to `disturbance` (m/s).
double spreadOf(const SceneSketch& sketch, const SceneRun& run, double disturbance, unsigned seed) {
  RandomPoses random(seed);
  SceneTwin twin = sameScene(sketch);
  for (SketchBody& body : twin.sketch.bodies) {
    const Vec3 velocity = random.vector(disturbance), spin = random.vector(disturbance / sizeOf(body));
    if (!body.isDynamic()) continue;
    body.linearVelocity += velocity, body.angularVelocity += spin;
    if (!isModel(body)) continue;
    // Where it stands upright, turning it leaves its gaps as they are; both at once may let it overlap.
    const Vec3 way = kFileRounding * random.vector(1).normalized();
    if (seed % 2 == 0)
      body.worldFromBody.translation += sizeOf(body) * way;
    else
      body.worldFromBody.rotation = rotationAbout(way.normalized(), kFileRounding) * body.worldFromBody.rotation;
  }
  return distanceOf(sketch, run, twin, runSketch(twin.sketch));
}

/// Collects what all runs of a scene show.
class SketchCheck {
 public:
  SketchCheck(const SceneSketch& sketch, const std::function<void(const std::string&)>& begin)
      : sketch_(sketch), begin_(begin) {}

  std::vector<SketchFault> faults() {
    const std::optional<SceneRun> run = tryRun(sketch_, "the scene");
    if (!run) return faults_;
    addFaultsOf(sketch_, *run);
    for (const SceneTwin& twin : {mirroredTwin(sketch_, 0), mirroredTwin(sketch_, 2), renumberedTwin(sketch_),
                                  turnedTwin(sketch_), scaledTwin(sketch_), shrunkTwin(sketch_)})
      compareTwin(*run, twin);
    checkConvergence();
    return faults_;
  }

 private:
  void add(const std::vector<SketchFault>& faults) {
    for (const SketchFault& fault : faults) {
      const auto isSame = [&](const SketchFault& other) { return other.oracle == fault.oracle; };
      if (std::none_of(faults_.begin(), faults_.end(), isSame)) faults_.push_back(fault);
    }
  }

  /// Where rounding grows to that, no mirror image can stay one.
  void addFaultsOf(const SceneSketch& sketch, const SceneRun& run) {
    std::vector<SketchFault> faults = faultsOfRun(sketch, run);
    const auto isExplained = [&](const SketchFault& fault) {
      return fault.oracle == kSymmetry &&
             !isBeyondSensitivity(sketch, run, asymmetryOf(sketch, run), mostAsymmetryOf(sketch, run), kRoundedSpeed);
    };
    std::erase_if(faults, isExplained);
    add(faults);
  }

  std::optional<SceneRun> tryRun(const SceneSketch& sketch, const std::string& what) {
    begin_(what);
    try {
      return runSketch(sketch);
    } catch (const Error& error) {
      add({{fmt::format("exit {}", static_cast<int>(error.kind())), fmt::format("{}: {}", what, error.what())}});
      return {};
    }
  }

  /// Whether two runs of the scene differ by more than `most` (m) and what disturbances of `disturbance` (m/s) explain.
  bool isBeyondSensitivity(const SceneSketch& sketch, const SceneRun& run, double difference, double most,
                           double disturbance) {
    if (difference <= most) return false;
    begin_("the scene, disturbed");
    try {
      double spread = 0;
      for (unsigned seed = 1; seed <= kMaxDisturbed; ++seed) {
        const double small = std::max(kRoundedSpeed, seed % 2 == 1 ? disturbance : kSmallRatio * disturbance);
        spread = std::max(spread, spreadOf(sketch, run, small, seed));
        if (spread > kChaos * smallestSizeOf(sketch) || difference <= most + kMaxGrowth * spread) return false;
      }
      return true;
    } catch (const Error& error) {
      add({{fmt::format("exit {}", static_cast<int>(error.kind())), fmt::format("disturbed: {}", error.what())}});
      return false;
    }
  }

  void compareTwin(const SceneRun& run, const SceneTwin& twin) {
    const std::optional<SceneRun> other = tryRun(twin.sketch, twin.name);
    if (!other) return;
    const double difference = distanceOf(sketch_, run, twin, *other), size = smallestSizeOf(sketch_);
    const bool isKept = run.keepsAccuracy && other->keepsAccuracy;
    if (!isKept && twin.hasOtherSteps) return;
    const double most = isKept ? kMaxTwinErrors * sketch_.accuracy * extentOf(run) : kStepsPlace * size;
    if (isBeyondSensitivity(sketch_, run, difference, most, isKept ? sketch_.accuracy : kStepsSpeed))
      add({{twin.name, fmt::format("{:.2g} m, {:.2g} of the size, from the twin's; accuracy {:g}{}", difference,
                                   difference / size, sketch_.accuracy, isKept ? "" : " not kept")}});
  }

  void checkConvergence() {
    SceneSketch fine = sketch_;
    fine.accuracy = kReferenceAccuracy;
    const std::optional<SceneRun> reference = tryRun(fine, "accuracy 1e-9");
    if (!reference) return;
    addFaultsOf(fine, *reference);
    for (const double accuracy : {1e-4, 1e-6}) {
      SceneSketch coarse = sketch_;
      coarse.accuracy = accuracy;
      const std::optional<SceneRun> run = tryRun(coarse, fmt::format("accuracy {:g}", accuracy));
      if (!run) continue;
      addFaultsOf(coarse, *run);
      if (!run->keepsAccuracy || !reference->keepsAccuracy) continue;
      const double difference = distanceOf(sketch_, *run, sameScene(sketch_), *reference);
      const double most = kMaxTwinErrors * accuracy * extentOf(*run);
      if (isBeyondSensitivity(fine, *reference, difference, most, accuracy))
        add({{"convergence", fmt::format("{:.2g} m between accuracies {:g} and 1e-9", difference, accuracy)}});
    }
  }

  const SceneSketch& sketch_;
  const std::function<void(const std::string&)>& begin_;
  std::vector<SketchFault> faults_;
};

/// Without a body and what is tied to it.
SceneSketch withoutBody(SceneSketch sketch, int body) {
  sketch.bodies.erase(sketch.bodies.begin() + body);
  std::erase_if(sketch.links, [&](const SketchLink& link) { return link.bodyA == body || link.bodyB == body; });
  for (SketchLink& link : sketch.links)
    for (int* end : {&link.bodyA, &link.bodyB}) *end -= *end > body;
  sketch.images.clear(), sketch.displacements.clear();
  return sketch;
}

}  // namespace

SceneRun runSketch(const SceneSketch& sketch) {
  return runOf(parseScene(textOf(sketch), sketch.name, modelFilesBeside("sketch.json")).scene);
}

std::vector<SketchFault> faultsOfRun(const SceneSketch& sketch, const SceneRun& run) {
  return RunOracles(sketch, run).faults();
}

std::vector<SketchFault> checkSketch(const SceneSketch& sketch, const std::function<void(const std::string&)>& begin) {
  return SketchCheck(sketch, begin).faults();
}

SceneSketch reduceSketch(const SceneSketch& sketch, const std::string& oracle) {
  const auto stillFails = [&](const SceneSketch& less) {
    const std::vector<SketchFault> faults = checkSketch(less, [](const std::string&) {});
    return std::any_of(faults.begin(), faults.end(), [&](const SketchFault& fault) { return fault.oracle == oracle; });
  };
  SceneSketch least = sketch;
  for (std::size_t i = least.links.size(); i-- > 0;) {
    SceneSketch less = least;
    less.links.erase(less.links.begin() + static_cast<std::ptrdiff_t>(i));
    if (stillFails(less)) least = less;
  }
  for (int i = static_cast<int>(least.bodies.size()); i-- > 0 && least.bodies.size() > 1;) {
    const SceneSketch less = withoutBody(least, i);
    if (std::all_of(less.bodies.begin(), less.bodies.end(), [](const SketchBody& body) { return !body.isDynamic(); }))
      continue;
    if (stillFails(less)) least = less;
  }
  return least;
}

}  // namespace cradle
