#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dynamics/integrators/step.h"
#include "scene/scene.h"
#include "study/stability/maps.h"

namespace cradle {

constexpr int kCountedBounces = 5;

/// A fixed-step method, and what its textbook collisions do to the height of a bouncing ball.
struct BounceMethod {
  std::string title;
  MethodName name;
  Integrator integrate;

  /// Change of the height that a bounce with speed s leaves, beside e^2, in parts of s h: from where in a step an
  /// impact falls, in the mean, and from what the integrator does to a parabola.
  double heightChange(double restitution) const;
};
const std::vector<BounceMethod>& bounceMethods();

/// Height (m) of the ball's lowest point after five bounces of textbook collisions, dropped from `height` (m). NaN if
/// it does not bounce so often.
double heightAfterBounces(const BounceMethod& method, double restitution, double height, double timeStep);

/// The mean of that over drops from 1 m, and a little more each time, so that impacts fall anywhere in a step; in parts
/// of what is right, less 1.
double meanHeightError(const BounceMethod& method, double restitution, double timeStep, int drops);

/// The same by theory.
double expectedHeightError(const BounceMethod& method, double restitution, double timeStep);

/// The error of a ball dropped from 1 m with impacts at events: by the scene's plan, or by a method that it names.
double heightErrorWithEvents(double restitution, const std::optional<Method>& method);

/// Restitution and time step against the height after five bounces.
StabilityMap bounceEnergyMap(const MapProgress& progress);

}  // namespace cradle
