#include "study/run_quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/error.h"
#include "core/printable.h"

namespace cradle {
namespace {

constexpr double kSameFrameTime = 1e-9;  // of frames, of 1 s and the time
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kAllowed =
    "energy, energyError, height:BODY, angle:BODY or angle:JOINT, phase:BODY or phase:JOINT, error, error:BODY, with "
    "commas between them, or --quantity again";

struct NamedQuantity {
  const char* word;
  QuantityKind kind;
  bool mayHaveName, needsName;
};
constexpr std::array<NamedQuantity, 6> kQuantities = {{{"energy", QuantityKind::energy, false, false},
                                                       {"energyError", QuantityKind::energyError, false, false},
                                                       {"height", QuantityKind::height, true, true},
                                                       {"angle", QuantityKind::angle, true, true},
                                                       {"phase", QuantityKind::phase, true, true},
                                                       {"error", QuantityKind::error, true, false}}};

RunQuantity parseQuantity(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string word = text.substr(0, colon), name = colon == std::string::npos ? "" : text.substr(colon + 1);
  for (const NamedQuantity& known : kQuantities)
    if (word == known.word && (colon == std::string::npos ? !known.needsName : known.mayHaveName && !name.empty()))
      return {known.kind, name};
  throw Error(ErrorKind::usage, "--quantity",
              fmt::format("found \"{}\"; allowed are {}", printableLine(text), kAllowed));
}

/// Where the quantity ends that begins at `begin`: after the longest of `names` that is its own, or at the next comma.
std::size_t endOfQuantity(const std::string& text, std::size_t begin, const std::vector<std::string>& names) {
  const std::size_t comma = std::min(text.find(',', begin), text.size()), colon = text.find(':', begin);
  std::size_t end = comma;
  for (const std::string& name : names) {
    const std::size_t after = colon + 1 + name.size();
    const bool isNamed = colon < comma && text.compare(colon + 1, name.size(), name) == 0;
    if (isNamed && (after == text.size() || text[after] == ',')) end = std::max(end, after);
  }
  return end;
}

/// Index into Frame::states by body; -1 of bodies that have none.
std::vector<int> statesOf(const Scene& scene) {
  std::vector<int> states;
  int count = 0;
  for (const Body& body : scene.bodies) states.push_back(body.motion == Motion::fixed ? -1 : count++);
  return states;
}

[[noreturn]] void refuseQuantity(const RunScene& run, const std::string& what) {
  throw Error(ErrorKind::usage, "--quantity", fmt::format("{}: {}", printableLine(run.name), what));
}

/// Of a body that moves.
std::size_t stateNamed(const std::string& name, const RunScene& run) {
  std::string moving;
  const std::vector<int> states = statesOf(run.scene);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i] < 0) continue;
    if (run.scene.bodies[i].name == name) return static_cast<std::size_t>(states[i]);
    if (states[i] < 20) moving += (moving.empty() ? "" : ", ") + run.scene.bodies[i].name;
  }
  refuseQuantity(run, fmt::format("has no body that moves named \"{}\"; there are {}", printableLine(name),
                                  moving.empty() ? "none" : printableLine(moving)));
}

/// Index into Frame::joints: hinges, then sliders.
std::optional<std::size_t> jointNamed(const std::string& name, const Scene& scene) {
  std::size_t index = 0;
  for (const Hinge& hinge : scene.hinges) {
    if (hinge.name == name) return index;
    ++index;
  }
  for (const Slider& slider : scene.sliders) {
    if (slider.name == name) return index;
    ++index;
  }
  return std::nullopt;
}

/// A body that swings about a pivot.
class Pendulum {
 public:
  Pendulum(const std::string& name, const RunScene& run)
      : scene_(run.scene), states_(statesOf(run.scene)), state_(stateNamed(name, run)) {
    const auto body = std::find(states_.begin(), states_.end(), static_cast<int>(state_)) - states_.begin();
    forEachKindOfJoint(scene_, [&](const auto& joints) { findPivot(joints, static_cast<int>(body)); });
    findPivot(scene_.rods, static_cast<int>(body));
    findPivot(scene_.ropes, static_cast<int>(body));
    findPivot(scene_.springs, static_cast<int>(body));
    if (!pivot_)
      refuseQuantity(run, fmt::format("\"{}\" has no joint, rod, rope or spring to swing about", printableLine(name)));
    if (scene_.gravity.norm() > 0) down_ = scene_.gravity.normalized();
  }

  /// The angle (rad) and its rate (rad/s) in a frame. To be asked for frame by frame, from the first on.
  std::pair<double, double> at(const Frame& frame) {
    const Place pivot = placeOf(*pivot_, frame);
    const BodyState& state = frame.states[state_];
    const Vec3 arm = state.position - pivot.position, velocity = state.linearVelocity - pivot.velocity;
    if (!normal_) normal_ = normalOf(arm, velocity);
    const Vec3 across = normal_->cross(down_);
    const double a = arm.dot(down_), b = arm.dot(across);
    double angle = std::atan2(b, a);
    angle += 2 * std::numbers::pi * std::round((last_ - angle) / (2 * std::numbers::pi));
    last_ = angle;
    return {angle, (a * velocity.dot(across) - b * velocity.dot(down_)) / (a * a + b * b)};
  }

