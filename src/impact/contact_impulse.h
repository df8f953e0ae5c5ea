#pragma once

#include <vector>

#include "collision/separation.h"

namespace cradle {

/// Velocity (m/s, world) of B's surface relative to A's at a contact: contactNormal . velocity < 0 is closing.
Vec3 relativeVelocity(const Contact& contact, const VectorX& state);

/// The same for velocities of another instant, at the contact where it is in `places`: both are states.
Vec3 relativeVelocity(const Contact& contact, const VectorX& places, const VectorX& velocities);

/// The 3x3 matrix that maps an impulse on B (and its opposite on A) at the contact to the change of B's velocity
/// relative to A there, in 1/kg.
Mat3 inverseMassAt(const Contact& contact, const std::vector<RigidBody>& bodies, const VectorX& state);

/// Applies an impulse (N s, world) to B and its opposite to A at the contact.
void applyContactImpulse(const Contact& contact, const Vec3& impulseOnB, const std::vector<RigidBody>& bodies,
                         VectorX& state);

}  // namespace cradle
