#pragma once

#include <string>
#include <vector>

#include "study/study_run.h"

namespace cradle {

/// A reference that is known less well is told about in capitals: the accuracy of a scene that names none.
constexpr double kTrustedUncertainty = 1e-6;

/// The end of a scene as exactly as it can be had.
struct Reference {
  std::vector<BodyState> end;
  double uncertainty = 0;    // as motionError has it: errors below mean nothing
  std::string madeBy;        // "RK4, step 1e-4 s"
  std::string confirmation;  // how the uncertainty was found, in a sentence
};

/// Adaptive DOP853 at its best if the simulation has it, checked by RK4; else RK4 alone, its steps halved until that
/// changes nothing. Calls `tick` after each run. Throws Error(limit) if RK4 is unstable at all steps, or takes too
/// long.
Reference findReference(StudyScene& scene, const std::function<void()>& tick);

}  // namespace cradle
