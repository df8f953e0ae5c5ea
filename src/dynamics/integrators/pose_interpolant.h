#pragma once

#include "dynamics/integrators/step.h"
#include "dynamics/rigid_body.h"

namespace cradle {

/// Pose of a body's centre of mass frame at a fraction of the step, on the step's interpolant; identity if fixed.
RigidTransform poseAt(const Step& step, int body, double fraction);

/// Writes what `interpolate` gives for a body's position and orientation to its place in a state.
void interpolatePose(const Step& step, int body, double fraction, VectorX& state);

/// Whether a body stays where it is throughout the step, by its interpolant.
bool isStill(const Step& step, int body);

/// How far (m) any point within `reach` (m) of a body's centre of mass can move over the step, by its interpolant.
double motionBound(const Step& step, int body, double reach);

/// Bounds on the motion of any point within a reach of a body's centre of mass, with the step as the unit of time.
struct MotionBounds {
  double speed = 0;         // m
  double acceleration = 0;  // m
};
MotionBounds motionBounds(const Step& step, int body, double reach);

/// The same for the difference of two bodies' centres of mass: bodies that move alike hardly move relative to each
/// other.
MotionBounds relativeMotionBounds(const Step& step, int bodyA, int bodyB);

/// How far (m) B's centre of mass can go from A's over the step, across a unit direction.
double motionBoundAcross(const Step& step, int bodyA, int bodyB, const Vec3& direction);

/// Bound on how fast (m) B's centre of mass accelerates from A's along a unit direction, with the step as the unit of
/// time.
double accelerationBoundAlong(const Step& step, int bodyA, int bodyB, const Vec3& direction);

/// Bounds on what a body's turning does to a point at 1 m from its centre of mass, with the step as the unit of time.
MotionBounds turnBounds(const Step& step, int body);

}  // namespace cradle
