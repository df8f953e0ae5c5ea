#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

namespace cradle {

/// What is checked of a folder of ground truth.
enum class Aspect {
  camera,
  depth,
  normal,
  segmentation,
  objectCoordinates,
  flow,
  backwardFlow,
  hidden,
  reprojection,
  silhouette,
  instances,
  events
};
constexpr std::size_t kAspects = 12;

/// The name of an aspect, and of what its deviations are measured in.
const char* nameOf(Aspect aspect);
const char* unitOf(Aspect aspect);

/// Where a number is: of a pixel, or, with x < 0, of a file as a whole.
struct FoundPlace {
  std::string file;
  int x = -1, y = -1;  // pixels, from the upper left
};

/// A number that is not as it should be.
struct Fault {
  FoundPlace place;
  std::string found, expected;
};

/// What came of one aspect: the number with the largest share of what is allowed to it.
struct Tally {
  long values = 0, faults = 0;
  double deviation = 0, tolerance = 0;  // of the worst
  std::optional<Fault> fault;           // of the worst

  bool holds() const { return faults == 0; }
};

/// Collects deviations of numbers from what they should be.
class Findings {
 public:
  /// A number that deviates by more than `tolerance`, or by what is no number, is a fault; describe() gives it. It may
  /// stand for more numbers, of which some are wrong.
  template <class Describe>
  void add(Aspect aspect, double deviation, double tolerance, const Describe& describe, long values = 1,
           long wrong = 1) {
    Tally& tally = tallies_[static_cast<std::size_t>(aspect)];
    const bool isFirst = tally.values == 0;
    tally.values += values;
    if (std::isnan(deviation)) deviation = std::numeric_limits<double>::infinity();
    const bool isFault = deviation > tolerance;
    if (isFault) tally.faults += wrong;
    if (!isFirst && !isWorse(deviation, tolerance, tally)) return;
    tally.deviation = deviation;
    tally.tolerance = tolerance;
    if (isFault) tally.fault = describe();
  }

  const Tally& of(Aspect aspect) const { return tallies_[static_cast<std::size_t>(aspect)]; }
  bool hold() const;

 private:
  static bool isWorse(double deviation, double tolerance, const Tally& than);

  std::array<Tally, kAspects> tallies_;
};

/// A fault in words, beside the numbers of its tally.
std::string describe(const Fault& fault, const Tally& tally, Aspect aspect);

}  // namespace cradle
