#pragma once

#include <limits>

#include "collision/collider.h"
#include "collision/uniform_motion.h"

namespace cradle {

constexpr double kNever = std::numeric_limits<double>::infinity();  // s

/// A fixed box with a sphere of `radius` around each of its points: a box, or with sizes of zero a capsule or a sphere.
struct RoundedBox {
  RigidTransform boxFromWorld;
  Vec3 halfSize = Vec3::Zero();  // m
  double radius = 0;             // m
};

/// How far a point is from a surface.
struct Nearness {
  double distance = 0;           // m, < 0 inside
  Vec3 outward = Vec3::UnitY();  // unit, world, from the surface to the point; inside a box's core of no use
};
Nearness nearnessOf(const Vec3& point, const PlaneCollider& plane);
Nearness nearnessOf(const Vec3& point, const RoundedBox& box);

/// The time (s, >= 0) after which a gap (m) that changes by `rate` (m/s), and that by `acceleration` (m/s^2), closes:
/// it comes down to 0, or is closing there or below already. Closed form.
double timeToClose(double gap, double rate, double acceleration);

/// What a search for a contact needs to know of rounding and of the end of time.
struct ContactSearch {
  double slowest = 0;  // m/s: what touches and closes more slowly than this does not close
  double until = 0;    // s, finite: contacts after it need not be found
};

/// Time after which a point whose motion is seen from another comes within `distance` (m) of it, or kNever. Closed
/// form without acceleration, else a root of degree 4, isolated and refined to rounding.
double timeToDistance(const UniformMotion& motion, double distance, const ContactSearch& search);

/// The same for the centre of a sphere and what does not move.
double timeToContact(const UniformMotion& center, double radius, const PlaneCollider& plane,
                     const ContactSearch& search);
double timeToContact(const UniformMotion& center, double radius, const RoundedBox& box, const ContactSearch& search);

}  // namespace cradle
