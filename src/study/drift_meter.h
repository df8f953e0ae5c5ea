#pragma once

#include "simulate/overlap_meter.h"

namespace cradle {

/// How far a motion leaves what it should keep, over all frames that it is given.
class DriftMeter {
 public:
  /// Keeps a reference.
  explicit DriftMeter(const Assembly& assembly) : assembly_(assembly), overlaps_(assembly) {}

  void add(const Frame& frame);

  /// Largest change of the energy constant since the first frame, as part of the largest kinetic energy.
  double energyDrift() const;
  /// Largest error of a rod or joint in m (of what it keeps of orientations in rad).
  double constraintDrift() const { return constraintDrift_; }
  /// Deepest overlap of two bodies in m, of those pairs whose contact is simulated.
  double penetration() const { return penetration_; }

 private:
  const Assembly& assembly_;
  OverlapMeter overlaps_;
  bool isFirst_ = true;
  double startConstant_ = 0, energyChange_ = 0, largestKinetic_ = 0;  // J
  double constraintDrift_ = 0, penetration_ = 0;
};

}  // namespace cradle
