#include "study/peers/bullet_shapes.h"

#include <BulletCollision/CollisionShapes/btEmptyShape.h>

#include "study/peers/peer_shapes.h"

namespace cradle {
namespace {

struct ShapeMaker {
  std::unique_ptr<btCollisionShape> operator()(const Sphere& sphere) const {
    return std::make_unique<btSphereShape>(sphere.radius);
  }
  std::unique_ptr<btCollisionShape> operator()(const Box& box) const {
    return std::make_unique<btBoxShape>(toBullet(box.size / 2));
  }
  std::unique_ptr<btCollisionShape> operator()(const Cylinder& cylinder) const {
    return std::make_unique<btCylinderShape>(btVector3(cylinder.radius, cylinder.length / 2, cylinder.radius));
  }
  std::unique_ptr<btCollisionShape> operator()(const Capsule& capsule) const {
    return std::make_unique<btCapsuleShape>(capsule.radius, capsule.length);
  }
  std::unique_ptr<btCollisionShape> operator()(const Plane& plane) const {
    return std::make_unique<btStaticPlaneShape>(toBullet(plane.normal), 0);
  }
};

}  // namespace

PlacedBulletShape bulletShapeOf(const Body& body, const Scene& scene) {
  if (body.collision == CollisionChoice::none) return {std::make_unique<btEmptyShape>(), {}};
  if (const auto found = recogniseModel(body, scene); found.primitive)
    return {std::visit(ShapeMaker{}, found.primitive->shape), found.primitive->bodyFromShape};
  return std::visit(
      [&](const auto& shape) -> PlacedBulletShape {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, ModelShape>) {
          auto hull = std::make_unique<btConvexHullShape>();
          for (const Vec3& vertex : scene.models[static_cast<std::size_t>(shape.model)].solid.vertices)
            hull->addPoint(toBullet(vertex), false);
          hull->recalcLocalAabb();
          return {std::move(hull), {}};
        } else {
          return {ShapeMaker{}(shape), {}};
        }
      },
      body.shape);
}

}  // namespace cradle
