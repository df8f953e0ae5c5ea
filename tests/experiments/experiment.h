#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "core/error.h"
#include "scene/load_scene.h"
#include "simulate/simulate.h"

// Experiments run a scene text through the whole of the physics.

namespace cradle {

constexpr double kGravity = 9.81;  // m/s^2

/// The scene of a JSON text; no meshes.
inline Scene sceneOf(const std::string& text) {
  return parseScene(text, "experiment.json", [](const MeshReference&) { return LoadedModel{}; }).scene;
}

/// The scene of a text's members behind schema and name.
inline Scene sceneWith(const std::string& members) {
  return sceneOf(R"({"schema": "cradle-scene/1", "name": "Experiment", )" + members + "}");
}

/// `[x, y, z]` for a scene text, with all digits.
inline std::string vectorText(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

/// `"method": ...` for a scene text.
inline std::string methodText(const std::string& name, double timeStep) {
  return fmt::format(R"("method": {{"name": "{}", "timeStep": {}}})", name, timeStep);
}

/// A ball of 1 kg for a scene text, small and touching nothing.
inline std::string ball(const std::string& name, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.01}}}}, "collision": "none", "mass": 1,
    "position": {}, "linearVelocity": {}}})",
                     name, vectorText(position), vectorText(velocity));
}

inline std::vector<Event> eventsOf(const Trajectory& run, EventKind kind) {
  std::vector<Event> events;
  std::copy_if(run.events.begin(), run.events.end(), std::back_inserter(events),
               [kind](const Event& event) { return event.kind == kind; });
  return events;
}

/// The state of the first dynamic body in the last frame.
inline BodyState endOf(const Trajectory& trajectory) {
  return trajectory.frames.back().states[0];
}

/// J
inline double mechanicalEnergy(const Frame& frame) {
  return frame.energy.kinetic + frame.energy.potential;
}

/// J: changes by the errors of a method.
inline double energyConstantOf(const Frame& frame) {
  return frame.energy.kinetic + frame.energy.potential + frame.energy.dissipated - frame.energy.work;
}

/// J: changes by rounding alone, if all that methods do is booked.
inline double ledgerConstantOf(const Frame& frame) {
  return energyConstantOf(frame) + frame.energy.numerical;
}

/// Largest difference of two orientations' components, q and -q being the same.
inline double orientationError(const Quat& a, const Quat& b) {
  const Eigen::Vector4d difference = a.coeffs() - b.coeffs(), sum = a.coeffs() + b.coeffs();
  return std::min(difference.cwiseAbs().maxCoeff(), sum.cwiseAbs().maxCoeff());
}

/// Order of a method from its errors at steps h, h/2, h/4, ...: the mean slope in powers of two.
inline double measuredOrder(const std::vector<double>& errors) {
  return std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
}

}  // namespace cradle
