// One contact of friction coefficient mu, with the normal component eliminated: z_n = p + c . z_t from u_n = 0, and
// u_t = S z_t + b, where S is the Schur complement of G_nn in G, and b that of the free velocity. A sliding contact has
// u_t = -alpha z_t with alpha > 0, so that
//   (S + alpha) z_t = -b, |z_t| = mu z_n,   (1)
// one equation for alpha (compare O. Bonnefon, G. Daviet, "Quartic formulation of Coulomb 3D frictional contact",
// 2011). In the principal axes of S each component of z_t is a quotient, -b_i / (S_i + alpha).

#include "impact/single_contact.h"

#include <cmath>
#include <optional>

namespace cradle {
namespace {

// Of the trace of G: a smaller principal value of S is rounding. Constraints leave differences of far larger parts.
constexpr double kSingularTraceRatio = 1e-9;
constexpr double kAlphaRounding = 4e-16;  // of alpha: 4 unit roundoffs
// Of the cone's width: an impulse as near to its side is inside, and sticks. A tenth or ten times as much of this
// ratio, or of that above, changes no test.
constexpr double kConeRounding = 1e-12;
constexpr int kMaxRootSteps = 200;  // 5 are usual; bisection alone ends after about 100

/// The tangential problem after elimination of the normal part, in its principal axes.
class Sliding {
 public:
  Sliding(const Mat3& g, const Vec3& free, double friction)
      : friction_(friction), pressing_(-free.z() / g(2, 2)), coupling_(-g(0, 2) / g(2, 2), -g(1, 2) / g(2, 2)) {
    const double a = g(0, 0) + g(0, 2) * coupling_[0], b = g(0, 1) + g(0, 2) * coupling_[1],
                 c = g(1, 1) + g(1, 2) * coupling_[1];
    const double middle = 0.5 * (a + c), half = 0.5 * (a - c), radius = std::sqrt(half * half + b * b);
    moments_[0] = middle + radius;
    moments_[1] = middle - radius;
    // The axis of the larger moment, from the column that does not cancel.
    double x = half >= 0 ? half + radius : b, y = half >= 0 ? b : radius - half;
    const double length = std::sqrt(x * x + y * y);
    axis_ = length > 0 ? Vec2(x / length, y / length) : Vec2(1, 0);
    const Vec2 offset(free.x() + free.z() * coupling_[0], free.y() + free.z() * coupling_[1]);
    offset_ = {axis_.dot(offset), axis_.x() * offset.y() - axis_.y() * offset.x()};
    const double rounding = kSingularTraceRatio * (g(0, 0) + g(1, 1)),
                 stopped = kSingularTraceRatio * (free.norm() + std::abs(free.z()) * coupling_.norm());
    for (int i = 0; i < 2; ++i) {
      if (moments_[i] >= rounding) continue;
      moments_[i] = 0;
      if (std::abs(offset_[i]) <= stopped) offset_[i] = 0;
    }
  }

  /// The impulse that stops all motion, if that is in the cone. In a direction in which constraints leave no motion its
  /// component is free: the least one that puts the impulse into the cone.
  std::optional<Vec3> sticking() const {
    Vec2 along(part(0, 0), part(1, 0));
    if (moments_[1] == 0 && offset_[1] == 0) along[1] = leastWedging(along[0]);
    const Vec3 z = from(along);
    const double size = std::sqrt(z.x() * z.x() + z.y() * z.y());
    if (std::isfinite(size) && size <= friction_ * z.z() * (1 + kConeRounding)) return z;
    return {};
  }

  Vec3 at(double alpha) const { return from(Vec2(part(0, alpha), part(1, alpha))); }

  /// |z_t| - friction z_n, > 0 outside the cone, and its derivative.
  double excess(double alpha, double& slope) const {
    const Vec3 z = at(alpha);
    const double da = -part(0, alpha) / (moments_[0] + alpha), db = -part(1, alpha) / (moments_[1] + alpha);
    const Vec2 change(axis_.x() * da - axis_.y() * db, axis_.y() * da + axis_.x() * db);
    const double size = std::sqrt(z.x() * z.x() + z.y() * z.y());
    slope = (size > 0 ? (z.x() * change.x() + z.y() * change.y()) / size : 0) - friction_ * coupling_.dot(change);
    return size - friction_ * z.z();
  }
  double start() const { return offset_.norm() / (friction_ * pressing_); }

 private:
  using Vec2 = Eigen::Vector2d;

  Vec3 from(const Vec2& along) const {
    const Vec2 tangential(axis_.x() * along.x() - axis_.y() * along.y(), axis_.y() * along.x() + axis_.x() * along.y());
    return {tangential.x(), tangential.y(), pressing_ + coupling_.dot(tangential)};
  }

  /// The least component s along the second axis that puts an impulse, of component `first` along the first one, into
  /// the cone: first^2 + s^2 = (mu (n + c s))^2, n + c s >= 0. Zero if the impulse is in the cone without, or with no
  /// s.
  double leastWedging(double first) const {
    const double perSecond = coupling_.dot(Vec2(-axis_.y(), axis_.x()));
    const double normal = pressing_ + coupling_.dot(axis_) * first, square = friction_ * friction_;
    const double a = 1 - square * perSecond * perSecond, b = -square * normal * perSecond,
                 c = first * first - square * normal * normal, root = std::sqrt(b * b - a * c);
    if ((c <= 0 && normal >= 0) || !(root >= 0)) return 0;
    const double sum = -(b + std::copysign(root, b));
    double least = 0;
    for (const double s : {sum / a, c / sum})
      if (std::isfinite(s) && normal + perSecond * s >= 0 && (least == 0 || std::abs(s) < std::abs(least))) least = s;
    return least;
  }

  double part(int i, double alpha) const {
    const double divisor = moments_[i] + alpha;
    return offset_[i] == 0 ? 0 : -offset_[i] / divisor;  // infinite: a direction without inertia that does not stop
  }

  double friction_, pressing_;  // mu; p, the normal impulse without friction
  Vec2 coupling_;               // c
  double moments_[2];           // principal values of S, the larger one first
  Vec2 axis_, offset_;          // its principal axis; b in the principal axes
};

/// The root alpha of (1) by Newton's method, with bisection where that leaves the bracket.
double findRoot(const Sliding& sliding) {
  double slope = 0, low = 0, high = sliding.start();
  for (int i = 0; i < kMaxRootSteps && sliding.excess(high, slope) > 0; ++i) low = high, high *= 2;
  double alpha = high;
  for (int i = 0; i < kMaxRootSteps; ++i) {
    const double excess = sliding.excess(alpha, slope);
    if (excess == 0) return alpha;
    (excess > 0 ? low : high) = alpha;
    double next = alpha - excess / slope;
    if (!(next > low && next < high)) next = low + 0.5 * (high - low);
    if (std::abs(next - alpha) <= kAlphaRounding * alpha || next == low || next == high) return next;
    alpha = next;
  }
  return alpha;
}

}  // namespace

Vec3 solveSingleContact(const Mat3& g, const Vec3& free, double friction) {
  if (free.z() >= 0 || !(g(2, 2) > 0)) return Vec3::Zero();
  if (friction == 0) return {0, 0, -free.z() / g(2, 2)};
  const Sliding sliding(g, free, friction);
  if (const std::optional<Vec3> sticking = sliding.sticking()) return *sticking;
  Vec3 z = sliding.at(findRoot(sliding));
  const double size = std::sqrt(z.x() * z.x() + z.y() * z.y());
  if (size > 0) z.head<2>() *= friction * z.z() / size;
  return z;
}

}  // namespace cradle
