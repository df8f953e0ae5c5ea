#pragma once

#include <limits>
#include <vector>

#include "collision/collider.h"
#include "collision/contact_point.h"
#include "collision/mesh_feature.h"

namespace cradle {

/// A point where two colliders are near.
struct Contact {
  std::size_t pair = 0;  // index into ContactGeometry::pairs
  int bodyA = kFixed, bodyB = kFixed;
  Vec3 point = Vec3::Zero();   // m, world: middle between the two surfaces
  Vec3 normal = Vec3::Zero();  // unit, world, from A to B
  double separation = 0;       // m, < 0: overlap
  // m: radius of the sphere that each surface is there: 0 a corner, infinite a flat face; NaN: neither (edge, side,
  // rim). Of a line the radius around it: 0 an edge.
  double radiusA = kNotRound, radiusB = kNotRound;
  // Unit, world: direction of the straight line that a surface is there; zero: it is none, or not told.
  Vec3 lineA = Vec3::Zero(), lineB = Vec3::Zero();
  std::uint32_t feature = 0;  // of the mesh that a sphere touches, as in ContactPoint
  // Unit, world: the one that is no face is a tilted disc of its radius there, across this; zero: it is none.
  Vec3 rimAxis = Vec3::Zero();

  /// A if it moves, else B.
  int movingBody() const { return bodyA != kFixed ? bodyA : bodyB; }
};

/// Whether contacts are of one pair and have one normal: points of a face that lies on another one.
bool areOfOneFace(const std::vector<const Contact*>& contacts);

/// Whether a joint holds feature number `feature` of a pair (a corner, or the sphere around an end, over a plane), so
/// that its gap stays as it is.
bool isPinnedFeature(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature);

/// Whether a joint holds places of a pair where its surfaces may touch: then its separation may be theirs for ever, and
/// contacts beside them are those that appendContacts finds.
bool hasPinnedPlaces(const ContactGeometry& geometry, const ColliderPair& pair);

/// Velocity (m/s, world) of B's surface relative to A's at a contact: contactNormal . velocity < 0 is closing.
Vec3 relativeVelocity(const Contact& contact, const VectorX& state);

/// The same for velocities of another instant, at the contact where it is in `places`: both are states.
Vec3 relativeVelocity(const Contact& contact, const VectorX& places, const VectorX& velocities);

/// Speed (m/s) with which the surfaces leave each other at a contact; < 0 is closing.
double openingSpeed(const Contact& contact, const VectorX& state);

/// Size (m) of the smaller of the moving bodies at a contact; `sizes` are those of all moving bodies.
double smallestSize(const Contact& contact, const std::vector<double>& sizes);

/// Acceleration (m/s^2) with which the two material points of a contact leave each other along its normal, for the
/// rates of all velocities in `rate`.
double openingAcceleration(const Contact& contact, const VectorX& state, const VectorX& rate);

/// Pose of a moving body's centre of mass frame in `state`; identity if fixed.
RigidTransform poseOf(const VectorX& state, int body);

/// The moving body of a pair's second collider, or kFixed.
int bodyBOf(const ContactGeometry& geometry, const ColliderPair& pair);

/// Appends the features of a pair, whose gaps close one by one (the points of A against a plane, else one for the
/// pair), that may be nearer than `reach` (m): all that are, and few others.
void appendFeaturesWithin(const ContactGeometry& geometry, const ColliderPair& pair, const RigidTransform& worldFromA,
                          double reach, std::vector<std::size_t>& features);

/// Signed separation (m) of a feature, for given poses of the bodies. Zero where they touch, and continuous there. What
/// is farther than `enough` (m) may be infinite: that saves most of a search among triangles.
double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature,
                  const RigidTransform& worldFromA, const RigidTransform& worldFromB,
                  double enough = std::numeric_limits<double>::infinity());
double separation(const ContactGeometry& geometry, const ColliderPair& pair, std::size_t feature, const VectorX& state);

/// The feature of a mesh that a sphere touches.
TouchedFeature touchedFeature(const Contact& contact);

/// The centre of a sphere and the surface of a mesh that it may touch, as the mesh's frame sees them.
struct SphereOverMesh {
  const MeshSurface* mesh = nullptr;  // null: a pair of other colliders
  Vec3 center = Vec3::Zero();         // m
  double radius = 0;                  // m
};
SphereOverMesh sphereOverMesh(const ContactGeometry& geometry, const ColliderPair& pair,
                              const RigidTransform& worldFromA, const RigidTransform& worldFromB);
SphereOverMesh sphereOverMesh(const ContactGeometry& geometry, const ColliderPair& pair, const VectorX& state);

/// The point of a collider's surface that is nearest to a point, both in its frame (m).
Vec3 nearestOnSurface(const Collider& collider, const Vec3& point);

/// Lower bound (m) of the separations of all features, from bounding spheres; -infinity for fixed bodies.
double separationBound(const ContactGeometry& geometry, const ColliderPair& pair, const RigidTransform& worldFromA,
                       const RigidTransform& worldFromB);

/// Appends the contacts of one pair with separation <= margin (m), but those that a joint holds as they are. Two
/// spheres with one centre get the normal +y.
void appendContacts(const ContactGeometry& geometry, std::size_t pair, const VectorX& state, double margin,
                    std::vector<Contact>& contacts);

/// All contacts with separation <= margin, in order of pairs. O(pairs + features of near pairs).
void findContacts(const ContactGeometry& geometry, const VectorX& state, double margin, std::vector<Contact>& contacts);

}  // namespace cradle
