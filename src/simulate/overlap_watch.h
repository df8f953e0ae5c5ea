#pragma once

#include <optional>
#include <vector>

#include "simulate/overlap_meter.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// Two bodies that are in each other.
struct Overlap {
  double time = 0;                // s
  int bodyA = 0, bodyB = 0;       // of the scene
  double depth = 0, allowed = 0;  // m
};

/// Compares overlaps in frames with what the plan of a run allows: up to the accuracy where it is promised, elsewhere
/// up to a tenth of a body's half extent, for nothing passes through anything.
class OverlapWatch {
 public:
  /// Keeps a reference to `scene`.
  OverlapWatch(const Scene& scene, const Plan& plan);
  OverlapWatch(const OverlapWatch&) = delete;
  OverlapWatch& operator=(const OverlapWatch&) = delete;

  /// From now on nothing is promised.
  void endPromises() { isPromised_.assign(isPromised_.size(), 0); }

  /// The overlap of a frame that is deepest as part of what is allowed; none if nothing overlaps.
  std::optional<Overlap> worstOf(const Frame& frame);

 private:
  double allowedDepth(const Contact& contact) const;

  const Scene& scene_;
  Assembly assembly_;  // of the whole scene
  OverlapMeter meter_;
  std::vector<char> isPromised_;  // by scene body
};

/// `"a" is 0.01 m deep in "b" at 0.5 s; 1e-6 m is allowed`.
std::string describe(const Overlap& overlap, const Scene& scene);

}  // namespace cradle
