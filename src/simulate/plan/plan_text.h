#pragma once

#include <string>

#include "simulate/plan/plan.h"

namespace cradle {

/// The methods of all islands, each named once; and what accuracy they promise.
std::string methodNames(const Plan& plan);
std::string accuracyPromised(const Plan& plan);

/// The plan in words, a few lines for each kind of island.
std::string describe(const Plan& plan, const Scene& scene);

}  // namespace cradle
