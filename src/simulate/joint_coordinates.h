#pragma once

#include <vector>

#include "simulate/assembly.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// The coordinates of an island's hinges and sliders over time. An orientation tells a turn but for whole ones: these
/// are counted from step to step, of whatever lies less than half a turn from the mean of a step's first and last
/// angular velocity.
class JointCoordinates {
 public:
  /// Keeps a reference to `assembly`, which is in the state of the start.
  explicit JointCoordinates(const Assembly& assembly);

  /// To be told the state in which each step begins (after events), and that in which its motion of `length` (s) ends
  /// (before events).
  void beginStep(const VectorX& state);
  void endStep(double length, const VectorX& state);

  /// Sets the joints' coordinates and velocities, in the order of the assembly, in a state of the last step, `length`
  /// (s) after its end: at 0 that after its events, before it one of its motion. `found` has one for each joint.
  void find(double length, const VectorX& state, std::vector<JointState>& found);

 private:
  JointState stateOf(std::size_t joint, double length, const VectorX& state) const;

  const Assembly& assembly_;
  std::vector<JointState> last_;   // where the last step ended
  std::vector<BodyFrame> frames_;  // scratch
};

}  // namespace cradle
