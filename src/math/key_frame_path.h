#pragma once

#include <vector>

#include "math/types.h"

namespace cradle {

/// A pose that a body passes at a time.
struct KeyFrame {
  double time = 0;      // s
  RigidTransform pose;  // worldFromBody
};

/// A pose and its rates at one instant, in the world's frame.
struct PoseMotion {
  RigidTransform pose;                                                      // worldFromBody
  Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();                // m/s, m/s^2, of the frame's origin
  Vec3 angularVelocity = Vec3::Zero(), angularAcceleration = Vec3::Zero();  // rad/s, rad/s^2
};

/// A smooth way through key frames: positions and quaternions go from each to the next by polynomials of degree 5, with
/// the same first and second derivatives on both sides of a key frame, and quaternions are made of unit length. Between
/// two equal key frames nothing moves. At rest, without acceleration, at the first key frame and before it, and at the
/// last and after it; or, if it repeats, with the period from the first to the last, which must have the same pose.
class KeyFramePath {
 public:
  /// Two key frames or more, times ascending. From each to the next it turns by less than half a turn.
  KeyFramePath(const std::vector<KeyFrame>& keys, bool repeats);

  PoseMotion at(double time) const;

  /// The first key frame after `time` (s), where the third derivative jumps; infinite if there is none.
  double nextKey(double time) const;

  /// s: from the key frame before `time` to the next one; infinite before the first and after the last.
  double lengthAt(double time) const;

  /// Whether the pose stays as it is from `time` to the next key frame.
  bool isStill(double time) const;

  /// Points (m, world) whose convex hull has all positions in it: the control points of its Bezier curves.
  std::vector<Vec3> hull() const;

  /// The same way, beside this one (m, world).
  void shift(const Vec3& by);

 private:
  using Values = Eigen::Matrix<double, 7, 1>;  // x, y, z (m); quaternion w, x, y, z
  struct Knot {
    double time;
    Values value, first, second;  // derivatives by s
  };
  struct Place {
    std::size_t piece;
    double time;        // s, within the knots'
    bool isTurnedOver;  // the quaternion is the negative one, as in every other round
  };
  /// Some of the values, whose derivatives at the seam of a way that repeats are `seam` (1 or -1) times each other.
  struct Part {
    Eigen::Index first, count;
    double seam;
  };
  void findDerivatives(const Part& part);
  double lengthOf(std::size_t piece) const { return knots_[piece + 1].time - knots_[piece].time; }
  double period() const { return knots_.back().time - knots_.front().time; }
  Place placeOf(double time) const;

  std::vector<Knot> knots_;
  bool repeats_;
  bool turnsOver_ = false;  // the last quaternion is the negative of the first
};

}  // namespace cradle
