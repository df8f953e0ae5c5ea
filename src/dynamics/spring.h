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

/// What a spring does to its ends.
struct SpringPull {
  Vec3 forceOnA = Vec3::Zero();  // N, world; B gets the opposite
  double dissipation = 0;        // W
};

/// At length 0 the direction is undefined and the force is zero.
inline SpringPull pullOf(const SpringForce& spring, const AttachmentMotion& a, const AttachmentMotion& b) {
  const Vec3 separation = a.position - b.position;
  const double length = separation.norm();
  if (length == 0) return {};
  const Vec3 direction = separation / length;
  const double lengthening = direction.dot(a.velocity - b.velocity);
  return {-(spring.stiffness * (length - spring.restLength) + spring.damping * lengthening) * direction,
          spring.damping * lengthening * lengthening};
}

/// What a spring does at one instant.
struct SpringAction {
  AttachmentMotion a, b;
  Vec3 forceOnA;       // N, world; B gets the opposite
  double potential;    // J
  double dissipation;  // W
};

SpringAction actionOf(const SpringForce& spring, const VectorX& state);

/// Frequency (rad/s) that the spring would have if nothing else acted: sqrt(k (1/m_A + 1/m_B)), each 1/m the inverse
/// mass seen at the anchor along the spring, 1/m + (r x n)^T I^-1 (r x n). It limits the steps of explicit methods.
double naturalFrequency(const SpringForce& spring, const std::vector<RigidBody>& bodies, const VectorX& state);

}  // namespace cradle
