#include "dynamics/polhode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "math/jacobi_elliptic.h"
#include "math/principal_axes.h"

// L. Landau, E. Lifshitz, "Mechanics", sec. 37. With the inverse moments h_i, m' = |L| m x (h_1 m_1, h_2 m_2, h_3 m_3)
// keeps |m| = 1 and, p = |h_1 - h_2| and r = |h_2 - h_3|, the difference e = r m_3^2 - p m_1^2, which is > 0 if m goes
// round axis 3 and 0 on the separatrix. All else is made of e by sums of positive terms, so that rounding acts as if
// the moments had been rounded, near the separatrix, near a symmetric body and near a principal axis too.

namespace cradle {
namespace {

/// Principal moments, ascending, and the components of a unit vector along their axes.
struct Ascending {
  Vec3 moments;
  Mat3 axes;  // columns, in the body's frame
  Vec3 direction;
};

Ascending ascending(const Mat3& inertiaTensor, const Vec3& direction) {
  const PrincipalAxes principal = principalAxes(inertiaTensor);
  std::array<Eigen::Index, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](auto i, auto j) { return principal.moments[i] < principal.moments[j]; });
  Ascending sorted;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index from = order[static_cast<std::size_t>(i)];
    sorted.moments[i] = principal.moments[from];
    sorted.axes.col(i) = principal.axes.col(from);
  }
  CRADLE_CHECK(sorted.moments[2] > 0);
  // Rounding may make the moment of a needle about itself 0 or less.
  sorted.moments = sorted.moments.cwiseMax(std::numeric_limits<double>::epsilon() * sorted.moments[2]);
  // Below this squares would underflow. Next to an unstable axis such a component takes 276 times the time in which it
  // grows e-fold to show.
  constexpr double kNothing = 1e-120;
  sorted.direction = sorted.axes.transpose() * direction;
  sorted.direction = (sorted.direction.array().abs() < kNothing).select(0, sorted.direction);
  return sorted;
}

/// Difference of the inverses of two ascending moments, times the largest one; exact where they are nearly equal.
double inverseDifference(const Vec3& moments, int smaller, int larger) {
  return (moments[larger] - moments[smaller]) / moments[smaller] * (moments[2] / moments[larger]);
}

struct Differences {
  double p, r;
};

/// Numbers the axes: a proper rotation, with m_1 and m_3 >= 0.
void placeAxes(const Ascending& sorted, Polhode& polhode) {
  const int third = polhode.sense > 0 ? 2 : 0, first = 2 - third;
  const auto side = [&](int i) { return std::copysign(1.0, sorted.direction[i]); };
  Mat3 axes;
  axes.col(0) = side(first) * sorted.axes.col(first);
  axes.col(2) = side(third) * sorted.axes.col(third);
  axes.col(1) = axes.col(2).cross(axes.col(0));
  const double middleSide = axes.col(1).dot(sorted.axes.col(1)) > 0 ? 1 : -1;
  polhode.bodyFromAxes = Quat(axes).normalized();
  polhode.start = {std::fabs(sorted.direction[first]), middleSide * sorted.direction[1],
                   std::fabs(sorted.direction[third])};
  polhode.inverseMoments = {1 / sorted.moments[first], 1 / sorted.moments[1], 1 / sorted.moments[third]};
}

void computeMotion(const Differences& h, double largestMoment, Polhode& polhode) {
  const Vec3 square = polhode.start.cwiseAbs2();
  const double both = h.p + h.r, e = std::fmax(0, h.r * square[2] - h.p * square[0]), ep = e + h.p;
  const double a = std::sqrt(square[2] + h.p / both * square[1]);
  const double b1 = std::sqrt(square[0] + h.r / both * square[1]);
  const double b2 = polhode.sense * std::sqrt(square[1] + both / h.r * square[0]);
  constexpr double kMinComplement = 1e-145;  // as good as 0, the separatrix, until u = K = 335
  polhode.amplitude = {b1, b2, a};
  polhode.complement = std::fmin(1, std::fmax(kMinComplement, std::sqrt(e / ep) * std::sqrt(both / h.r)));
  polhode.modulus = std::fmin(1, std::sqrt(h.p / ep) * std::sqrt(square[1] + both / h.r * square[0]));
  polhode.rate = polhode.momentum / largestMoment * std::sqrt(h.r) * std::sqrt(ep);
  polhode.argument = ellipticArgument({polhode.start[1] / b2, polhode.start[0] / b1, polhode.start[2] / a});
}

}  // namespace

std::optional<Polhode> polhodeOf(const Mat3& inertiaTensor, const Vec3& angularMomentum) {
  Polhode polhode;
  polhode.momentum = angularMomentum.stableNorm();
  if (polhode.momentum == 0) return {};
  const Ascending sorted = ascending(inertiaTensor, angularMomentum / polhode.momentum);
  const double low = inverseDifference(sorted.moments, 0, 1), high = inverseDifference(sorted.moments, 1, 2);
  const Vec3& m = sorted.direction;
  const bool isSteady = (low + high) * m[0] * m[2] == 0 && high * m[1] * m[2] == 0 && low * m[0] * m[1] == 0;
  if (isSteady) return {};
  const double balance = high * m[2] * m[2] - low * m[0] * m[0];
  const bool goesRoundLargest = balance > 0 || (balance == 0 && high > low);
  polhode.sense = goesRoundLargest ? 1 : -1;
  placeAxes(sorted, polhode);
  computeMotion(goesRoundLargest ? Differences{low, high} : Differences{high, low}, sorted.moments[2], polhode);
  return polhode;
}

}  // namespace cradle
