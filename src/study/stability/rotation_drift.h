#pragma once

#include "math/types.h"

namespace cradle {

/// What rotation vectors add up to, kept in ways that textbooks compare. Cradle itself keeps quaternions.
enum class RotationStorage { eulerAngles, matrix, orthogonalisedMatrix, quaternion, normalizedQuaternion };

/// An orientation that is turned again and again by the same small rotation, about an axis of the world.
class TurnedOrientation {
 public:
  /// `rotation` (rad) is of one turn. `isExact`: each turn is a product with the exact rotation; else x += h x', the
  /// first order. Euler angles have no product: only the first order.
  TurnedOrientation(RotationStorage storage, const Vec3& rotation, bool isExact);

  void turn();

  /// Angle (rad) between where it is and where it should be.
  double angleError() const;
  /// How far it is from a rotation: the largest entry of |R^T R - 1|, or ||q|^2 - 1|; 0 for angles.
  double shapeError() const;

 private:
  void turnAngles();
  Quat rotationPart() const;

  RotationStorage storage_;
  Vec3 rotation_;
  bool isExact_;
  long turns_ = 0;
  Vec3 angles_ = Vec3::Zero();  // rad: yaw about z, pitch about y, roll about x
  Mat3 matrix_ = Mat3::Identity(), matrixStep_;
  Quat quaternion_ = Quat::Identity(), quaternionStep_;
};

}  // namespace cradle
