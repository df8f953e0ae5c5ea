#pragma once

#include <limits>
#include <string>
#include <vector>

#include "simulate/corrections.h"
#include "simulate/overlap_watch.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Watches a run that is to end at the first thing that is not as the plan says: a promise given up, a correction, or
/// bodies deeper in each other than their promise allows, measured from the frames alone.
class StrictWatch {
 public:
  /// Keeps a reference to `scene`. `plan` is that of the run, whose first instant is decided.
  StrictWatch(const Scene& scene, const Plan& plan);

  void note(const PromiseEnd& end);
  void note(const Correction& correction);

  /// To be called with each frame, after what was noted until then. Throws Error(unstable) that tells of the first
  /// fault, with time and bodies.
  void check(const Frame& frame);

  /// The same after the last frame, of what was noted since.
  void finish() const { tellOfFirst(std::numeric_limits<double>::infinity()); }

 private:
  void tellOfFirst(double until) const;

  struct Fault {
    double time;  // s
    std::string text;
  };
  const Scene& scene_;
  OverlapWatch overlaps_;
  std::vector<Fault> faults_;
};

}  // namespace cradle
