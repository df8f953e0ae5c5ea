#pragma once

#include <optional>
#include <vector>

#include "simulate/events/event_tolerances.h"
#include "simulate/events/impact_sequence.h"
#include "simulate/island_state.h"

namespace cradle {

/// Gaps of contacts shortly after impacts at them, which have made them zero. From then on a gap is the sum of speed x
/// time, which tells far smaller ones than places do.
class KnownGaps {
 public:
  /// The gap of a contact and its error.
  struct Gap {
    double gap = 0, error = 0;  // m
  };

  /// Keeps references to both. Time and state of the island are those of now.
  KnownGaps(const IslandState& island, const EventTolerances& tolerances) : island_(island), tolerances_(tolerances) {}

  /// Keeps the gaps at the end of a sequence of impacts whose error is below `largestError` (m), in place of those of
  /// before.
  void keep(const ImpactSequence& sequence, double largestError);

  /// The gap of a contact now, if its error is below `largestError` (m).
  std::optional<Gap> find(const Contact& contact, double largestError) const;

  /// A gap that closes.
  struct Closing {
    double time = 0;       // s
    std::size_t pair = 0;  // index into ContactGeometry::pairs
  };

  /// The next gap to close after now of those that are too small for places to show that they are open.
  std::optional<Closing> nextHidden() const;

 private:
  struct Known {
    ColliderPair pair;
    Contact contact;
    Gap gap;
    double speed = 0;  // m/s, of opening
  };
  const Known* knownAt(const Contact& contact) const;

  const IslandState& island_;
  const EventTolerances& tolerances_;
  std::vector<Known> known_;
  double time_ = 0;  // s
};

}  // namespace cradle
