#pragma once

#include <optional>

#include "collision/separation.h"
#include "dynamics/integrators/step.h"

namespace cradle {

/// A contact that comes about inside a step.
struct ImpactTime {
  double fraction = 0;  // of the step, 0..1
  std::size_t pair = 0, feature = 0;
};

/// The first instant of a step at which two features that are apart by more than `tolerance` (m) at its start come
/// together. Searched on the step's interpolant by bisection, with a bound on the relative speed so that nothing passes
/// through anything. The step's end rate must be there (prepareInterpolant).
std::optional<ImpactTime> firstImpact(const ContactGeometry& geometry, const Step& step, double tolerance);

}  // namespace cradle
