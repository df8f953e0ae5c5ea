#include "experiments/squeezed_balls.h"

#include <cmath>
#include <limits>

namespace cradle {
namespace {

using Real = long double;

constexpr Real kAtOnce = 1e-200L;  // s: of impacts that come as fast
constexpr Real kSlow = 1e-9L;      // m/s: a rebound that may die away by itself
constexpr int kMaxImpacts = 1000000;

/// Time until a gap that changes at `rate` and shrinks by `gravity` t^2 / 2 closes; infinite if it never does.
Real closingTime(Real gap, Real rate, Real gravity) {
  if (gravity == 0) return rate < 0 ? -gap / rate : std::numeric_limits<Real>::infinity();
  const Real root = std::sqrt(rate * rate + 2 * gravity * gap);
  return rate <= 0 ? 2 * gap / (root - rate) : (rate + root) / gravity;
}

}  // namespace

std::optional<std::array<double, 2>> waysOf(SqueezedBalls balls, double time) {
  const Real e = balls.restitution, gravity = balls.gravity, lower = balls.masses[0], upper = balls.masses[1];
  Real below = balls.gaps[0], between = balls.gaps[1], v = balls.velocities[0], w = balls.velocities[1], left = time;
  for (int impact = 0; impact < kMaxImpacts; ++impact) {
    const Real onFloor = closingTime(below, v, gravity), onBall = closingTime(between, w - v, 0);
    const Real next = std::min(onFloor, onBall);
    const bool isOnFloor = onFloor <= onBall, isLast = next >= left;
    const Real step = isLast ? left : next;
    below += v * step - gravity * step * step / 2, between += (w - v) * step;
    v -= gravity * step, w -= gravity * step, left -= step;
    if (isLast) break;
    if (impact > 10 && next < kAtOnce) {
      below = between = 0;
      break;
    }
    if (isOnFloor) {
      below = 0, v *= -e;
      const Real bouncing = 2 * v / (gravity * (1 - e));  // s, until it rests
      if (v < kSlow && between > -2 * (w - kSlow) * bouncing) return {};
    } else {
      const Real change = (1 + e) * (v - w) / (1 / lower + 1 / upper);
      between = 0, v -= change / lower, w += change / upper;
    }
    if (impact == kMaxImpacts - 1) return {};
  }
  const Real way = below - balls.gaps[0];
  return std::array<double, 2>{static_cast<double>(way), static_cast<double>(way + between - balls.gaps[1])};
}

}  // namespace cradle
