#pragma once

#include <btBulletCollisionCommon.h>

#include <memory>

#include "scene/scene.h"

namespace cradle {

inline btVector3 toBullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
inline btQuaternion toBullet(const Quat& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}
inline btTransform toBullet(const RigidTransform& transform) {
  return btTransform(toBullet(transform.rotation), toBullet(transform.translation));
}
inline Vec3 fromBullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Quat fromBullet(const btQuaternion& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

/// A shape, and where it is in its body's frame.
struct PlacedBulletShape {
  std::unique_ptr<btCollisionShape> shape;
  RigidTransform bodyFromShape;
};

/// A body's shape as `auto` takes it, or the hull of its model where that is no primitive; empty for bodies that touch
/// nothing.
PlacedBulletShape bulletShapeOf(const Body& body, const Scene& scene);

}  // namespace cradle
