#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulate/plan/plan.h"

namespace cradle {

/// "RK4, step 0.001 s".
std::string describe(const ChosenMethod& method);

/// "gear.3ds as mesh": the models that may touch something, each way once.
std::vector<std::string> collisionOfModels(const Scene& scene);

/// The methods of all islands, each named once; and what accuracy they promise.
std::string methodNames(const Plan& plan);
std::string accuracyPromised(const Plan& plan);

/// The promise of all islands together: the weakest of them.
std::string promiseOfAll(const Plan& plan);

/// The plan in words, a few lines for each kind of island.
std::string describe(const Plan& plan, const Scene& scene);

/// The promise of each island and its outcome, a line for each kind of island: "a, b: promised; kept". `ends`: by
/// island.
std::string describeOutcome(const Plan& plan, const std::vector<std::optional<PromiseEnd>>& ends, const Scene& scene);

}  // namespace cradle
