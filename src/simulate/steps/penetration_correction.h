#pragma once

#include <vector>

#include "simulate/steps/group_problem.h"

namespace cradle {

/// Moves the bodies of a group apart where `gaps` (m, of its contacts) are negative: by the displacements of least
/// kinetic energy that make all gaps zero or positive, at most 5 % of a size. Velocities stay as they are. `problem`
/// must be set to the group.
void separateGroup(const StepGroup& group, const ContactSet& contacts, const VectorX& gaps, GroupProblem& problem,
                   VectorX& state);

/// Moves bodies apart that overlap in `state`, with their constraints; the energy that lifts them is taken from their
/// velocities, and momenta that nothing fixed hinders stay as they are. Constraints must be factorised.
void correctPenetration(const ContactSet& contacts, GroupProblem& problem, VectorX& state,
                        std::vector<SteppingFault>& faults);

}  // namespace cradle
