#pragma once

#include "study/stability/maps.h"

// Maps of motion that nothing interrupts. Each is a source file of its own, and costs what its entry says.

namespace cradle {

// Of maps of springs:
constexpr double kMaxDamping = 2;     // times critical
constexpr double kMaxStepOmega = 10;  // step x omega
constexpr int kMeasured = 9;          // limits by bisection
constexpr const char* kMeasuredName = "limit as measured by bisection";

/// A mass on a spring: step x stiffness, and step x damping.
StabilityMap stiffnessMap(const MapProgress& progress);
StabilityMap dampingMap(const MapProgress& progress);

/// The same for a box that hangs by a corner from a spring.
StabilityMap hungBoxStiffnessMap(const MapProgress& progress);
StabilityMap hungBoxDampingMap(const MapProgress& progress);

/// A free body that turns over: angular speed x step.
StabilityMap freeRotationMap(const MapProgress& progress);

/// Angles, matrices and quaternions over a million small rotations.
StabilityMap rotationDriftMap(const MapProgress& progress);

/// The length of a pendulum's rod, with and without projection.
StabilityMap rodDriftMap(const MapProgress& progress);

/// The error that an accuracy leads to.
StabilityMap accuracyMap(const MapProgress& progress);

/// The logistic equation in steps that are too long: where RK4 settles instead.
StabilityMap logisticMap(const MapProgress& progress);

/// The same against the step: where each method settles.
StabilityMap logisticStepMap(const MapProgress& progress);

}  // namespace cradle
