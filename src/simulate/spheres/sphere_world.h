#pragma once

#include <optional>
#include <vector>

#include "collision/time_to_contact.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// Spheres that bounce without loss, and what is fixed around them. All vectors of spheres are in the order of the
/// island.
struct SphereWorld {
  Vec3 gravity = Vec3::Zero();  // m/s^2
  std::vector<int> sceneBodies;
  std::vector<double> radii, inverseMasses;  // m, 1/kg
  std::vector<UniformMotion> starts;         // of the centres, at time 0
  std::vector<PlaneCollider> planes;
  std::vector<RoundedBox> boxes;
  std::vector<int> obstacleBodies;  // scene bodies: of the planes, then of the boxes

  int sphereCount() const { return static_cast<int>(radii.size()); }
  int planeCount() const { return static_cast<int>(planes.size()); }
};

/// The spheres of an island that nothing but gravity acts upon, if they are no more than that: all that moves in it is
/// a sphere with its centre of mass in the middle, all that it may touch a sphere, a plane or a fixed sphere, box or
/// capsule, and what touches does so without friction and loss. O(bodies + materials^2).
std::optional<SphereWorld> sphereWorldOf(const Scene& scene, const IslandPlan& island);

}  // namespace cradle
