#pragma once

#include <vector>

#include "collision/collider.h"

namespace cradle {

/// Where two colliders are nearest: one ball of A against one ball of B, or against a plane.
struct Contact {
  std::size_t pair = 0;     // index into ContactGeometry::pairs
  std::size_t feature = 0;  // which point of A
  int bodyA = kFixed, bodyB = kFixed;
  Vec3 point = Vec3::Zero();   // m, world: middle between the two surfaces
  Vec3 normal = Vec3::Zero();  // unit, world, from A to B
  double separation = 0;       // m, < 0: overlap
};

/// Pose of a moving body's centre of mass frame in `state`; identity if fixed.
RigidTransform poseOf(const VectorX& state, int body);

/// Number of features of a pair: the points of A (B has a single one, or is a plane).
std::size_t featureCount(const ContactGeometry& geometry, const ColliderPair& pair);

/// Signed distance (m) between point `feature` of A and B, for given poses of their bodies.
double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature,
                  const RigidTransform& worldFromA, const RigidTransform& worldFromB);

/// The same with point and normal. Two balls with one centre get the normal +y.
Contact contactOf(const ContactGeometry& geometry, std::size_t pair, std::size_t feature, const VectorX& state);

/// All contacts with separation <= margin (m), in order of pairs and features. O(pairs + features of near pairs).
void findContacts(const ContactGeometry& geometry, const VectorX& state, double margin, std::vector<Contact>& contacts);

}  // namespace cradle
