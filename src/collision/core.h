#pragma once

#include "collision/collider.h"

namespace cradle {

/// The core of a collider, what is left of it without the sphere around each of its points, in a pose.
class Core {
 public:
  /// Keeps a reference. The collider must be convex.
  Core(const Collider& collider, const RigidTransform& frameFromCollider);

  /// The support point (m): the one farthest along `direction`, which need not be a unit vector.
  Vec3 supportPoint(const Vec3& direction) const;
  double supportValue(const Vec3& direction) const { return direction.dot(supportPoint(direction)); }

  /// The same core a way (m) from here.
  Core moved(const Vec3& way) const {
    Core core = *this;
    core.shift_ += way, core.center_ += way;
    return core;
  }

  const Collider& collider() const { return collider_; }
  Vec3 placed(const Vec3& point) const { return turn_ * point + shift_; }
  Vec3 placedBack(const Vec3& point) const { return turn_.transpose() * (point - shift_); }
  Vec3 turned(const Vec3& direction) const { return turn_ * direction; }
  Vec3 turnedBack(const Vec3& direction) const { return turn_.transpose() * direction; }

  // Of a cylinder and a segment:
  const Vec3& axis() const { return axis_; }                // unit
  const Vec3& center() const { return center_; }            // m
  double rimRadius() const { return collider_.rimRadius; }  // m
  bool isRound() const { return rimRadius() > 0; }
  Vec3 end(double side) const { return center_ + side * halfLength_ * axis_; }  // m; side 1 or -1
  Vec3 rimPoint(double side, const Vec3& direction) const;                      // m: farthest of that rim

 private:
  const Collider& collider_;
  Mat3 turn_;
  Vec3 shift_;
  Vec3 axis_ = Vec3::UnitY(), center_ = Vec3::Zero();
  double halfLength_ = 0;
  mutable std::size_t lastVertex_ = 0;  // found last: where the next search starts
};

/// The unit vector across a unit axis nearest to `direction`; any across it if that is along the axis.
Vec3 unitAcross(const Vec3& axis, const Vec3& direction);

}  // namespace cradle
