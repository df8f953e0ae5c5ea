#pragma once

#include <memory>
#include <string>

#include "scene/scene.h"
#include "simulate/assembly.h"

namespace cradle {

/// How Bullet is set up. All else is its default.
struct BulletSettings {
  int iterations = 10;   // of the sequential impulses in a step
  bool isTuned = false;  // contacts only where bodies touch, all overlap by split impulses, bounces from 0.01 m/s
};

/// Whether this program was built with Bullet (the option CRADLE_PEERS).
bool hasBullet();

/// What the scene has that is not translated for Bullet ("ropes"); empty if it can be simulated.
std::string missingInBullet(const Scene& scene);

/// A scene as Bullet sees it: a btDiscreteDynamicsWorld in double precision that never puts bodies to sleep.
///   restitution and friction  as the scene's pairs of materials have them; Bullet knows one friction: the dynamic one
///   rods                      a row for its solver that keeps a distance, for want of a joint of its own
///   springs                   forces that are set before each step, from where the bodies are then
class BulletWorld {
 public:
  /// The scene must have nothing that is missing in Bullet; `assembly` is the whole scene's, and is kept as a
  /// reference.
  BulletWorld(const Scene& scene, const Assembly& assembly, const BulletSettings& settings);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  void step(double timeStep);

  /// Poses and velocities now, in the layout of the assembly's state.
  void read(VectorX& state) const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace cradle
