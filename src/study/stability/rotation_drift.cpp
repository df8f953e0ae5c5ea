// H. Goldstein, "Classical Mechanics", 4.4 and 4.9: rates of a rotation matrix and of Euler angles. A steady turn has
// its end in closed form; the first order errs per turn by an angle a - atan(a) with matrices (they grow by
// sqrt(1 + a^2) across the axis), and by a - 2 atan(a/2) with quaternions (these by sqrt(1 + a^2/4)).

#include "study/stability/rotation_drift.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "math/elementary.h"
#include "math/rotation.h"

namespace cradle {
namespace {

Quat turnedBy(const Vec3& axis, double angle) {
  const SinCos half = sinCos(angle / 2);
  return Quat(half.cos, half.sin * axis.x(), half.sin * axis.y(), half.sin * axis.z());
}

/// Gram-Schmidt: the first column keeps its direction, the second its plane.
void orthogonalise(Mat3& matrix) {
  matrix.col(0).normalize();
  matrix.col(1) -= matrix.col(0).dot(matrix.col(1)) * matrix.col(0);
  matrix.col(1).normalize();
  matrix.col(2) = matrix.col(0).cross(matrix.col(1));
}

}  // namespace

TurnedOrientation::TurnedOrientation(RotationStorage storage, const Vec3& rotation, bool isExact)
    : storage_(storage), rotation_(rotation), isExact_(isExact) {
  const double angle = rotation.norm();
  quaternionStep_ = turnedBy(rotation / angle, angle);
  if (isExact_) {
    matrixStep_ = quaternionStep_.toRotationMatrix();
  } else {
    matrixStep_ = Mat3::Identity() + skew(rotation);
    quaternionStep_ = Quat(1, rotation.x() / 2, rotation.y() / 2, rotation.z() / 2);
  }
}

void TurnedOrientation::turn() {
  ++turns_;
  switch (storage_) {
    case RotationStorage::eulerAngles:
      return turnAngles();
    case RotationStorage::matrix:
      matrix_ = (matrixStep_ * matrix_).eval();
      return;
    case RotationStorage::orthogonalisedMatrix:
      matrix_ = (matrixStep_ * matrix_).eval();
      return orthogonalise(matrix_);
    case RotationStorage::quaternion:
      quaternion_ = quaternionStep_ * quaternion_;
      return;
    case RotationStorage::normalizedQuaternion:
      quaternion_ = (quaternionStep_ * quaternion_).normalized();
  }
}

/// Rates of yaw, pitch and roll from an angular velocity of the world: singular where the pitch is a right angle.
void TurnedOrientation::turnAngles() {
  const SinCos yaw = sinCos(angles_.x()), pitch = sinCos(angles_.y());
  const double along = yaw.cos * rotation_.x() + yaw.sin * rotation_.y();
  const double across = yaw.cos * rotation_.y() - yaw.sin * rotation_.x();
  angles_ += Vec3(rotation_.z() + along * pitch.sin / pitch.cos, across, along / pitch.cos);
}

/// Of a matrix the nearest rotation.
Quat TurnedOrientation::rotationPart() const {
  if (storage_ == RotationStorage::eulerAngles)
    return turnedBy(Vec3::UnitZ(), angles_.x()) * turnedBy(Vec3::UnitY(), angles_.y()) *
           turnedBy(Vec3::UnitX(), angles_.z());
  if (storage_ == RotationStorage::quaternion || storage_ == RotationStorage::normalizedQuaternion)
    return quaternion_.normalized();
  const Eigen::JacobiSVD<Mat3> parts(matrix_, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Quat(Mat3(parts.matrixU() * parts.matrixV().transpose())).normalized();
}

double TurnedOrientation::angleError() const {
  const double angle = rotation_.norm();
  const Quat wanted = turnedBy(rotation_ / angle, static_cast<double>(turns_) * angle);
  return 2 * std::asin(std::min(1.0, (wanted.conjugate() * rotationPart()).vec().norm()));
}

double TurnedOrientation::shapeError() const {
  if (storage_ == RotationStorage::eulerAngles) return 0;
  if (storage_ == RotationStorage::quaternion || storage_ == RotationStorage::normalizedQuaternion)
    return std::abs(quaternion_.squaredNorm() - 1);
  return (matrix_.transpose() * matrix_ - Mat3::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace cradle
