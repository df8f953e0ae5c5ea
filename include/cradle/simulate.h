#pragma once

#include <functional>
#include <string>

#include "cradle/trajectory.h"

namespace cradle::v1 {

/// Told while a simulation runs, in the order of time; any may be none. What they throw ends the simulation, and is
/// thrown by it.
struct Callbacks {
  std::function<void(const Frame&)> frame = {};
  std::function<void(const Event&)> event = {};          // before the frame of its instant
  std::function<void(const std::string&)> warning = {};  // what the user should know, as soon as it is known
  std::function<void(double time)> reached = {};         // s, inside a frame that takes seconds, once a second
};

/// Simulates a scene from frame 0 to its duration: the same bits as `cradle simulate`. Throws Error(scene) for what
/// cannot be simulated, before the first frame; Error(unstable), Error(limit), Error(output).
Trajectory simulate(const Scene& scene, const Callbacks& callbacks = {});

/// The same for who needs no more than what the callbacks are told.
void simulateOnly(const Scene& scene, const Callbacks& callbacks);

}  // namespace cradle::v1
