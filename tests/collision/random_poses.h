#pragma once

#include <random>

#include "math/rotation.h"
#include "math/types.h"

namespace cradle {

/// Random numbers, vectors and poses, the same in every run and with every compiler if they are drawn one after the
/// other or in braces: arguments of one call are evaluated in any order.
class RandomPoses {
 public:
  explicit RandomPoses(unsigned seed) : engine_(seed) {}
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  Vec3 vector(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }
  Vec3 direction() { return Vec3(vector(1) + Vec3(0, 1e-3, 0)).normalized(); }
  Quat turn() {
    const Vec3 axis = direction();
    return rotationAbout(axis, number(0, 6));
  }
  RigidTransform pose(double reach) { return {turn(), vector(reach)}; }

 private:
  std::mt19937 engine_;
};

}  // namespace cradle
