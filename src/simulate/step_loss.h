#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Watches what the fixed steps of a method that the scene names do to the energy, as of pendulums and spinning bodies:
/// a step may be stable, and wrong. (What they do to a spring is told before: energyChangeByStep.) What stays is told,
/// and not what swings about nothing, as with semi-implicit Euler: the mean over the second half of the frames; with
/// springs, where that method changes what the energy swings about, how it differs from the first half's.
class StepLoss {
 public:
  /// Keeps a reference to `scene`.
  explicit StepLoss(const Scene& scene) : scene_(scene) {}

  void add(const Frame& frame);

  /// To be told at the end, if the steps have lost or gained a tenth of the largest kinetic energy by then, or a fifth
  /// of it with springs: how much, and a step with which it is about 1 %.
  std::optional<std::string> warning() const;

 private:
  const Scene& scene_;
  double largestKinetic_ = 0;  // J
  struct Half {
    double sum = 0;  // J: of the numerical energies of its frames
    long frames = 0;

    double mean() const { return sum / static_cast<double>(frames); }
  };
  Half first_, second_;
};

}  // namespace cradle
