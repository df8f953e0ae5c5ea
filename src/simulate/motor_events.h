#pragma once

#include <optional>

#include "simulate/island_state.h"

namespace cradle {

/// A motor that comes to its target, or to the end of its force, inside a step.
struct MotorChange {
  double fraction = 0;  // of the step, 0..1
  std::size_t motor = 0;
  double latest = 1;  // fraction of the step, > `fraction`, at which another motor changes
};

/// Motors with a target velocity over time: one holds its joint's velocity, as long as that takes no more force than it
/// has; else it pushes with all of it, until the joint has the velocity. In an impact a finite force gives nothing:
/// what the impact does to the velocity is taken back by pushing.
class MotorEvents {
 public:
  /// Keeps a reference to `island`.
  explicit MotorEvents(IslandState& island) : island_(island), scales_(island.assembly.mechanism.motors.size(), 1) {}

  /// Whether any motor may change.
  bool any() const;

  /// The first change within a step, whose end derivative must be there (prepareInterpolant).
  std::optional<MotorChange> firstChange(const Step& step);

  /// Whether any motor that may change holds.
  bool anyHolds() const;

  /// Of the step of the last call of firstChange: a step of which length would have the force of motors that hold known
  /// between its samples, as its fourth differences grow with the fourth power of that. Below 1, the step is too long:
  /// a body that motors hold has no error, however long a step is.
  double smoothPart() const;

  /// Zero where the change happens, positive before: the force that is left as a part of all, or the velocity that is
  /// missing as a part of the largest in the step. `state` is that of the step's end.
  double margin(const MotorChange& change, const VectorX& state);

  /// Finds whether each motor holds or pushes from now on, after a change or any other event, and brings those that
  /// hold to their targets. True if one has changed.
  bool resolve(const std::optional<MotorChange>& change);

 private:
  double marginAt(std::size_t motor, double time, const VectorX& state);
  double velocity(std::size_t motor, const VectorX& state);
  bool rests(std::size_t motor) const;
  std::vector<char> reachedWith(std::size_t first);
  std::vector<JointMotor>& motors() { return island_.assembly.mechanism.motors; }

  IslandState& island_;
  std::vector<double> scales_;  // m/s or rad/s, of each motor's velocity in the step under way
  double forceLeft_ = 0;        // of all the force: of the motor that holds and whose margin was asked for last
  double roughness_ = 0;        // fourth differences of that in the step under way, over those that would tell
  std::vector<BodyFrame> frames_;
  VectorX derivative_, sample_;
};

}  // namespace cradle
