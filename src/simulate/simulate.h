#pragma once

#include <functional>
#include <string>

#include "scene/scene.h"
#include "simulate/corrections.h"
#include "simulate/plan/plan.h"
#include "trajectory/trajectory.h"

namespace cradle {

class World;

/// Where the results of a run go, in the order of time: events of an instant before the frame of that instant.
struct SimulationSink {
  std::function<void(const Frame&)> frame;
  std::function<void(const Event&)> event;
  std::function<void(const std::string&)> warning;         // what the user should know, as soon as it is known
  std::function<void(const Correction&)> correction = {};  // the first of each kind, before its warning; may be none
  std::function<void(const PromiseEnd&)> promiseEnd = {};  // of each island, before the warning; may be none
  /// Each contact that lasts, when it begins, before its first frame, and again when it has ended; may be none: then
  /// frames have no contacts, either.
  std::function<void(const LastingContact&)> contact = {};
  std::function<void(const Checkpoint&)> checkpoint = {};  // behind its frame; may be none
  std::function<void(double time)> reached = {};  // s, inside a frame that takes seconds, once a second; may be none
};

/// What a trajectory says before its first frame.
TrajectoryHeader headerOf(const Scene& scene, const Plan& plan);

/// Runs the scene from frame 0 to lastFrame(scene) and hands on what happens. Throws Error(scene) for what cannot be
/// simulated yet (before the first frame), Error(unstable), Error(limit), Error(interrupted), and whatever the sink
/// throws.
RunCost simulate(const Scene& scene, const SimulationSink& sink);

/// Of World::work between checkpoints: about two seconds. At a checkpoint steps end, and all motion is thrown away and
/// built again from a plain record, so that a run which goes on from that record has the same bits.
constexpr long kCheckpointWork = 3'000'000;

/// The same for a run that has been begun, and is at its start, or goes on from the record of a Checkpoint: `sink` is
/// told what is behind that, and the warnings from the start on. `scene` has passed refuseUnsupported.
RunCost simulate(const Scene& scene, World& run, const SimulationSink& sink, const std::string& record = "",
                 long checkpointWork = kCheckpointWork);

/// The whole run in memory.
Trajectory simulate(const Scene& scene);

}  // namespace cradle
