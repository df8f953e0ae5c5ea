#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace cradle {

using Vec3 = Eigen::Vector3d;
using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;  // constructor (w, x, y, z); stored x, y, z, w
using VectorX = Eigen::VectorXd;
using MatrixX = Eigen::MatrixXd;

/// A proper rigid motion, named target-from-source: worldFromBody maps a point of the body's frame to the world.
struct RigidTransform {
  Quat rotation = Quat::Identity();  // unit
  Vec3 translation = Vec3::Zero();   // m

  Vec3 operator*(const Vec3& point) const { return rotation * point + translation; }
  RigidTransform operator*(const RigidTransform& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  RigidTransform inverse() const {
    const Quat back = rotation.conjugate();
    return {back, -(back * translation)};
  }
};

/// Axis-aligned box; empty until the first point is added.
using Bounds = Eigen::AlignedBox3d;

}  // namespace cradle
