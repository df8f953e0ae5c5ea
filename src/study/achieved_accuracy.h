#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "study/growth_meter.h"
#include "study/stepped_runs.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// How far one dynamic body was from the finer run.
struct BodyError {
  std::string body;
  double error = 0;  // the largest |x - x_ref| / (1 + |x_ref|) over numbers x of position (m) and orientation
  double time = 0;   // s, of that error
};

/// The first frame at which points of a body are off by 1 % of its size from where a run of another accuracy has them.
struct Horizon {
  long frame = 0;
  double time = 0;   // s
  std::string body;  // the one that is off by the most of its size
};

/// What the states of a run are worth.
struct AchievedAccuracy {
  bool isHeap = false;             // it has no finer run at its speed: errors are what the disturbance changes
  std::string finerRun;            // "accuracy 1e-08", "time step 1e-05 s"; empty for a heap
  std::vector<BodyError> bodies;   // dynamic ones, in the order of the scene; up to meaninglessFrom, if that is
  double disturbance = 0;          // m/s and rad/s that a third run starts with, above the scene's velocities
  double largestDifference = 0;    // that it makes, in the measure of errors
  std::optional<Horizon> horizon;  // up to it the motion is the scene's, from it on one of many; none: all of it is
  std::optional<Divergence> divergence;  // set if it grows more than a hundred times faster than time

  std::string overlap, finerOverlap;            // deepest, in words; empty if nothing overlaps
  double numericalEnergy = 0, finerEnergy = 0;  // changes of the energies' sum, parts of the largest kinetic one
  std::string touchDifference;                  // what touched in one of the two runs alone, in words; or empty
  std::optional<OtherMethod> other;             // if contact that may come about is found as events
  std::string closeImpacts;                     // that the other method cannot tell apart, in words; or empty
  std::string fault;                            // what no sensitivity explains, in words; or empty
};

/// Compares a finished run of `scene` with one at a hundredth of the accuracy (1e-12 at the least), or of the error
/// that the named method's time step has by its order; and that one with a third, whose velocities differ a little at
/// the start. Where contact is found as events, two more runs take steps of one length: a fault of events, which two
/// accuracies may share, differs from these, and so it is told from chaos. All go side by side: memory O(bodies).
/// `tick` is told the frames done, and may throw. Throws what simulating throws.
AchievedAccuracy achievedAccuracy(const Scene& scene, const TrajectoryReader& run,
                                  const std::function<void(long)>& tick);

/// For a person, a line a body.
std::string describe(const AchievedAccuracy& accuracy);

}  // namespace cradle