 private:
  struct Place {
    Vec3 position, velocity;  // m, m/s; world
  };

  /// One at the world goes before others.
  template <class Links>
  void findPivot(const Links& links, int body) {
    for (const auto& link : links) {
      if (link.anchorA.body != body && link.anchorB.body != body) continue;
      const Anchor& other = link.anchorA.body == body ? link.anchorB : link.anchorA;
      if (!pivot_ || (isStill(other) && !isStill(*pivot_))) pivot_ = other;
    }
  }

  bool isStill(const Anchor& anchor) const {
    return anchor.body == kWorld || states_[static_cast<std::size_t>(anchor.body)] < 0;
  }

  Place placeOf(const Anchor& anchor, const Frame& frame) const {
    if (anchor.body == kWorld) return {anchor.point, Vec3::Zero()};
    const auto index = static_cast<std::size_t>(anchor.body);
    const Body& body = scene_.bodies[index];
    if (states_[index] < 0) return {body.worldFromBody * anchor.point, Vec3::Zero()};
    const BodyState& state = frame.states[static_cast<std::size_t>(states_[index])];
    const Vec3 arm = state.orientation * (anchor.point - body.massProperties.centerOfMass);
    return {state.position + arm, state.linearVelocity + state.angularVelocity.cross(arm)};
  }

  /// Of the plane of gravity and the arm, in which the angle at the start is positive; if it hangs straight down, of
  /// the motion.
  Vec3 normalOf(const Vec3& arm, const Vec3& velocity) const {
    constexpr double kMinSine = 1e-9;
    for (const Vec3& normal : {Vec3(down_.cross(arm)), Vec3(down_.cross(velocity))})
      if (normal.norm() > kMinSine * (arm.norm() + velocity.norm())) return normal.normalized();
    return Vec3::UnitZ();
  }

  const Scene& scene_;
  std::vector<int> states_;
  std::size_t state_;
  std::optional<Anchor> pivot_;
  Vec3 down_ = -Vec3::UnitY();  // unit
  std::optional<Vec3> normal_;  // unit
  double last_ = 0;             // rad
};

template <class Visit>
void forEachFrame(const PlottedRun& run, const Visit& visit) {
  for (long number = 0; number < run.frames.frameCount(); ++number) visit(run.frames.readFrame(number));
}

std::vector<QuantityCurve> energyCurves(const PlottedRun& run, bool alone) {
  QuantityCurve kinetic{"kinetic", {}, {}}, potential{"potential", {}, {}}, sum{alone ? "sum" : run.name, {}, {}};
  forEachFrame(run, [&](const Frame& frame) {
    kinetic.y.push_back(frame.energy.kinetic);
    potential.y.push_back(frame.energy.potential);
    sum.y.push_back(frame.energy.kinetic + frame.energy.potential);
    sum.x.push_back(frame.time);
  });
  if (!alone) return {sum};
  const double lowest = *std::min_element(potential.y.begin(), potential.y.end());
  for (double& value : potential.y) value -= lowest;
  for (double& value : sum.y) value -= lowest;
  kinetic.x = potential.x = sum.x;
  return {kinetic, potential, sum};
}

QuantityCurve energyErrorCurve(const PlottedRun& run) {
  QuantityCurve curve{run.name, {}, {}};
  std::optional<double> start;
  forEachFrame(run, [&](const Frame& frame) {
    const EnergyBalance& energy = frame.energy;
    const double sum = energy.kinetic + energy.potential + energy.dissipated - energy.work;
    if (!start) start = sum;
    curve.x.push_back(frame.time);
    curve.y.push_back(sum - *start);
  });
  return curve;
}

QuantityCurve heightCurve(const RunQuantity& quantity, const PlottedRun& run) {
  QuantityCurve curve{run.name, {}, {}};
  const std::size_t state = stateNamed(quantity.name, run);
  forEachFrame(run, [&](const Frame& frame) {
    curve.x.push_back(frame.time);
    curve.y.push_back(frame.states[state].position.dot(upOf(run.scene)));
  });
  return curve;
}

QuantityCurve angleCurve(const RunQuantity& quantity, const PlottedRun& run) {
  QuantityCurve curve{run.name, {}, {}};
  const std::optional<std::size_t> joint = jointNamed(quantity.name, run.scene);
  std::optional<Pendulum> pendulum;
  if (!joint) pendulum.emplace(quantity.name, run);
  forEachFrame(run, [&](const Frame& frame) {
    const auto [angle, rate] =
        joint ? std::pair(frame.joints[*joint].coordinate, frame.joints[*joint].velocity) : pendulum->at(frame);
    curve.x.push_back(quantity.kind == QuantityKind::phase ? angle : frame.time);
    curve.y.push_back(quantity.kind == QuantityKind::phase ? rate : angle);
  });
  return curve;
}

