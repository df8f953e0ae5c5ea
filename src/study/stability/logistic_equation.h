#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

/// y' = 6 y - 0.007 y^2, y(0) = 10: grows to kLogisticEnd, and settles there.
constexpr double kLogisticGrowth = 6, kLogisticLoss = 0.007, kLogisticStart = 10;  // 1/s, 1/s, -
constexpr double kLogisticEnd = kLogisticGrowth / kLogisticLoss;

/// y at a time (s) in closed form.
double logisticSolution(double time);

/// y after 0, 1, ... `steps` steps of `timeStep` (s) of a method.
std::vector<double> logisticSteps(Integrator integrate, double timeStep, int steps);

}  // namespace cradle
