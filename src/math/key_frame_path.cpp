#include "math/key_frame_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace cradle {
namespace {

// Most velocity and acceleration at a key frame: of the slower piece's mean velocity, and of that by the longer one's
// time. A slow piece beside a fast one would start with the fast one's otherwise, and swing back and forth before its
// end; at 0 both are 0, so that equal key frames wait.
constexpr double kMaxVelocityRatio = 2, kMaxAccelerationRatio = 4;

VectorX limited(const VectorX& vector, double most) {
  const double length = vector.norm();
  return length > most ? VectorX(most / length * vector) : vector;
}

Eigen::Matrix<double, 7, 1> valuesOf(const RigidTransform& pose) {
  Eigen::Matrix<double, 7, 1> values;
  values << pose.translation, pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z();
  return values;
}

Quat quaternionOf(const Eigen::Matrix<double, 7, 1>& values) {
  return {values[3], values[4], values[5], values[6]};
}

/// The way (m) from one key frame to the next, or the axis about which it turns, longer with the angle.
Vec3 wayBetween(const Eigen::Matrix<double, 7, 1>& from, const Eigen::Matrix<double, 7, 1>& to, bool ofOrientation) {
  if (!ofOrientation) return (to - from).head<3>();
  return (quaternionOf(to) * quaternionOf(from).conjugate()).vec();
}

/// 1 where the way goes straight on at a key frame, 0 where it turns by a right angle or more, or waits; c (2 - c), c
/// the cosine of the angle: 0.98 at 30 degrees.
double straightness(const Vec3& before, const Vec3& after) {
  const double product = before.norm() * after.norm();
  const double cosine = product > 0 ? std::max(0.0, before.dot(after) / product) : 0;
  return cosine * (2 - cosine);
}

}  // namespace

KeyFramePath::KeyFramePath(const std::vector<KeyFrame>& keys, bool repeats) : repeats_(repeats) {
  CRADLE_CHECK(keys.size() >= 2);
  for (const KeyFrame& key : keys) {
    Knot knot{key.time, valuesOf(key.pose), Values::Zero(), Values::Zero()};
    if (!knots_.empty() && knot.value.tail<4>().dot(knots_.back().value.tail<4>()) < 0) knot.value.tail<4>() *= -1;
    knots_.push_back(knot);
  }
  turnsOver_ = repeats_ && knots_.front().value.tail<4>().dot(knots_.back().value.tail<4>()) < 0;
  if (repeats_) {  // the same pose, to the last bit
    knots_.back().value = knots_.front().value;
    if (turnsOver_) knots_.back().value.tail<4>() *= -1;
  }
  findDerivatives({0, 3, 1});
  findDerivatives({3, 4, turnsOver_ ? -1.0 : 1.0});
}

/// Those of the parabola through a knot and both beside it, but never so large that a slow piece would swing out beside
/// a quick one: a piece in which nothing moves stands still. The velocity is smaller where the way turns, and zero at a
/// corner: with that of the parabola it would swing out there, and go too far where it turns back.
void KeyFramePath::findDerivatives(const Part& part) {
  const std::size_t pieces = knots_.size() - 1, first = repeats_ ? 0 : 1;
  const auto values = [&part](auto& vector) { return vector.segment(part.first, part.count); };
  const auto wayOf = [&](std::size_t piece) {
    return wayBetween(knots_[piece].value, knots_[piece + 1].value, part.first > 0);
  };
  const auto velocity = [&](std::size_t piece) {
    const Values way = knots_[piece + 1].value - knots_[piece].value;
    return VectorX(values(way) / lengthOf(piece));
  };
  for (std::size_t knot = first; knot < pieces; ++knot) {
    const std::size_t piece = (knot + pieces - 1) % pieces;
    const VectorX before = (knot == 0 ? part.seam : 1) * velocity(piece), after = velocity(knot);
    const double lengthBefore = lengthOf(piece), lengthAfter = lengthOf(knot), sum = lengthBefore + lengthAfter;
    const double slowest = std::min(before.norm(), after.norm());
    const double maxAcceleration = kMaxAccelerationRatio * slowest / std::max(lengthBefore, lengthAfter);
    values(knots_[knot].first) =
        straightness(wayOf(piece), wayOf(knot)) *
        limited((lengthAfter * before + lengthBefore * after) / sum, kMaxVelocityRatio * slowest);
    values(knots_[knot].second) = limited(2 * (after - before) / sum, maxAcceleration);
  }
  if (!repeats_) return;
  values(knots_.back().first) = part.seam * values(knots_.front().first);
  values(knots_.back().second) = part.seam * values(knots_.front().second);
}