/// Pairs of states, of the run and the reference: the bodies that are compared.
std::vector<std::pair<std::size_t, std::size_t>> commonBodies(const RunQuantity& quantity, const PlottedRun& run,
                                                              const PlottedRun& reference) {
  if (!quantity.name.empty()) return {{stateNamed(quantity.name, run), stateNamed(quantity.name, reference)}};
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const std::vector<int> states = statesOf(run.scene), others = statesOf(reference.scene);
  for (std::size_t i = 0; i < states.size() && i < others.size(); ++i)
    if (states[i] >= 0 && others[i] >= 0 && run.scene.bodies[i].name == reference.scene.bodies[i].name)
      pairs.emplace_back(states[i], others[i]);
  if (pairs.empty()) refuseQuantity(run, "has no body of the reference");
  return pairs;
}

QuantityCurve errorCurve(const RunQuantity& quantity, const PlottedRun& run, const PlottedRun* reference) {
  CRADLE_CHECK(reference != nullptr);
  QuantityCurve curve{run.name, {}, {}};
  const auto bodies = commonBodies(quantity, run, *reference);
  forEachFrame(run, [&](const Frame& frame) {
    if (frame.number >= reference->frames.frameCount()) return;
    const Frame exact = reference->frames.readFrame(frame.number);
    if (std::abs(exact.time - frame.time) > kSameFrameTime * (1 + frame.time)) {
      // The last frame of a run that is shorter is at its duration.
      if (frame.number + 1 == std::min(run.frames.frameCount(), reference->frames.frameCount())) return;
      refuseQuantity(run,
                     fmt::format("has a frame at {} s where the reference has one at {} s; give both the same frames",
                                 frame.time, exact.time));
    }
    double error = 0;
    for (const auto& [state, other] : bodies)
      error = std::max(error, (frame.states[state].position - exact.states[other].position).norm());
    curve.x.push_back(frame.time);
    curve.y.push_back(error > 0 ? error : kNone);  // of a logarithmic axis
  });
  return curve;
}

}  // namespace

std::vector<RunQuantity> parseQuantities(const std::string& text, const std::vector<std::string>& names) {
  std::vector<RunQuantity> quantities;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = endOfQuantity(text, begin, names);
    quantities.push_back(parseQuantity(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return quantities;
}

std::vector<std::string> namesWithCommas(const Scene& scene) {
  std::vector<std::string> names;
  const auto add = [&names](const auto& named) {
    for (const auto& one : named)
      if (one.name.find(',') != std::string::npos) names.push_back(one.name);
  };
  add(scene.bodies), add(scene.hinges), add(scene.sliders);
  return names;
}

void requireQuantity(const RunQuantity& quantity, const RunScene& run) {
  const bool isAngle = quantity.kind == QuantityKind::angle || quantity.kind == QuantityKind::phase;
  if (isAngle && !jointNamed(quantity.name, run.scene)) Pendulum(quantity.name, run);
  if (!isAngle && !quantity.name.empty()) stateNamed(quantity.name, run);
}

QuantityAxes axesOf(const RunQuantity& quantity, const Scene& scene) {
  const std::optional<std::size_t> joint = jointNamed(quantity.name, scene);
  const bool isLength = joint && *joint >= scene.hinges.size();
  const std::string coordinate =
      fmt::format("{} of {} ({})", isLength ? "coordinate" : "angle", quantity.name, isLength ? "m" : "rad");
  if (quantity.kind == QuantityKind::phase)
    return {coordinate, isLength ? "velocity (m/s)" : "angular velocity (rad/s)"};
  QuantityAxes axes{"time (s)", coordinate, quantity.kind == QuantityKind::error};
  if (quantity.kind == QuantityKind::energy) axes.y = "energy (J)";
  if (quantity.kind == QuantityKind::energyError) axes.y = "energy error (J)";
  if (quantity.kind == QuantityKind::height) axes.y = fmt::format("height of {} (m)", quantity.name);
  if (quantity.kind == QuantityKind::error)
    axes.y = quantity.name.empty() ? "greatest error (m)" : fmt::format("error of {} (m)", quantity.name);
  return axes;
}

std::vector<QuantityCurve> curvesOf(const RunQuantity& quantity, const PlottedRun& run, bool alone,
                                    const PlottedRun* reference) {
  if (quantity.kind == QuantityKind::energy) return energyCurves(run, alone);
  if (quantity.kind == QuantityKind::energyError) return {energyErrorCurve(run)};
  if (quantity.kind == QuantityKind::height) return {heightCurve(quantity, run)};
  if (quantity.kind == QuantityKind::error) return {errorCurve(quantity, run, reference)};
  return {angleCurve(quantity, run)};
}

}  // namespace cradle
