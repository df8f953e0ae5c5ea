#pragma once

#include <array>

#include "math/types.h"

namespace cradle {

/// A box in the world.
struct PosedBox {
  Vec3 center;    // m
  Mat3 axes;      // columns: unit, world
  Vec3 halfSize;  // m
};

/// Up to four points that carry the contact of two surfaces.
struct ContactPatch {
  static constexpr std::size_t kMostPoints = 4;
  struct Point {
    Vec3 onA = Vec3::Zero(), onB = Vec3::Zero();  // m, world: surface points that belong together
    double separation = 0;                        // m, along the normal, < 0: overlap
  };
  Vec3 normal = Vec3::UnitY();  // unit, world, from A to B
  std::size_t count = 0;
  std::array<Point, kMostPoints> points;
};

/// Where two boxes touch, or will touch within the coming step, in which B moves by `motion` (m, world) as seen from A;
/// nothing if they stay apart by more than `margin` (m) all along one axis.
ContactPatch contactOfBoxes(const PosedBox& a, const PosedBox& b, const Vec3& motion, double margin);

/// Keeps the four of `count` points that hold a patch best: the deepest, the farthest from it, and those that span the
/// largest areas on either side.
void appendSpanning(const ContactPatch::Point* points, std::size_t count, ContactPatch& patch);

}  // namespace cradle
