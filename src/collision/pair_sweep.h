#pragma once

#include <vector>

#include "collision/separation.h"

namespace cradle {

// Temporary stand-in for the broad phase.
class PairSweep {
 public:
  bool update(const VectorX& state, const std::vector<double>& motions, double margin, ContactGeometry& geometry);
  SurfaceLaw law;

 private:
  std::vector<Bounds> fat_;
  std::vector<Vec3> centers_;
  std::vector<std::pair<double, int>> order_;
};

}  // namespace cradle
