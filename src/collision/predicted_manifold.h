#pragma once

#include <array>

#include "collision/collider.h"

// Contacts of two bodies as one manifold of up to four points, fast: for piles. Found for the coming step: B moves by
// `motion` (m, world) in it as seen from A. Surfaces that stay apart by more than `margin` (m) have no contact.
// `scale`: of small bodies, by which lengths of millimetres are multiplied.

namespace cradle {

struct PosedSphere {
  Vec3 center;    // m, world
  double radius;  // m
};

/// All within `radius` of the segment from center - half to center + half. Without length a sphere.
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
struct PredictedManifold {
  static constexpr std::size_t kMaxPoints = 4;  // they span what bears a load, in whole blocks of the solver
  struct Point {
    Vec3 onA = Vec3::Zero(), onB = Vec3::Zero();  // m, world: surface points that belong together
    double separation = 0;                        // m, along the normal, < 0: overlap
  };
  Vec3 normal = Vec3::UnitY();  // unit, world, from A to B
  std::size_t count = 0;
  double clearance = 0;  // m, of a manifold without points: the surfaces are at least that far apart now
  std::array<Point, kMaxPoints> points;
};

PredictedManifold contactOfSpheres(const PosedSphere& a, const PosedSphere& b, const Vec3& motion, double margin);
PredictedManifold contactOfSphereAndBox(const PosedSphere& a, const PosedBox& b, const Vec3& motion, double margin);
PredictedManifold contactOfBoxes(const PosedBox& a, const PosedBox& b, const Vec3& motion, double margin,
                                 double scale = 1);
PredictedManifold contactOfSphereAndPlane(const PosedSphere& a, const PlaneCollider& b, const Vec3& motion,
                                          double margin);
PredictedManifold contactOfCapsules(const PosedCapsule& a, const PosedCapsule& b, const Vec3& motion, double margin,
                                    double scale = 1);
PredictedManifold contactOfCapsuleAndPlane(const PosedCapsule& a, const PlaneCollider& b, const Vec3& motion,
                                           double margin);
PredictedManifold contactOfBoxAndPlane(const PosedBox& a, const PlaneCollider& b, const Vec3& motion, double margin,
                                       double scale = 1);

/// The same contact with A and B exchanged.
PredictedManifold exchanged(PredictedManifold manifold);

/// Adds the four of `count` points that hold a manifold best; all of them if there are no more. Points that may carry,
/// those that are hardly farther apart than the deepest, come first. Of more than four such points the deepest is
/// taken, the farthest from it, and those that span the largest areas on either side of both.
void appendSpanning(const PredictedManifold::Point* points, std::size_t count, PredictedManifold& manifold,
                    double scale = 1);

}  // namespace cradle
