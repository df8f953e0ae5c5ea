#pragma once

#include "math/types.h"

namespace cradle {

struct PrincipalAxes {
  Vec3 moments;  // in the units of the tensor, in no order
  Mat3 axes;     // a rotation: column i belongs to moments[i]
};

/// Moments and axes of a symmetric tensor. A diagonal one keeps its moments to the bit.
PrincipalAxes principalAxes(const Mat3& tensor);

}  // namespace cradle
