#pragma once

#include <vector>

#include "constraints/constraint_forces.h"
#include "constraints/limit.h"

namespace cradle {

/// A rope at its length that pulls.
struct RopePull {
  const Limit* rope = nullptr;
  double reboundSpeed = 0;  // m/s: how fast it is to shorten afterwards, at least
  double impulse = 0;       // N s, found
};

/// Finds and applies the impulses of all pulls at once, so that their order does not matter: none pushes, each rope
/// shortens with its rebound speed or faster, and those that shorten faster do not pull. The bodies' constraints answer
/// within the same impulses. The solver must be factorised for `state`. O(pulls^3) at most for each pull that is not
/// needed.
void applyPulls(std::vector<RopePull>& pulls, const std::vector<RigidBody>& bodies, ConstraintSolver& constraints,
                VectorX& state);

}  // namespace cradle
