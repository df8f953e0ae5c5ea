#pragma once

#include <vector>

#include "simulate/steps/group_problem.h"
#include "simulate/steps/step_motion.h"

namespace cradle {

/// The impact of all contacts of a set at once, which touch in `state`: Newton's restitution, with static friction,
/// then with dynamic friction where that slides. `timeStep` (s) tells which closing speeds forces explain. Changes the
/// velocities in `state` and books the energy; returns the impulses (N s, world, on B). Constraints must be factorised.
std::vector<Vec3> resolveStepImpact(const ContactSet& contacts, double timeStep, GroupProblem& problem, VectorX& state,
                                    std::vector<SteppingFault>& faults);

}  // namespace cradle
