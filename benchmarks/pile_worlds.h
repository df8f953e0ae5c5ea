#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>

#include "impact/soft_step.h"
#include "pile_scene.h"

namespace cradle {

constexpr double kSoftTimeStep = 1.0 / 60;  // s
constexpr double kPileFriction = 0.5;

/// A heap by the fast contact step.
class OurPile {
 public:
  OurPile(const PileScene& scene, int threads);

  void advance() { step_->advance(kSoftTimeStep, state_); }
  bool isAtRest() const { return step_->allAsleep(); }
  PilePoses poses() const;

 private:
  std::vector<RigidBody> bodies_;
  ContactGeometry geometry_;
  VectorX state_;
  std::unique_ptr<SoftStep> step_;
};

/// The same with Bullet's defaults; friction of a pair is the product there.
class BulletPile {
 public:
  explicit BulletPile(const PileScene& scene);
  ~BulletPile();
  BulletPile(const BulletPile&) = delete;
  BulletPile& operator=(const BulletPile&) = delete;

  void advance() { world_.stepSimulation(kSoftTimeStep, 0); }
  bool isAtRest() const;
  PilePoses poses() const;

 private:
  void add(double mass, btCollisionShape* shape, const Vec3& at, const Quat& turn);
  void addWall(const PlaneCollider& plane, bool isBox);

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadPhase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadPhase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace cradle
