#pragma once

#include "dynamics/free_rotation.h"
#include "dynamics/rigid_body.h"

namespace cradle {

/// One body's motion under uniform gravity alone, in closed form: a parabola and a free rotation.
class FreeFlight {
 public:
  /// Starts at time 0 from the body's entries in `state`; gravity in m/s^2.
  FreeFlight(const RigidBody& properties, const VectorX& state, Eigen::Index body, const Vec3& gravity);

  /// Sets the body's entries in `state` to what they are at `time` (s). O(1).
  void moveTo(double time, VectorX& state) const;

 private:
  Eigen::Index body_;
  Vec3 position_, velocity_, gravity_;
  FreeRotation rotation_;
};

}  // namespace cradle
