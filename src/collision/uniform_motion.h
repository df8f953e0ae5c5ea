#pragma once

#include "math/types.h"

namespace cradle {

/// A point under constant acceleration; time 0 is that of a clock of its own.
struct UniformMotion {
  Vec3 position = Vec3::Zero();      // m
  Vec3 velocity = Vec3::Zero();      // m/s
  Vec3 acceleration = Vec3::Zero();  // m/s^2

  Vec3 positionAfter(double time) const { return position + time * (velocity + time / 2 * acceleration); }
  Vec3 velocityAfter(double time) const { return velocity + time * acceleration; }
  UniformMotion after(double time) const { return {positionAfter(time), velocityAfter(time), acceleration}; }
  UniformMotion relativeTo(const UniformMotion& other) const {
    return {position - other.position, velocity - other.velocity, acceleration - other.acceleration};
  }
};

}  // namespace cradle
