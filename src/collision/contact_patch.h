#pragma once

#include <array>

#include "collision/collider.h"

// Contacts of two bodies as one patch of up to four points, fast: for piles. Found for the coming step: B moves by
// `motion` (m, world) in it as seen from A. Surfaces that stay apart by more than `margin` (m) give none.

namespace cradle {

struct PosedBall {
  Vec3 center;    // m, world
  double radius;  // m
};

/// All within `radius` of the segment from center - half to center + half. Without length a ball.
struct PosedCapsule {
  Vec3 center, half;  // m, world
  double radius;      // m
};

struct PosedBox {
  Vec3 center;    // m, world
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
  double clearance = 0;  // m, of a patch without points: the surfaces are at least that far apart now
  std::array<Point, kMostPoints> points;
};

ContactPatch contactOfBalls(const PosedBall& a, const PosedBall& b, const Vec3& motion, double margin);
ContactPatch contactOfBallAndBox(const PosedBall& a, const PosedBox& b, const Vec3& motion, double margin);
ContactPatch contactOfBoxes(const PosedBox& a, const PosedBox& b, const Vec3& motion, double margin);
ContactPatch contactOfBallAndPlane(const PosedBall& a, const PlaneCollider& b, const Vec3& motion, double margin);
ContactPatch contactOfCapsules(const PosedCapsule& a, const PosedCapsule& b, const Vec3& motion, double margin);
ContactPatch contactOfCapsuleAndPlane(const PosedCapsule& a, const PlaneCollider& b, const Vec3& motion, double margin);
ContactPatch contactOfBoxAndPlane(const PosedBox& a, const PlaneCollider& b, const Vec3& motion, double margin);

/// The same contact with A and B exchanged.
ContactPatch exchanged(ContactPatch patch);

/// Adds the four of `count` points that hold a patch best. Points that may carry come first: what is a little farther
/// apart than the deepest. Of more than four of them the deepest, the farthest from it, and those that span the
/// largest areas on either side. All of them if there are no more.
void appendSpanning(const ContactPatch::Point* points, std::size_t count, ContactPatch& patch);

}  // namespace cradle
