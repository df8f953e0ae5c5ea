#pragma once

#include <string>
#include <vector>

#include "dynamics/rigid_body.h"

namespace cradle {

/// A linear spring with a linear damper beside it, in tension and compression:
/// force on A = -[stiffness (L - restLength) + damping dL/dt] u, u the unit vector from anchor B to anchor A.
struct SpringForce {
  Attachment anchorA, anchorB;
  double stiffness = 0;   // N/m
  double damping = 0;     // N s/m
  double restLength = 0;  // m
};

/// What a spring does at one instant.
struct SpringAction {
  AttachmentMotion a, b;
  Vec3 forceOnA;       // N, world; B gets the opposite
  double potential;    // J
  double dissipation;  // W
};

/// At length 0 the direction is undefined and the force is zero.
SpringAction actionOf(const SpringForce& spring, const VectorX& state);

/// The same from how its ends move.
SpringAction actionOf(const SpringForce& spring, const AttachmentMotion& a, const AttachmentMotion& b);

/// Frequency (rad/s) that the spring would have if nothing else acted: sqrt(k (1/m_A + 1/m_B)), each 1/m the inverse
/// mass seen at the anchor along the spring, 1/m + (r x n)^T I^-1 (r x n). It limits the steps of explicit methods.
double naturalFrequency(const SpringForce& spring, const std::vector<RigidBody>& bodies, const VectorX& state);

}  // namespace cradle
