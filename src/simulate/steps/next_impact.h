#pragma once

#include <cmath>
#include <vector>

#include "simulate/steps/group_problem.h"
#include "simulate/steps/step_motion.h"

namespace cradle {

/// The first impact inside a step between bodies that are apart when it begins.
struct NextImpact {
  double fraction = INFINITY;       // of the step, <= 1; infinite: there is none
  std::vector<char> strikesInside;  // by contact: whether it strikes inside the step
};

/// The next impact of contacts that close faster than `minSpeed` (m/s), while contacts that touch keep bodies as the
/// step's own problem says. Uses `problem` for that, whose memory should be the step before.
NextImpact findNextImpact(const ContactSet& contacts, const FreeStep& step, double minSpeed, GroupProblem& problem);

}  // namespace cradle
