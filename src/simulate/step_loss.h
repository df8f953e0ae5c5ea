#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Watches what the fixed steps of a method that the scene names do to the energy of pendulums and spinning bodies: a
/// step may be stable, and wrong. (Springs are known before: energyChangeByStep.) What stays is told, and not what
/// swings about nothing, as with semi-implicit Euler: the mean over the second half of the frames.
class StepLoss {
 public:
  /// Keeps a reference to `scene`.
  explicit StepLoss(const Scene& scene) : scene_(scene) {}

  void add(const Frame& frame);

  /// To be told at the end, if the steps lost or gained a tenth of the largest kinetic energy or more: how much, and a
  /// step with which it is about 1 %.
  std::optional<std::string> warning() const;

 private:
  const Scene& scene_;
  double largestKinetic_ = 0;  // J
  double sum_ = 0;             // J: of the numerical energies of `frames_` frames, in the second half
  long frames_ = 0;
};

}  // namespace cradle
