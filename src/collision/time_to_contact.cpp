// Time of impact of a sphere on a parabola with a fixed box. Let x be the centre in the box's frame, h the half size,
// and e_i = |x_i| - h_i. The squared distance of the centre from the box is
//   d^2 = sum of e_i^2 over the axes i along which the centre is outside, e_i > 0.   (1)
// As long as the centre stays on the same sides of the box's planes, each e_i is a quadratic in time. The path is cut
// where it crosses these planes; between cuts d^2 has degree 4 at most. Its minima and maxima are isolated by the roots
// of its second derivative, a quadratic, and the root of d - radius between them is refined on (1) itself, not on
// expanded coefficients, which would lose digits far from the box's centre.

#include "collision/time_to_contact.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cradle {
namespace {

// Newton steps or bisections for a root. Five are usual; bisection alone ends after 53 for the digits of a time, and
// some more where the time is small beside the interval.
constexpr int kMaxClosingSteps = 200;
constexpr double kRootRounding = 4 * std::numeric_limits<double>::epsilon();  // of a time: steps below it are rounding

/// Ascending times in an interval; both ends are among them.
class Cuts {
 public:
  Cuts(double from, double to) : times_{from, to} {}

  /// Keeps a time if it is inside.
  void add(double time) {
    if (time > times_[0] && time < times_[count_ - 1]) {
      times_[count_] = times_[count_ - 1], times_[count_ - 1] = time;
      std::sort(times_.begin() + 1, times_.begin() + static_cast<std::ptrdiff_t>(count_));
      ++count_;
    }
  }

  /// Keeps the real roots of c + b t + a t^2.
  void addRoots(double a, double b, double c) {
    const double discriminant = b * b - 4 * a * c;
    if (discriminant < 0) return;
    const double sum = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
    if (a != 0) add(sum / a);
    if (sum != 0) add(c / sum);
  }

  std::size_t pieces() const { return count_ - 1; }
  double from(std::size_t piece) const { return times_[piece]; }
  double to(std::size_t piece) const { return times_[piece + 1]; }

 private:
  std::array<double, 16> times_;  // both ends and at most 12 cuts: 6 planes, each crossed twice
  std::size_t count_ = 2;
};

/// The gap of a sphere from a face, edge or corner, as long as that is the nearest feature.
class Approach {
 public:
  explicit Approach(double radius) : radius_(radius) {}

  /// One more axis along which the sphere's centre is outside.
  void add(double excess, double rate, double acceleration) { axes_[count_++] = {excess, rate, acceleration}; }

  std::size_t axes() const { return count_; }

  double gap(double time) const {
    double square = 0;
    for (std::size_t i = 0; i < count_; ++i) square += axes_[i].at(time) * axes_[i].at(time);
    return std::sqrt(square) - radius_;
  }

  /// Half of the first derivative of distance^2.
  double slope(double time) const {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) sum += axes_[i].at(time) * axes_[i].rateAt(time);
    return sum;
  }

  /// Derivative of the slope.
  double slopeRate(double time) const {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double rate = axes_[i].rateAt(time);
      sum += rate * rate + axes_[i].at(time) * axes_[i].acceleration;
    }
    return sum;
  }

  /// First time in [from, to] at which the gap closes.
  double firstClosing(double from, double to, double slowest) const;

 private:
  struct Axis {
    double excess, rate, acceleration;
    double at(double time) const { return excess + time * (rate + time / 2 * acceleration); }
    double rateAt(double time) const { return rate + time * acceleration; }
  };
  double closingOnFace(double from, double to, double slowest) const;
  double turningIn(double from, double to) const;
  double crossingIn(double from, double to) const;
  Cuts turnings(double from, double to) const;

  std::array<Axis, 3> axes_{};
  std::size_t count_ = 0;
  double radius_;
};

double Approach::firstClosing(double from, double to, double slowest) const {
  if (count_ == 1) return closingOnFace(from, to, slowest);
  const Cuts monotone = turnings(from, to);
  for (std::size_t i = 0; i < monotone.pieces(); ++i) {
    const double start = monotone.from(i), end = monotone.to(i);
    const double gapStart = gap(start), gapEnd = gap(end);
    if (gapEnd >= gapStart || gapEnd > 0) continue;
    if (gapStart > 0) return crossingIn(start, end);
    if (start > 0 || -slope(0) > slowest * (gapStart + radius_)) return start;
  }
  return kNever;
}

double Approach::closingOnFace(double from, double to, double slowest) const {
  const Axis& axis = axes_[0];
  const double gapFrom = axis.at(from) - radius_;
  double rate = axis.rateAt(from);
  if (from == 0 && gapFrom <= 0 && rate < 0 && -rate <= slowest) rate = 0;
  const double time = from + timeToClose(gapFrom, rate, axis.acceleration);
  return time <= to ? time : kNever;
}

/// The times at which distance^2 has a minimum or maximum: between two of these its slope keeps its sign.
Cuts Approach::turnings(double from, double to) const {
  double constant = 0, linear = 0, quadratic = 0;  // of the slope's derivative
  for (std::size_t i = 0; i < count_; ++i) {
    const Axis& axis = axes_[i];
    constant += axis.rate * axis.rate + axis.excess * axis.acceleration;
    linear += 3 * axis.rate * axis.acceleration;
    quadratic += 1.5 * axis.acceleration * axis.acceleration;
  }
  Cuts slopes(from, to), turnings(from, to);
  if (quadratic == 0) {  // no acceleration
    turnings.add(-slope(0) / constant);
    return turnings;
  }
  slopes.addRoots(quadratic, linear, constant);
  for (std::size_t i = 0; i < slopes.pieces(); ++i) turnings.add(turningIn(slopes.from(i), slopes.to(i)));
  return turnings;
}

