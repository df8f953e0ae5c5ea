#pragma once

#include "study/study_run.h"

namespace cradle {

/// The settings of one method from coarse to fine: time steps that are halved, or accuracies by tenths; and where they
/// end.
class Ladder {
 public:
  /// Time steps that divide the duration evenly, from the stability limit of `method` on the fastest spring (2 if it
  /// has none, 1/30 s without springs) down to 3e6 steps; or accuracies from 1e-2 to 1e-12.
  Ladder(const StudyMethod& method, const StudyScene& scene);

  double setting() const;

  /// Goes one rung down. False if there is none, or if it would take more than `cpuLimit` (s), twice as long as
  /// `cpuSeconds`.
  bool descend(double cpuSeconds, double cpuLimit);

 private:
  SettingKind kind_;
  double duration_;  // s
  long steps_ = 1;   // of the duration
  int tenths_ = 2;   // accuracy 10^-tenths
};

/// Errors of one method from coarse to fine, watched for the floor that rounding sets.
class GainWatch {
 public:
  /// False once the error is down to `floor`, or has not become less for three rungs though it was small already: large
  /// errors may stay large until a motion is resolved at all.
  bool goesOn(double error, double floor);

 private:
  double least_ = 1e300;
  int rungsWithoutGain_ = 0;
};

}  // namespace cradle
