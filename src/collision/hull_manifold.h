#pragma once

#include "collision/core.h"
#include "collision/predicted_manifold.h"

namespace cradle {

/// A direction (unit, A's body frame) along which two hulls were apart, or overlapped least, when they were last looked
/// at: where it still separates them, nothing else is looked for. Zero: none yet.
using HullAxis = Vec3;

/// The contact of two polytopes in world coordinates, as of boxes (collision/predicted_manifold.h): for the coming
/// step, in which B moves by `motion` (m) as seen from A. Renews `axis`.
PredictedManifold contactOfHulls(const Core& a, const Core& b, const Vec3& motion, double margin, double scale,
                                 HullAxis& axis);

/// The same of a polytope on a plane.
PredictedManifold contactOfHullAndPlane(const Core& a, const PlaneCollider& b, const Vec3& motion, double margin,
                                        double scale);

}  // namespace cradle
