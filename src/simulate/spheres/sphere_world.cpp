#include "simulate/spheres/sphere_world.h"

#include <algorithm>
#include <set>

namespace cradle {
namespace {

const Body& bodyAt(const Scene& scene, int body) {
  return scene.bodies[static_cast<std::size_t>(body)];
}

bool isLossless(const SurfacePair& pair) {
  return pair.restitution == 1 && pair.staticFriction == 0 && pair.dynamicFriction == 0;
}

/// Whether whatever moves touches everything without friction and loss.
bool areLossless(const Scene& scene, const std::vector<int>& touching) {
  std::set<int> moving, all;
  for (const int body : touching) {
    all.insert(bodyAt(scene, body).material);
    if (bodyAt(scene, body).motion == Motion::dynamic) moving.insert(bodyAt(scene, body).material);
  }
  return std::all_of(moving.begin(), moving.end(), [&](int a) {
    return std::all_of(all.begin(), all.end(), [&](int b) {
      return isLossless(scene.surfacePairs[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)]);
    });
  });
}

bool isSphere(const Body& body) {
  return std::holds_alternative<Sphere>(body.shape) && body.massProperties.centerOfMass.isZero(0) &&
         (body.collision == CollisionChoice::automatic || body.collision == CollisionChoice::sphere);
}

void addSphere(const Body& body, int index, const Vec3& gravity, SphereWorld& world) {
  world.sceneBodies.push_back(index);
  world.radii.push_back(std::get<Sphere>(body.shape).radius);
  world.inverseMasses.push_back(1 / body.massProperties.mass);
  world.starts.push_back({body.worldFromBody.translation, body.linearVelocity, gravity});
}

std::optional<RoundedBox> roundedBoxOf(const Body& body) {
  const RigidTransform boxFromWorld = body.worldFromBody.inverse();
  if (body.collision == CollisionChoice::hull || body.collision == CollisionChoice::mesh) return std::nullopt;
  if (const auto* sphere = std::get_if<Sphere>(&body.shape))
    return RoundedBox{boxFromWorld, Vec3::Zero(), sphere->radius};
  if (const auto* box = std::get_if<Box>(&body.shape)) return RoundedBox{boxFromWorld, box->size / 2, 0};
  if (const auto* capsule = std::get_if<Capsule>(&body.shape))
    return RoundedBox{boxFromWorld, Vec3(0, capsule->length / 2, 0), capsule->radius};
  return std::nullopt;
}

/// False if it is neither a plane nor a rounded box.
bool addObstacles(const Scene& scene, const std::vector<int>& touching, SphereWorld& world) {
  std::vector<int> boxBodies;
  for (const int index : touching) {
    const Body& body = bodyAt(scene, index);
    if (body.motion == Motion::dynamic) continue;
    if (const auto* plane = std::get_if<Plane>(&body.shape)) {
      world.planes.push_back({body.worldFromBody.translation, body.worldFromBody.rotation * plane->normal});
      world.obstacleBodies.push_back(index);
    } else if (const auto box = roundedBoxOf(body)) {
      world.boxes.push_back(*box);
      boxBodies.push_back(index);
    } else {
      return false;
    }
  }
  world.obstacleBodies.insert(world.obstacleBodies.end(), boxBodies.begin(), boxBodies.end());
  return true;
}

}  // namespace

std::optional<SphereWorld> sphereWorldOf(const Scene& scene, const IslandPlan& island) {
  const auto isSphereAt = [&](int body) { return isSphere(bodyAt(scene, body)); };
  if (!std::all_of(island.bodies.begin(), island.bodies.end(), isSphereAt)) return std::nullopt;
  if (!areLossless(scene, island.touching)) return std::nullopt;
  SphereWorld world;
  world.gravity = scene.gravity;
  for (const int body : island.bodies) addSphere(bodyAt(scene, body), body, scene.gravity, world);
  if (!addObstacles(scene, island.touching, world)) return std::nullopt;
  return world;
}

}  // namespace cradle
