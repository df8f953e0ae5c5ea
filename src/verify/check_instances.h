#pragma once

#include "verify/truth_frame.h"

namespace cradle {

/// The annotations of a frame: masks, boxes and areas against its segmentation, poses and velocities against the
/// trajectory, and what bodies are against the scene.
void checkInstances(const VerifiedFilm& film, const TruthFrame& frame, Findings& findings);

/// The events of `events.json` against those of the trajectory.
void checkEvents(const VerifiedFilm& film, const std::vector<EventRecord>& records, Findings& findings);

}  // namespace cradle
