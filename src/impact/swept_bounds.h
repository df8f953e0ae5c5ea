#pragma once

#include <vector>

#include "core/worker_threads.h"
#include "impact/soft_manifolds.h"

namespace cradle {

/// Where a heap's bodies are to be expected for the rest of a step that is taken in groups of sub-steps: on straight
/// swept bounds, as long as nothing deflects them. Tells which pairs cannot come near until its end.
class SweptBounds {
 public:
  /// Forgets all swept bounds: at the begin of a step, and for pairs that have not been asked about.
  void forget() { courses_.clear(); }
  bool areForgotten() const { return courses_.empty(); }

  /// Gives new swept bounds to bodies that have none or have left theirs. To be called at each look.
  void renew(const SoftStepStart& look, WorkerThreads& threads);

  /// Whether one of the two has a new swept bounds since the look before.
  bool areRenewed(int bodyA, int bodyB) const {
    return isRenewed_[static_cast<std::size_t>(bodyA)] || isRenewed_[static_cast<std::size_t>(bodyB)];
  }

  /// False if the boxes around two moving bodies stay farther apart than SoftContacts ask for, at all looks until the
  /// end of the step, as long as both keep their swept bounds.
  bool mayMeet(int bodyA, int bodyB, const SoftStepStart& look) const;

 private:
  /// A box that moves straight on, and how far the body may be beside it.
  struct Course {
    Vec3 end;          // m, of the box's centre at the end of the step
    Vec3 half;         // m
    Vec3 velocity;     // m/s
    double spinSpeed;  // m/s
    double aside;      // m
  };
  static bool isKept(const Course& course, const MovingPose& pose, const SoftStepStart& look);

  std::vector<Course> courses_;
  std::vector<char> isRenewed_;
};

}  // namespace cradle
