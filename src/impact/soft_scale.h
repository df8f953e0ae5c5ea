#pragma once

#include "collision/collider.h"

namespace cradle {

/// What SoftParameters are multiplied by, in heaps of small bodies. Under the same gravity a heap of a quarter of the
/// size moves the same way, in half the time, with half the speed (Froude's similarity), if the parameters do too:
/// lengths go with the size, times and speeds with its square root.
struct SoftScale {
  double length = 1;
  double time = 1;

  double speed() const { return length / time; }
};

/// By the smallest inner radius of what moves and is not driven, up to SoftParameters::kFullRadius.
SoftScale scaleOf(const ContactGeometry& geometry);

}  // namespace cradle
