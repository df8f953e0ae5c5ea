#pragma once

#include "impact/contact_blocks.h"
#include "impact/soft_parameters.h"

// The normal impulses of one manifold, all at once. One after the other (Gauss-Seidel), the first point would take most
// of the load and tilt the bodies towards the last: straight towers lean. The impulses of this solution do not depend
// on the order of points, so that mirror images stay mirror images.

namespace cradle {

/// Impulse of each point as a function of its speed s (m/s, apart): max(0, offset - stiffness s).
template <int points>
struct NormalLaws {
  Lanes stiffness[points];  // kg
  Lanes offset[points];     // N s
};

/// The sum of the inertia and of the springs that press, and impulses: (inertia + sum stiffness g g^T) y = sum g r for
/// the change y of the plane's speeds by impulses r at the points, g = (1, u, v).
struct PlaneSystem {
  PlaneInertia sum;
  Lanes right[3] = {};

  void add(Lanes impulse, Lanes stiffness, Lanes u, Lanes v) {
    right[0] += impulse, right[1] += impulse * u, right[2] += impulse * v;
    const Lanes alongU = stiffness * u, alongV = stiffness * v;
    sum.xx += stiffness, sum.xy += alongU, sum.xz += alongV;
    sum.yy += alongU * u, sum.yz += alongU * v, sum.zz += alongV * v;
  }

  /// By cofactors.
  PlaneSpeeds solved() const {
    const Lanes xx = sum.yy * sum.zz - sum.yz * sum.yz, xy = sum.xz * sum.yz - sum.xy * sum.zz,
                xz = sum.xy * sum.yz - sum.xz * sum.yy, yy = sum.xx * sum.zz - sum.xz * sum.xz,
                yz = sum.xy * sum.xz - sum.xx * sum.yz, zz = sum.xx * sum.yy - sum.xy * sum.xy;
    const Lanes scale = same(1) / (sum.xx * xx + sum.xy * xy + sum.xz * xz);
    return {scale * (xx * right[0] + xy * right[1] + xz * right[2]),
            scale * (xy * right[0] + yy * right[1] + yz * right[2]),
            scale * (xz * right[0] + yz * right[1] + zz * right[2])};
  }
};

/// Newton's method for the impulses that obey all laws: the points that press are guessed, and guessed again from the
/// speeds that follow. Points that the last guess leaves out do not press. Returns the speeds.
template <class Block>
PlaneSpeeds solveNormals(const Block& block, const PlaneSpeeds& before, const NormalLaws<Block::kPoints>& laws,
                         Lanes (&impulses)[Block::kPoints]) {
  constexpr int kPoints = Block::kPoints;
  const Lanes none = same(0);
  Lanes free[kPoints];  // impulses at the speeds of now
  LaneMask isPressed[kPoints], touches{};
  for (int i = 0; i < kPoints; ++i) {
    const auto& point = block.points[i];
    free[i] = laws.offset[i] - laws.stiffness[i] * before.at(point.u, point.v);
    isPressed[i] = (point.impulse > none) | (free[i] > none);
    touches |= isPressed[i];
    impulses[i] = none;
  }
  if (!(touches[0] | touches[1])) return before;
  PlaneSpeeds change;
  for (int step = 0; step < SoftParameters::kNewtonSteps; ++step) {
    PlaneSystem system{block.plane.inertia};
    for (int i = 0; i < kPoints; ++i) {
      const auto& point = block.points[i];
      system.add((isPressed[i] ? free[i] : none) - point.impulse, isPressed[i] ? laws.stiffness[i] : none, point.u,
                 point.v);
    }
    change = system.solved();
    LaneMask changes{};
    for (int i = 0; i < kPoints; ++i) {
      const Lanes impulse = free[i] - laws.stiffness[i] * change.at(block.points[i].u, block.points[i].v);
      const LaneMask presses = impulse > none;
      impulses[i] = presses & isPressed[i] ? impulse : none;
      changes |= presses ^ isPressed[i];
      isPressed[i] = presses;
    }
    if (!(changes[0] | changes[1])) break;
  }
  return {before.middle + change.middle, before.slopeU + change.slopeU, before.slopeV + change.slopeV};
}

}  // namespace cradle
