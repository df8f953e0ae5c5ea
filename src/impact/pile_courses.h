#pragma once

#include <vector>

#include "core/worker_threads.h"
#include "impact/pile_patches.h"

namespace cradle {

/// Where a pile's bodies are to be expected for the rest of a step that is taken in pieces: on straight courses, as
/// long as nothing deflects them. Tells which pairs cannot come near until its end.
class PileCourses {
 public:
  /// Forgets all courses: at the begin of a step, and for pairs that have not been asked about.
  void forget() { courses_.clear(); }
  bool areForgotten() const { return courses_.empty(); }

  /// Gives new courses to bodies that have none or have left theirs. To be called at each look.
  void renew(const PileLook& look, WorkerThreads& threads);

  /// Whether one of the two has a new course since the look before.
  bool areRenewed(int bodyA, int bodyB) const {
    return isRenewed_[static_cast<std::size_t>(bodyA)] || isRenewed_[static_cast<std::size_t>(bodyB)];
  }

  /// False if the boxes around two moving bodies stay farther apart than PileContacts ask for, at all looks until the
  /// end of the step, as long as both keep their courses.
  bool mayMeet(int bodyA, int bodyB, const PileLook& look) const;

 private:
  /// A box that moves straight on, and how far the body may be beside it.
  struct Course {
    Vec3 end;          // m, of the box's centre at the end of the step
    Vec3 half;         // m
    Vec3 velocity;     // m/s
    double spinSpeed;  // m/s
    double aside;      // m
  };
  static bool isKept(const Course& course, const MovingPose& pose, const PileLook& look);

  std::vector<Course> courses_;
  std::vector<char> isRenewed_;
};

}  // namespace cradle