KeyFramePath::Place KeyFramePath::placeOf(double time) const {
  Place place{0, time, false};
  if (repeats_) {
    const double rounds = std::floor((time - knots_.front().time) / period());
    place.time = std::clamp(time - rounds * period(), knots_.front().time, knots_.back().time);
    place.isTurnedOver = turnsOver_ && std::fmod(std::abs(rounds), 2) == 1;
  }
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), place.time,
                                      [](double value, const Knot& knot) { return value < knot.time; });
  const auto index = static_cast<std::size_t>(after - knots_.begin());
  place.piece = std::clamp<std::size_t>(index, 1, knots_.size() - 1) - 1;
  return place;
}

PoseMotion KeyFramePath::at(double time) const {
  const Place place = placeOf(time);
  const Knot &a = knots_[place.piece], &b = knots_[place.piece + 1];
  const double h = b.time - a.time, s = std::clamp(place.time - a.time, 0.0, h);
  // p = p0 + v0 s + a0 s^2/2 + c3 s^3 + c4 s^4 + c5 s^5 (C. Hermite's interpolation)
  const Values way = b.value - a.value;
  const Values c3 = (10 * way / h - (6 * a.first + 4 * b.first)) / (h * h) - (1.5 * a.second - 0.5 * b.second) / h;
  const Values c4 = ((-15 * way / h + 8 * a.first + 7 * b.first) / h + 1.5 * a.second - b.second) / (h * h);
  const Values c5 = ((6 * way / h - 3 * (a.first + b.first)) / h - 0.5 * (a.second - b.second)) / (h * h * h);
  Values value = a.value + s * (a.first + s * (a.second / 2 + s * (c3 + s * (c4 + s * c5))));
  Values first = a.first + s * (a.second + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)));
  Values second = a.second + s * (6 * c3 + s * (12 * c4 + s * 20 * c5));
  if (place.isTurnedOver) value.tail<4>() *= -1, first.tail<4>() *= -1, second.tail<4>() *= -1;
  PoseMotion motion;
  motion.velocity = first.head<3>(), motion.acceleration = second.head<3>();
  // With the quaternion q, not of unit length: w = 2 Im(q' q*) / |q|^2, and its rate by the rule for quotients.
  const Quat q = quaternionOf(value), conjugate = q.conjugate();
  const double square = q.squaredNorm(), growth = 2 * first.tail<4>().dot(value.tail<4>()) / square;
  motion.pose = {q.normalized(), value.head<3>()};
  motion.angularVelocity = 2 * (quaternionOf(first) * conjugate).vec() / square;
  motion.angularAcceleration = 2 * (quaternionOf(second) * conjugate).vec() / square - growth * motion.angularVelocity;
  return motion;
}

double KeyFramePath::nextKey(double time) const {
  const Place place = placeOf(time);
  const double passed = time - place.time;
  for (std::size_t i = place.piece; i < knots_.size(); ++i)
    if (knots_[i].time + passed > time) return knots_[i].time + passed;
  return repeats_ ? knots_[1].time + passed + period() : std::numeric_limits<double>::infinity();
}

double KeyFramePath::lengthAt(double time) const {
  const bool isBeside = !repeats_ && (time < knots_.front().time || time >= knots_.back().time);
  return isBeside ? std::numeric_limits<double>::infinity() : lengthOf(placeOf(time).piece);
}

bool KeyFramePath::isStill(double time) const {
  if (!repeats_ && (time < knots_.front().time || time >= knots_.back().time)) return true;
  const std::size_t piece = placeOf(time).piece;
  const Knot &a = knots_[piece], &b = knots_[piece + 1];
  return a.value == b.value && a.first.isZero(0) && b.first.isZero(0) && a.second.isZero(0) && b.second.isZero(0);
}

std::vector<Vec3> KeyFramePath::hull() const {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
    const Knot &a = knots_[i], &b = knots_[i + 1];
    const double h = b.time - a.time;
    const Values points7[] = {a.value,
                              a.value + h / 5 * a.first,
                              a.value + 2 * h / 5 * a.first + h * h / 20 * a.second,
                              b.value - 2 * h / 5 * b.first + h * h / 20 * b.second,
                              b.value - h / 5 * b.first,
                              b.value};
    for (const Values& point : points7) points.push_back(point.head<3>());
  }
  return points;
}

void KeyFramePath::shift(const Vec3& by) {
  for (Knot& knot : knots_) knot.value.head<3>() += by;
}

}  // namespace cradle
