// A catenary through two points at horizontal distance h, the second higher by v, of length L: with half its span in
// units of its parameter, xi, and the shift of its lowest point, eta,
//   sinh(xi) / xi = sqrt(L^2 - v^2) / h,  tanh(eta) = v / L
// (E. H. Lockwood, "A book of curves", 1961, ch. 13). Drawn is how far it hangs below its chord, in terms of how far it
// does in the middle.

#include "render/tube_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cradle {
namespace {

constexpr double kNarrowestSpan = 1.0 / 60;  // of its length: a rope that hangs doubled keeps its ends so far apart
constexpr double kTaut = 1 - 1e-4;           // share of its length from which a rope is drawn straight
constexpr int kHalvings = 50;

/// How far a rope hangs below its chord, in terms of the middle, at u = -1..1 along the chord.
double hanging(const TubeItem& rope, double u) {
  const double xi = rope.slack, half = std::sinh(xi / 2);
  return (std::sinh(xi * (1 + u) / 2) * std::sinh(xi * (1 - u) / 2) +
          rope.lean * (u * std::sinh(xi) - std::sinh(xi * u)) / 2) /
         (half * half);
}

/// Its derivative by u.
double hangingSlope(const TubeItem& rope, double u) {
  const double xi = rope.slack, half = std::sinh(xi / 2);
  return (-xi * std::sinh(xi * u) + rope.lean * (std::sinh(xi) - xi * std::cosh(xi * u))) / (2 * half * half);
}

double spanOf(double stretched) {  // solves sinh(xi) / xi = stretched > 1
  double low = 0, high = 1;
  while (std::sinh(high) < stretched * high) high *= 2;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (std::sinh(middle) < stretched * middle ? low : high) = middle;
  }
  return high;
}

double smoothstep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

/// Share of a coil's turns at a share `s` of the way.
double turnedShare(const TubeItem& tube, double s) {
  return std::clamp((s - tube.straightEnd) / (1 - 2 * tube.straightEnd), 0.0, 1.0);
}

}  // namespace

Vec3 tubeOutwards(const TubeItem& tube, double s) {
  const Vec3 across = (tube.end - tube.start).normalized().cross(tube.side);
  const double angle = 2 * std::numbers::pi * tube.turns * turnedShare(tube, s);
  return std::cos(angle) * tube.side + std::sin(angle) * across;
}

Vec3 tubePoint(const TubeItem& tube, double s) {
  const Vec3 line = tube.end - tube.start;
  const Vec3 straight = tube.start + s * line;
  if (tube.turns == 0) return tube.slack > 0 ? Vec3(straight + hanging(tube, 2 * s - 1) * tube.sag) : straight;
  const double turned = turnedShare(tube, s);
  const double open = smoothstep(std::min(turned, 1 - turned) / tube.straightEnd);
  return straight + tube.coilRadius * open * tubeOutwards(tube, s);
}

std::vector<Vec3> ropeCorners(const TubeItem& rope) {
  std::vector<Vec3> corners = {rope.start, rope.end};
  if (rope.slack == 0) return corners;
  // It lies on one side of its tangents: at both ends, and where it is farthest from the chord.
  double low = -1, high = 1;
  for (int i = 0; i < kHalvings; ++i) (hangingSlope(rope, (low + high) / 2) > 0 ? low : high) = (low + high) / 2;
  const double farthest = hanging(rope, low);
  const double first = -1 + farthest / hangingSlope(rope, -1), last = 1 + farthest / hangingSlope(rope, 1);
  for (const double u : {first, last})
    corners.push_back(rope.start + (1 + u) / 2 * (rope.end - rope.start) + farthest * rope.sag);
  return corners;
}

void hangRope(double length, const Vec3& down, TubeItem& rope) {
  const Vec3 line = rope.end - rope.start;
  if (line.norm() >= kTaut * length) return;
  const double rise = -down.dot(line);
  const double span = std::max((line + rise * down).norm(), kNarrowestSpan * length);
  rope.slack = spanOf(std::max(std::sqrt(length * length - rise * rise) / span, 1 + 1e-9));
  rope.lean = rise / length;
  const double eta = std::atanh(rope.lean), half = std::sinh(rope.slack / 2);
  rope.sag = span / rope.slack * std::cosh(eta) * half * half * down;
}

double windCoil(double wireLength, double narrowest, TubeItem& coil) {
  // Away from the ends, a helix; what the ends take off is in proportion.
  const Vec3 line = coil.end - coil.start;
  const double inside = 1 - 2 * coil.straightEnd, around = 2 * std::numbers::pi * coil.turns;
  const auto lengthFor = [&](double radius) {
    double length = 2 * coil.straightEnd * line.norm();
    constexpr int kSteps = 48;
    for (int i = 0; i < kSteps; ++i) {
      const double turned = (i + 0.5) / kSteps;
      const double place = std::min(turned, 1 - turned) / coil.straightEnd, open = smoothstep(place);
      const double opening = place < 1 ? 6 * place * (1 - place) / coil.straightEnd : 0;
      length += std::hypot(inside * line.norm(), radius * open * around, radius * opening) / kSteps;
    }
    return length;
  };
  double low = narrowest, high = wireLength;
  for (int i = 0; i < kHalvings; ++i) (lengthFor((low + high) / 2) < wireLength ? low : high) = (low + high) / 2;
  coil.coilRadius = low;
  return lengthFor(low);
}

}  // namespace cradle
