#include "impact/soft_scale.h"

#include <algorithm>
#include <cmath>

#include "impact/soft_parameters.h"

namespace cradle {

SoftScale scaleOf(const ContactGeometry& geometry) {
  double radius = SoftParameters::kFullRadius;
  for (const Collider& collider : geometry.colliders)
    if (collider.body != kFixed && !collider.isDriven)
      radius =
          std::min(radius, std::max(innerRadius(collider), SoftParameters::kMinThickness * collider.boundingRadius));
  const double length = radius / SoftParameters::kFullRadius;
  return {length, std::sqrt(length)};
}

}  // namespace cradle
