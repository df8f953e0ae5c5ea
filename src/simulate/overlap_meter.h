#pragma once

#include <vector>

#include "collision/broad_phase.h"
#include "collision/separation.h"
#include "simulate/assembly.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Finds what overlaps in frames, of those pairs whose contact is simulated, from the states alone.
class OverlapMeter {
 public:
  /// Keeps a reference to `assembly`, which is of a whole scene.
  explicit OverlapMeter(const Assembly& assembly) : assembly_(assembly), geometry_(assembly.geometry) {}

  /// Contacts with separation <= 0.
  const std::vector<Contact>& overlapsOf(const VectorX& state);

  /// Scene bodies of a contact that was found last.
  std::pair<int, int> bodiesOf(const Contact& contact) const;

  /// m: the least half extent of the moving ones among the colliders of a contact that was found last.
  double halfExtent(const Contact& contact) const;

 private:
  const Assembly& assembly_;
  ContactGeometry geometry_;
  BroadPhase broadPhase_;
  std::vector<Contact> overlaps_;
};

/// A frame's poses, in the place of those of the start.
VectorX stateOf(const Assembly& assembly, const Frame& frame);

}  // namespace cradle
