#include "simulate/step_loss.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/elementary.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kToldRatio = 0.05;      // of the largest kinetic energy: a tenth at the end
constexpr double kToldDifference = 0.1;  // the same, of the means of two halves: a fifth
constexpr double kHarmlessRatio = 0.01;  // the same

/// The power of the step that errors in a given time go with, at least.
int orderOf(MethodName method) {
  switch (method) {
    case MethodName::explicitEuler:
    case MethodName::semiImplicitEuler:
      return 1;
    case MethodName::rk4:
      return 4;
    case MethodName::dop853:
      return 8;
  }
  return 1;
}

/// J: of bodies that move no faster than rounding.
double roundedKinetic(const Scene& scene) {
  double mass = 0;
  for (const Body& body : scene.bodies)
    if (body.motion == Motion::dynamic) mass += body.massProperties.mass;
  return 0.5 * mass * kRestSpeedFloor * kRestSpeedFloor;
}

}  // namespace

StepLoss::Energies StepLoss::with(const Frame& frame) const {
  Energies energies = energies_;
  energies.largestKinetic = std::max(energies.largestKinetic, frame.energy.kinetic);
  Half& half = 2 * frame.time < scene_.duration ? energies.first : energies.second;
  half.sum += frame.energy.numerical;
  ++half.frames;
  return energies;
}

std::optional<std::string> StepLoss::warning() const {
  if (!scene_.method || !scene_.method->timeStep || energies_.first.frames == 0 || energies_.second.frames == 0)
    return std::nullopt;
  if (!(energies_.largestKinetic > roundedKinetic(scene_))) return std::nullopt;
  const bool hasSprings = !scene_.springs.empty();
  const double lost = hasSprings ? energies_.second.mean() - energies_.first.mean() : energies_.second.mean();
  const double ratio = std::abs(lost) / energies_.largestKinetic;
  if (!(ratio > (hasSprings ? kToldDifference : kToldRatio))) return std::nullopt;
  const double timeStep = *scene_.method->timeStep;
  return fmt::format(
      "{}: the steps of {:.3g} s alone {} {:.3g} J, {:.0f} % of the largest kinetic energy; with a \"timeStep\" of "
      "{:.2g} s it is about 1 %",
      scene_.path, timeStep, lost > 0 ? "take" : "add", std::abs(lost), 100 * ratio,
      timeStep * cradle::exp(cradle::log(kHarmlessRatio / ratio) / orderOf(scene_.method->name)));
}

}  // namespace cradle
