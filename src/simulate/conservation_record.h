#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "constraints/invariants.h"
#include "core/byte_archive.h"
#include "simulate/assembly.h"

namespace cradle {

/// What a method changes of a sum that the laws keep, in the frames of a run: those frames in which it is more than in
/// all before, and beyond what is judged by then.
class Drift {
 public:
  /// `drift` >= 0, in the unit of the sum; `most`: the largest that counts as kept, which later frames may raise.
  void add(double time, double drift, double most) {
    const bool isLargest = largest_.empty() || drift > largest_.back().second;
    if (isLargest && drift > most) largest_.emplace_back(time, drift);
  }

  /// Time (s) of the first frame beyond `most`.
  std::optional<double> firstBeyond(double most) const;

  template <class Archive>
  friend void visit(Archive& archive, Visited<Archive, Drift>& drift) {
    archive(drift.largest_);
  }

 private:
  std::vector<std::pair<double, double>> largest_;  // s, drift: ascending
};

/// Judges by the frames of an island whether the accuracy was kept: by numerical energy, by energy that impacts,
/// friction and dampers have taken, which they never give back, and by momentum and angular momentum of an island on
/// which nothing acts from outside but gravity. (What is fixed takes any momentum.) The measure of the energy is the
/// largest in the run: the kinetic energy, the change of the potential energy, and what a fall of the bodies by
/// their radii of gyration would give. The measures of the momenta are the largest sums of the bodies' magnitudes.
class ConservationRecord {
 public:
  /// Its measures so far.
  struct Measures {
    double startTime = 0;  // s
    Invariants start;
    Vec3 startSpin = Vec3::Zero();  // kg m^2/s: angular momentum about the centre of mass of all
    double largestEnergy = 0, largestMomentum = 0, largestSpin = 0;  // J, kg m/s, kg m^2/s
    struct Dissipation {
      double taken = 0;  // J: the most in a frame until now
      Drift given;
    };
    Dissipation byImpact, byFriction, byDamping;
    Drift energy, momentum, spin;
  };

  /// Keeps a reference to `assembly`. `accuracy`: the one asked, m/s of bodies at rest.
  ConservationRecord(const Assembly& assembly, double accuracy);

  /// One that goes on.
  ConservationRecord(const Assembly& assembly, double accuracy, Measures measures);

  const Measures& measures() const { return measures_; }

  /// To be called with states between frames, too: what is moved to and fro may stand still at all frames.
  void measure(const VectorX& state);

  /// To be called with each frame's time (s) and state.
  void add(double time, const VectorX& state);

  /// A sum that was not kept to kMaxNumericalRatio times the accuracy, beside rounding of places: "numerical energy".
  struct Loss {
    double time = 0;  // s: of the first such frame
    std::string_view sum;
  };

  /// The first of them.
  std::optional<Loss> firstLoss() const;

 private:
  void measureEnergy(const Invariants& sums);
  void addMomenta(double time, const VectorX& state, const Invariants& sums);

  const Assembly& assembly_;
  double ratio_;     // of the measures
  bool isIsolated_;  // nothing acts from outside but gravity
  Measures measures_;
};

/// What such a loss makes of the promise of the scene's `bodies`.
PromiseEnd endOf(const ConservationRecord::Loss& loss, const std::vector<int>& bodies, const Scene& scene);

}  // namespace cradle
