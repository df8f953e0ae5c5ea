#pragma once

#include <fmt/format.h>

#include <string>

#include "scene/load_scene.h"
#include "study/study_run.h"

namespace cradle {

/// The scene of a JSON text; no meshes.
inline Scene sceneOf(const std::string& text) {
  return parseScene(text, "study.json", [](const MeshReference&) { return LoadedModel{}; }).scene;
}

/// A ball of 1 kg at x = 1.25 m on a spring of rest length 1 m from the origin, free of gravity: x = 1 + cos(omega t)
/// / 4.
inline Scene oscillator(double omega, double duration) {
  return sceneOf(
      fmt::format(R"({{"schema": "cradle-scene/1", "name": "oscillator", "duration": {}, "gravity": [0, 0, 0],
    "bodies": [{{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [1.25, 0, 0]}}],
    "springs": [{{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": {}, "restLength": 1}}]}})",
                  duration, omega * omega));
}

/// A ball that falls freely from the origin.
inline Scene freeFall(double duration) {
  return sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "fall", "duration": {},
    "bodies": [{{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1}}]}})",
                             duration));
}

inline StudyMethod methodOf(const std::string& name) {
  return studyMethodsNamed({name}).front();
}

}  // namespace cradle
