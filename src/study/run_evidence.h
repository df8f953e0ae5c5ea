#pragma once

#include <map>
#include <optional>
#include <utility>

#include "simulate/overlap_watch.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Two bodies that touched in one of two runs alone.
struct TouchDifference {
  double time = 0;           // s
  int bodyA = 0, bodyB = 0;  // of the scene
  bool isInFirst = false;    // of the two runs
};

/// What a run shows of itself, without another one: overlaps, what its energies leave unexplained, and what touched.
class RunEvidence {
 public:
  /// Keeps a reference to `scene`. `plan`: of the run.
  RunEvidence(const Scene& scene, const Plan& plan) : overlaps_(scene, plan) {}

  void endPromises() { overlaps_.endPromises(); }
  void add(const Event& event);
  void add(const Frame& frame);

  /// The overlap that is deepest as part of what is allowed.
  const std::optional<Overlap>& overlap() const { return overlap_; }

  /// Largest change of kinetic + potential + dissipated - work, as part of the largest kinetic energy.
  double numericalEnergy() const { return largestKinetic_ > 0 ? energyChange_ / largestKinetic_ : 0; }

  /// The first pair, in the order of time, that touched in one of the runs alone, until `time` (s).
  static std::optional<TouchDifference> difference(const RunEvidence& first, const RunEvidence& second, double time);

 private:
  /// The first impact of a pair, and its hardest.
  struct Touch {
    double time = 0, impulse = 0;  // s, N s
  };
  OverlapWatch overlaps_;
  std::optional<Overlap> overlap_;
  bool isFirst_ = true;
  double startConstant_ = 0, energyChange_ = 0, largestKinetic_ = 0;  // J
  double hardest_ = 0;                                                // N s
  std::map<std::pair<int, int>, Touch> touches_;
};

}  // namespace cradle
