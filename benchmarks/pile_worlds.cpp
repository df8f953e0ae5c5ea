#include "pile_worlds.h"

#include <algorithm>
#include <cmath>

#include "mesh/primitives.h"

namespace cradle {
namespace {

template <class Work>
auto withShapeOf(const PileItem& item, const Work& work) {
  if (item.isBox()) return work(Box{2 * item.halfSize});
  if (item.halfSize.isZero()) return work(Sphere{item.radius});
  return work(Capsule{item.radius, 2 * item.halfSize.y()});
}

MassProperties massPropertiesOf(const PileItem& item) {
  if (item.hull) return item.hull->massProperties;
  return withShapeOf(item, [&](const auto& shape) {
    const double mass = massProperties(shape, 1).mass;
    return massProperties(shape, item.mass / mass);
  });
}

Collider colliderOf(const PileItem& item) {
  if (item.hull) return colliderOf(item.hull->hull, RigidTransform{});
  return withShapeOf(item, [](const auto& shape) { return cradle::colliderOf(shape, RigidTransform{}); });
}

/// Around hulls Bullet lays 40 mm of air if it is not told to lay less.
std::unique_ptr<btCollisionShape> bulletHullOf(const PileHull& hull) {
  constexpr double kMargin = 1e-3;  // m
  auto shape = std::make_unique<btConvexHullShape>();
  for (const Vec3& corner : hull.hull.vertices) shape->addPoint(btVector3(corner.x(), corner.y(), corner.z()));
  shape->setMargin(kMargin);
  return shape;
}

std::unique_ptr<btCollisionShape> bulletShapeOf(const PileItem& item) {
  if (item.hull) return bulletHullOf(*item.hull);
  const Vec3& half = item.halfSize;
  if (item.isBox()) return std::make_unique<btBoxShape>(btVector3(half.x(), half.y(), half.z()));
  if (half.isZero()) return std::make_unique<btSphereShape>(item.radius);
  return std::make_unique<btCapsuleShape>(item.radius, 2 * half.y());
}

}  // namespace

OurPile::OurPile(const PileScene& scene, int threads) {
  for (const PileItem& item : scene.items) {
    bodies_.push_back(makeRigidBody(massPropertiesOf(item)));
    Collider collider = colliderOf(item);
    collider.body = static_cast<int>(geometry_.colliders.size());
    geometry_.colliders.push_back(collider);
  }
  geometry_.planes = scene.planes;
  geometry_.materials = {{{0, kPileFriction, kPileFriction}}};
  state_.setZero(stateSize(std::ssize(bodies_)));
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    centerOfMass(state_, static_cast<Eigen::Index>(i)) = scene.items[i].position;
    setOrientation(state_, static_cast<Eigen::Index>(i), scene.items[i].turn);
    linearVelocity(state_, static_cast<Eigen::Index>(i)) = scene.items[i].velocity;
  }
  step_ = std::make_unique<SoftStep>(bodies_, geometry_, Vec3(0, -9.81, 0), threads);
}

PilePoses OurPile::poses() const {
  PilePoses poses;
  for (Eigen::Index i = 0; i < bodyCount(state_); ++i) {
    poses.positions.emplace_back(centerOfMass(state_, i));
    poses.turns.push_back(orientation(state_, i).toRotationMatrix());
  }
  return poses;
}

BulletPile::BulletPile(const PileScene& scene) {
  world_.setGravity(btVector3(0, -9.81, 0));
  for (const PileItem& item : scene.items) {
    shapes_.push_back(bulletShapeOf(item));
    add(item.mass, shapes_.back().get(), item.position, item.turn);
    bodies_.back()->setLinearVelocity(btVector3(item.velocity.x(), item.velocity.y(), item.velocity.z()));
  }
  const bool hasBoxes =
      std::any_of(scene.items.begin(), scene.items.end(), [](const PileItem& item) { return item.radius == 0; });
  for (const PlaneCollider& plane : scene.planes) addWall(plane, hasBoxes);
}

// Bullet finds one point a step where a box touches a plane, and heaps of boxes are pressed through: they get walls of
// boxes. For balls, planes are cheaper.
void BulletPile::addWall(const PlaneCollider& plane, bool isBox) {
  constexpr double kReach = 20, kHalfThickness = 1;  // m
  const Vec3& n = plane.normal;
  if (isBox) {
    shapes_.push_back(std::make_unique<btBoxShape>(btVector3(kReach, kHalfThickness, kReach)));
    add(0, shapes_.back().get(), plane.point - kHalfThickness * n, Quat::FromTwoVectors(Vec3::UnitY(), n));
  } else {
    shapes_.push_back(std::make_unique<btStaticPlaneShape>(btVector3(n.x(), n.y(), n.z()), n.dot(plane.point)));
    add(0, shapes_.back().get(), Vec3::Zero(), Quat::Identity());
  }
}

BulletPile::~BulletPile() {
  for (const auto& body : bodies_) world_.removeRigidBody(body.get());
}

void BulletPile::add(double mass, btCollisionShape* shape, const Vec3& at, const Quat& turn) {
  btVector3 inertia(0, 0, 0);
  if (mass > 0) shape->calculateLocalInertia(mass, inertia);
  bodies_.push_back(std::make_unique<btRigidBody>(mass, nullptr, shape, inertia));
  const btTransform place(btQuaternion(turn.x(), turn.y(), turn.z(), turn.w()), btVector3(at.x(), at.y(), at.z()));
  bodies_.back()->setWorldTransform(place);
  bodies_.back()->setFriction(std::sqrt(kPileFriction));
  world_.addRigidBody(bodies_.back().get());
}

bool BulletPile::isAtRest() const {
  return std::none_of(bodies_.begin(), bodies_.end(),
                      [](const auto& body) { return !body->isStaticObject() && body->isActive(); });
}

PilePoses BulletPile::poses() const {
  PilePoses poses;
  for (const auto& body : bodies_) {
    if (body->isStaticObject()) continue;
    const btVector3& at = body->getCenterOfMassPosition();
    const btQuaternion q = body->getOrientation();
    poses.positions.emplace_back(at.x(), at.y(), at.z());
    poses.turns.push_back(Quat(q.w(), q.x(), q.y(), q.z()).toRotationMatrix());
  }
  return poses;
}

}  // namespace cradle
