#pragma once

#include <functional>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// A push that took place, as a film shows it: from a little before it starts until a little after it ends.
struct ShownPush {
  int body = 0;                          // index into Scene::bodies
  Vec3 pointAtStart = Vec3::Zero();      // m, world: what is pushed, when the push starts
  Vec3 pointOfBody = Vec3::Zero();       // m, body's frame: the same, from then on
  Vec3 force = Vec3::Zero();             // N, world; of a torque N m
  bool isTorque = false;                 // drawn as an arc about its axis
  double clearance = 0;                  // m: the least radius of that arc, so that it goes round the body
  double start = 0;                      // s
  double shownFrom = 0, shownUntil = 0;  // s

  bool isShownAt(double time) const { return time >= shownFrom && time <= shownUntil; }

  /// Where the force acts, or is going to act (m, world), with bodies placed as at `time`.
  Vec3 pointAt(double time, const std::vector<RigidTransform>& worldFromBody) const;
};

/// A frame of a trajectory by its number; the last one in place of those after it.
using FrameSource = std::function<Frame(long)>;

/// The pushes of a scene that hit their bodies according to `events`, in order of time.
std::vector<ShownPush> findShownPushes(const Scene& scene, const std::vector<Event>& events,
                                       const FrameSource& frameAt);

}  // namespace cradle
