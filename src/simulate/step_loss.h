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
  struct Half {
    double sum = 0;  // J: of the numerical energies of its frames
    long frames = 0;

    double mean() const { return sum / static_cast<double>(frames); }
  };
  /// Of the frames so far.
  struct Energies {
    double largestKinetic = 0;  // J
    Half first, second;
  };

  /// Keeps a reference to `scene`.
  StepLoss(const Scene& scene, const Energies& soFar) : scene_(scene), energies_(soFar) {}

  /// And of that one.
  Energies with(const Frame& frame) const;

  /// To be told at the end, if the steps have lost or gained a tenth of the largest kinetic energy by then, or a fifth
  /// of it with springs: how much, and a step with which it is about 1 %.
  std::optional<std::string> warning() const;

 private:
  const Scene& scene_;
  Energies energies_;
};

}  // namespace cradle
