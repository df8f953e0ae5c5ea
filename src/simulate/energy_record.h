#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "simulate/assembly.h"

namespace cradle {

/// The numerical energy in the frames of an island, beside the largest energy in them: the kinetic energy, the change
/// of the potential energy, and what a fall of the bodies by their radii of gyration would give.
class EnergyRecord {
 public:
  /// Keeps a reference to `assembly`. `accuracy`: the one asked, m/s of bodies at rest.
  EnergyRecord(const Assembly& assembly, double accuracy);

  /// To be called with each frame's time (s) and state.
  void add(double time, const VectorX& state);

  /// Time (s) of the first frame whose numerical energy is beyond kMaxNumericalRatio times the accuracy of the largest
  /// energy of all frames, and what rounding of places makes of it.
  std::optional<double> firstBeyond() const;

 private:
  const Assembly& assembly_;
  double ratio_;                           // of the largest energy
  double largestEnergy_, startPotential_;  // J
  std::vector<std::pair<double, double>>
      numerical_;  // frames that were beyond so far: s, J; each more than those before
};

}  // namespace cradle