/// The root of a slope that is monotone in an interval; the start of the interval if there is none.
double Approach::turningIn(double from, double to) const {
  const bool rises = slope(to) > 0;
  if ((slope(from) > 0) == rises) return from;
  double time = from + (to - from) / 2;
  for (int i = 0; i < kMaxClosingSteps; ++i) {
    const double found = slope(time);
    ((found > 0) == rises ? to : from) = time;
    double next = time - found / slopeRate(time);
    if (!(next > from && next < to)) next = from + (to - from) / 2;
    if (std::abs(next - time) <= kRootRounding * next || to - from <= kRootRounding * to) return next;
    time = next;
  }
  return time;
}

/// The root of a gap that falls all through an interval, > 0 at its start and <= 0 at its end: Newton's method, with
/// bisection where that leaves the bracket.
double Approach::crossingIn(double from, double to) const {
  double time = from + (to - from) / 2;
  for (int i = 0; i < kMaxClosingSteps; ++i) {
    const double found = gap(time);
    (found > 0 ? from : to) = time;
    double next = time - found * (found + radius_) / slope(time);
    if (!(next > from && next < to)) next = from + (to - from) / 2;
    if (std::abs(next - time) <= kRootRounding * next || to - from <= kRootRounding * to) return next;
    time = next;
  }
  return time;
}

/// Whether a gap cannot close before `until` (s), whatever the directions of velocity and acceleration.
bool isOutOfReach(double gap, const UniformMotion& motion, double until) {
  return gap > until * (motion.velocity.lpNorm<1>() + until / 2 * motion.acceleration.lpNorm<1>());
}

}  // namespace

Nearness nearnessOf(const Vec3& point, const PlaneCollider& plane) {
  return {plane.normal.dot(point - plane.point), plane.normal};
}

Nearness nearnessOf(const Vec3& point, const RoundedBox& box) {
  const Vec3 inBox = box.boxFromWorld * point;
  const Vec3 excess = inBox - inBox.cwiseMax(-box.halfSize).cwiseMin(box.halfSize);
  const double distance = excess.norm();
  if (distance == 0) return {-box.radius, Vec3::UnitY()};
  return {distance - box.radius, box.boxFromWorld.rotation.conjugate() * Vec3(excess / distance)};
}

double timeToClose(double gap, double rate, double acceleration) {
  if (gap <= 0 && rate < 0) return 0;
  if (rate >= 0 && acceleration >= 0) return kNever;
  const double discriminant = rate * rate - 2 * acceleration * gap;
  if (rate >= 0) return (rate + std::sqrt(std::max(0.0, discriminant))) / -acceleration;
  return discriminant < 0 ? kNever : 2 * gap / (-rate + std::sqrt(discriminant));
}

double timeToDistance(const UniformMotion& motion, double distance, const ContactSearch& search) {
  if (!motion.acceleration.isZero(0)) {
    if (isOutOfReach(motion.position.norm() - distance, motion, search.until)) return kNever;
    Approach approach(distance);
    for (int axis = 0; axis < 3; ++axis)
      approach.add(motion.position[axis], motion.velocity[axis], motion.acceleration[axis]);
    return approach.firstClosing(0, search.until, search.slowest);
  }
  // |d + u t| = distance, with |d|^2 |u|^2 - (d.u)^2 as the square of d x u, which loses nothing.
  const double closing = motion.position.dot(motion.velocity);
  if (closing >= 0) return kNever;
  const double outside = motion.position.squaredNorm() - distance * distance;
  if (outside <= 0) return -closing > search.slowest * distance ? 0 : kNever;
  const double discriminant =
      motion.velocity.squaredNorm() * distance * distance - motion.position.cross(motion.velocity).squaredNorm();
  return discriminant < 0 ? kNever : outside / (-closing + std::sqrt(discriminant));
}

double timeToContact(const UniformMotion& center, double radius, const PlaneCollider& plane,
                     const ContactSearch& search) {
  const double gap = nearnessOf(center.position, plane).distance - radius;
  double rate = plane.normal.dot(center.velocity);
  if (gap <= 0 && rate < 0 && -rate <= search.slowest) rate = 0;
  return timeToClose(gap, rate, plane.normal.dot(center.acceleration));
}

double timeToContact(const UniformMotion& center, double radius, const RoundedBox& box, const ContactSearch& search) {
  const Quat& turn = box.boxFromWorld.rotation;
  const UniformMotion inBox{box.boxFromWorld * center.position, turn * center.velocity, turn * center.acceleration};
  const double distance = radius + box.radius;
  if (box.halfSize.isZero(0)) return timeToDistance(inBox, distance, search);
  const double gap = (inBox.position.cwiseAbs() - box.halfSize).cwiseMax(0).norm() - distance;
  if (isOutOfReach(gap, inBox, search.until)) return kNever;
  Cuts cuts(0, search.until);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      cuts.addRoots(inBox.acceleration[axis] / 2, inBox.velocity[axis],
                    inBox.position[axis] - side * box.halfSize[axis]);
  for (std::size_t i = 0; i < cuts.pieces(); ++i) {
    const Vec3 middle = inBox.positionAfter(cuts.from(i) + (cuts.to(i) - cuts.from(i)) / 2);
    Approach approach(distance);
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(middle[axis]) <= box.halfSize[axis]) continue;
      const double side = middle[axis] > 0 ? 1 : -1;
      approach.add(side * inBox.position[axis] - box.halfSize[axis], side * inBox.velocity[axis],
                   side * inBox.acceleration[axis]);
    }
    if (approach.axes() == 0) return cuts.from(i);
    const double time = approach.firstClosing(cuts.from(i), cuts.to(i), search.slowest);
    if (time < kNever) return time;
  }
  return kNever;
}

}  // namespace cradle
