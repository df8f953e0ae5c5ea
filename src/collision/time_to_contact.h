#pragma once

#include <limits>

#include "collision/collider.h"

namespace cradle {

constexpr double kNever = std::numeric_limits<double>::infinity();  // s

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

/// A fixed box with a sphere of `radius` around each of its points: a box, or with sizes of zero a capsule or a sphere.
struct RoundedBox {
  RigidTransform boxFromWorld;
  Vec3 halfSize = Vec3::Zero();  // m
  double radius = 0;             // m
};

/// The distance of a point from a surface.
struct Nearness {
  double distance = 0;           // m, < 0 inside
  Vec3 outward = Vec3::UnitY();  // unit, world, from the surface to the point; undefined inside a box's core
};
Nearness nearnessOf(const Vec3& point, const PlaneCollider& plane);
Nearness nearnessOf(const Vec3& point, const RoundedBox& box);

/// The time (s, >= 0) after which a gap (m) that changes by `rate` (m/s), and that by `acceleration` (m/s^2), closes:
/// it comes down to 0, or is closing there or below already. Closed form.
double timeToClose(double gap, double rate, double acceleration);

/// Limits of a search for a contact.
struct ContactSearch {
  double slowest = 0;  // m/s: surfaces that touch and close no faster than this do not close
  double until = 0;    // s, finite: contacts after it need not be found
};

/// Time after which a point whose motion is seen from another comes within `distance` (m) of it, or kNever. Closed
/// form without acceleration, else a root of degree 4, isolated and refined to rounding.
double timeToDistance(const UniformMotion& motion, double distance, const ContactSearch& search);

/// The same for a sphere, by the motion of its centre, and a surface that does not move.
double timeToContact(const UniformMotion& center, double radius, const PlaneCollider& plane,
                     const ContactSearch& search);
double timeToContact(const UniformMotion& center, double radius, const RoundedBox& box, const ContactSearch& search);

}  // namespace cradle
