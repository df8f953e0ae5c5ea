#pragma once

#include <vector>

#include "dynamics/rigid_body.h"
#include "math/prescribed_motion.h"

namespace cradle {

/// A body of a mechanism that moves as is prescribed, whatever acts on it: nothing is heavy beside it.
struct DrivenBody {
  int body = 0;             // index among the mechanism's
  PrescribedMotion motion;  // of the centre of mass
};

/// A driven body as the equations of motion see it: without mass, so that it has no energy and no momentum, and without
/// inverse mass, so that no force moves it.
RigidBody drivenRigidBody();

/// One more at the end of `driven`.
void add(int body, const PrescribedMotion& motion, std::vector<DrivenBody>& driven);

/// Places driven bodies as they are at `time` (s), with their velocities.
void place(const std::vector<DrivenBody>& driven, double time, VectorX& state);

/// Sets the rates of their velocities at `time` (s).
void accelerate(const std::vector<DrivenBody>& driven, double time, VectorX& derivative);

/// Power (W) that the drive of a body puts into others by a force (N, world) of the body at a point (m, world);
/// likewise the work (J) of an impulse (N s). Zero unless the body is driven.
double powerOfDriven(const std::vector<RigidBody>& bodies, int body, const Vec3& point, const Vec3& force,
                     const VectorX& state);

/// Whether a body is driven and keeps its place from `time` (s) to the next jump of its motion.
bool isDrivenStill(const std::vector<DrivenBody>& driven, int body, double time);

/// The first instant (s) after `time` at which one of the motions has a jump; infinite if there is none.
double nextJump(const std::vector<DrivenBody>& driven, double time);

}  // namespace cradle
