#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/scene_sketch.h"

namespace cradle {

/// The same scene told in another way, and how to see it as the first.
struct SceneTwin {
  std::string name;
  SceneSketch sketch;
  std::vector<std::size_t> bodies;                                         // of each body of the first: its number here
  std::function<RigidTransform(const RigidTransform&, std::size_t)> back;  // a pose here to that of the first's body
  bool hasOtherSteps = false;  // of contact, where events do not serve: runs are not compared then
};

/// In the mirror x = 0 (axis 0) or z = 0 (axis 2). Every shape of sketches has a mirror plane of its own.
SceneTwin mirroredTwin(const SceneSketch& sketch, int axis);

/// Bodies and links the other way round, links between bodies from the other side.
SceneTwin renumberedTwin(const SceneSketch& sketch);

/// By 37 degrees about the vertical.
SceneTwin turnedTwin(const SceneSketch& sketch);

/// 100 times as large, under the same gravity: times and speeds are 10 times as large (Froude), masses 10^6 times.
/// Steps of contact are those of visible bodies, and more of them make its motion.
SceneTwin scaledTwin(const SceneSketch& sketch);

/// A 64th as large, by powers of two, which round nothing; its accuracy is as much finer. Steps of contact of a few
/// bodies are as many.
SceneTwin shrunkTwin(const SceneSketch& sketch);

/// The image of a pose of `body` in the mirror across `axis` (0: x, 2: z).
RigidTransform mirrorImage(const RigidTransform& worldFromBody, const SketchBody& body, int axis);

}  // namespace cradle
