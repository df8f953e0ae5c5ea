#pragma once

#include <limits>
#include <vector>

#include "constraints/constraint_block.h"

namespace cradle {

constexpr double kSlowestSliding = 1e-6;  // m/s: slower has no direction that could be trusted

/// How two bodies in active contact may move along each other.
enum class ContactMotion {
  frictionless,
  sliding,  // friction = coefficient x normal force, against the sliding
  sticking  // no tangential velocity where they touch: at rest on each other, or rolling
};

/// A sphere of body A that stays on a surface of body B: on a flat face, a sphere, or all that is within a radius of a
/// straight line (the side of a capsule or cylinder, or with radius 0 an edge). A corner is a sphere of radius 0. On a
/// face it may be the rim of a disc as well, by its lowest point. On a line it may be another such line, which crosses
/// it. What touches may roll, slide or spin; it is released only by being taken away.
struct ContactConstraint {
  Attachment centerA;                                        // of A's sphere or disc; a point of its line
  double radiusA = 0;                                        // m, >= 0
  Vec3 rimAxisA = Vec3::Zero();                              // unit, across the disc, in A's frame; zero: no disc
  Vec3 lineA = Vec3::Zero();                                 // of a line through centerA, unit, A's frame; else zero
  Attachment surfaceB;                                       // a point of B's face or line, or its sphere's centre
  double radiusB = std::numeric_limits<double>::infinity();  // m, >= 0; infinite: a flat face
  Vec3 normalB = Vec3::UnitY();                              // of a face, outward, unit; in B's frame, or the world
  Vec3 lineB = Vec3::Zero();                                 // of a line through surfaceB, unit, same frame; else zero
  ContactMotion motion = ContactMotion::frictionless;
  double friction = 0;  // coefficient, >= 0; of sliding alone

  // Of sliding: the way A slides along B, in B's frame, or the world; of any length but not along the normal. It is the
  // direction itself as long as the sliding is too slow to have one, and the side on which friction stays when a trial
  // step goes past the instant where the sliding ends: the right-hand side is smooth there.
  Vec3 slidingDirection = Vec3::Zero();
  double slowSliding = kSlowestSliding;  // m/s: slower sliding has that direction
  // Friction is against slidingDirection, whatever the velocity: against that of `directionTime` (s), which turns at a
  // steady rate (1/s, same frame).
  bool keepsDirection = false;
  double directionTime = 0;
  Vec3 directionRate = Vec3::Zero();
};

/// A contact as collision detection finds it, with the radii of the spheres that its surfaces are there, or those
/// around their lines: 0 a corner or an edge, infinite a flat face.
struct SurfaceContact {
  int bodyA = kFixed, bodyB = kFixed;
  Vec3 point = Vec3::Zero();   // m, world: middle between the two surfaces
  Vec3 normal = Vec3::Zero();  // unit, world, from A to B
  double separation = 0;       // m
  double radiusA = 0, radiusB = 0;
  Vec3 lineA = Vec3::Zero(), lineB = Vec3::Zero();  // unit, world: of a straight line; zero: it is none
  Vec3 rimAxis = Vec3::Zero();  // unit, world: a face is touched by the rim of a disc across this; zero: it is not
};

/// The frictionless constraint that keeps a contact. If A's surface is a face, or a line that B's sphere touches, the
/// bodies change places in it: its A is the contact's B. One of the radii must be finite, lines must not be parallel.
ContactConstraint constraintOf(const SurfaceContact& contact, const VectorX& state);

/// Sets the way A slides from a direction in the world.
void setSlidingDirection(ContactConstraint& contact, const Vec3& direction, const VectorX& state);

/// A vector in the frame of a contact's B, or the world's if that is fixed, from one in the world.
Vec3 inFrameOfB(const ContactConstraint& contact, const Vec3& vector, const VectorX& state);

/// How the surfaces of a contact are placed and move, in the world's frame. They touch at `point`, the place of A's
/// sphere or line, or of its disc's rim, nearest to B.
struct ContactKinematics {
  Vec3 normal;          // unit, out of B: A is pushed along it
  Vec3 normalRate;      // 1/s
  Vec3 point;           // m
  Vec3 armA, armB;      // m, from the centres of mass to `point`
  Vec3 leverA, leverB;  // m, arms x normal
  double gap;           // m, distance of the surfaces, < 0: overlap
  Vec3 velocity;        // m/s, of A's material at `point` relative to B's: its normal part is the gap's rate
  Vec3 drift;           // m/s^2, rate of `velocity` if the velocities of the bodies did not change
  double rounding;      // m, of the gap
};
ContactKinematics kinematicsOf(const ContactConstraint& contact, const VectorX& state,
                               const std::vector<BodyFrame>& frames);

/// Part of a velocity along the surfaces (m/s, world).
Vec3 tangentialVelocity(const ContactKinematics& place);

/// Unit direction in which A slides: that of the tangential velocity v, mirrored to the side of the constraint's
/// slidingDirection; below slowSliding it goes over into the latter, which a contact that keeps its direction has at
/// any speed, as it has turned until `time` (s). Friction on A is against it.
Vec3 slidingDirection(const ContactConstraint& contact, const ContactKinematics& place,
                      const std::vector<BodyFrame>& frames, double time);

/// Lets a contact that keeps its direction follow its velocity from `time` (s) on.
void endKeptDirection(ContactConstraint& contact, double time);

/// The direction that the constraint has by itself at a time: unit, world, but for a part along the normal.
Vec3 givenDirection(const ContactConstraint& contact, const Mat3& worldFromB, double time);

/// Fills in the row of the gap, whose multiplier is the normal force (N), as the last one of the block. Before it, if
/// `withTangents`, stand two of the tangential velocity along orthogonal unit directions, which may be others in the
/// next instant: with multipliers for all of both, motion and force do not depend on them. They have no value: they
/// constrain velocities alone.
void findRows(const ContactConstraint& contact, const ContactKinematics& place, bool withTangents,
              ConstraintBlock& block);

}  // namespace cradle
