#pragma once

#include <cstdint>
#include <limits>

#include "math/types.h"

namespace cradle {

constexpr double kFlat = std::numeric_limits<double>::infinity();       // m: radius of a surface at a flat face
constexpr double kNotRound = std::numeric_limits<double>::quiet_NaN();  // of an edge, a rim, a cylinder's side

/// One point where two surfaces are near.
struct ContactPoint {
  Vec3 point = Vec3::Zero();   // m: middle between the two surfaces
  Vec3 normal = Vec3::Zero();  // unit, from A to B
  double separation = 0;       // m, < 0: overlap
  // m: radius of the sphere that each surface is there: 0 a corner, kFlat, or kNotRound.
  double radiusA = kNotRound, radiusB = kNotRound;
  // Where a sphere touches a mesh: the unit direction of the edge, else zero; and the number of the edge, of the vertex
  // (whose radius is 0) or of a face (whose radius is kFlat).
  Vec3 edge = Vec3::Zero();
  std::uint32_t feature = 0;
};

}  // namespace cradle
