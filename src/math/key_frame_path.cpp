#include "math/key_frame_path.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace cradle {
namespace {

/// Derivatives of the third and fourth order at the start of a piece of degree 5 and length h, or at its end, by the
/// values at its ends: c[0] (p1 - p0) + c[1] v0 + c[2] a0 + c[3] v1 + c[4] a1, where each is divided by a power of h.
struct EndDerivative {
  double difference, firstAtStart, secondAtStart, firstAtEnd, secondAtEnd;

  EndDerivative over(int order, double length) const {
    double n = 1;
    for (int i = 0; i < order; ++i) n *= length;
    return {difference / n, firstAtStart * length / n, secondAtStart * length * length / n, firstAtEnd * length / n,
            secondAtEnd * length * length / n};
  }
};
constexpr EndDerivative kThirdAtStart{60, -36, -9, -24, 3}, kThirdAtEnd{60, -24, -3, -36, 9};
constexpr EndDerivative kFourthAtStart{-360, 192, 36, 168, -24}, kFourthAtEnd{360, -168, -24, -192, 36};

Eigen::Matrix<double, 7, 1> valuesOf(const RigidTransform& pose) {
  Eigen::Matrix<double, 7, 1> values;
  values << pose.translation, pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z();
  return values;
}

Quat quaternionOf(const Eigen::Matrix<double, 7, 1>& values) {
  return {values[3], values[4], values[5], values[6]};
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
  solveDerivatives({0, 3, 1});
  solveDerivatives({3, 4, turnsOver_ ? -1.0 : 1.0});
}

/// Unknown are first and second derivatives at the knots between the ends, or, of a way that repeats, at all but the
/// last; equations, that third and fourth derivatives are the same on both sides of each.
void KeyFramePath::solveDerivatives(const Part& part) {
  const std::size_t pieces = knots_.size() - 1, first = repeats_ ? 0 : 1;
  if (pieces == first) return;
  const auto columnOf = [first](std::size_t knot) { return 2 * static_cast<Eigen::Index>(knot - first); };
  // Unknowns and rows are scaled by the shorter of both pieces at a knot, so that all entries are of order 100 at most.
  const auto scaleOf = [this, pieces](std::size_t knot) {
    const std::size_t before = (knot + pieces - 1) % pieces;
    return std::min(lengthOf(before), lengthOf(knot % pieces));
  };
  const auto values = [&part](auto& vector) { return vector.segment(part.first, part.count); };
  std::vector<Eigen::Triplet<double>> entries;
  MatrixX right = MatrixX::Zero(columnOf(pieces), part.count);
  const auto addKnot = [&](Eigen::Index row, std::size_t knot, double ofFirst, double ofSecond) {
    if (!repeats_ && (knot == 0 || knot == pieces)) return;  // at rest
    const double seam = knot == pieces ? part.seam : 1;
    const Eigen::Index column = columnOf(knot == pieces ? 0 : knot);
    const double scale = scaleOf(knot);
    entries.emplace_back(row, column, seam * ofFirst / scale);
    entries.emplace_back(row, column + 1, seam * ofSecond / (scale * scale));
  };
  const auto add = [&](Eigen::Index row, std::size_t piece, const EndDerivative& derivative, double sign) {
    const Values way = knots_[piece + 1].value - knots_[piece].value;
    right.row(row) -= sign * derivative.difference * values(way).transpose();
    addKnot(row, piece, sign * derivative.firstAtStart, sign * derivative.secondAtStart);
    addKnot(row, piece + 1, sign * derivative.firstAtEnd, sign * derivative.secondAtEnd);
  };
  for (std::size_t knot = first; knot < pieces; ++knot) {
    const std::size_t before = (knot + pieces - 1) % pieces;
    const double sign = knot == 0 ? part.seam : 1, scale = scaleOf(knot), third = scale * scale * scale,
                 fourth = third * scale;
    add(columnOf(knot), before, kThirdAtEnd.over(3, lengthOf(before)), sign * third);
    add(columnOf(knot), knot, kThirdAtStart.over(3, lengthOf(knot)), -third);
    add(columnOf(knot) + 1, before, kFourthAtEnd.over(4, lengthOf(before)), sign * fourth);
    add(columnOf(knot) + 1, knot, kFourthAtStart.over(4, lengthOf(knot)), -fourth);
  }
  Eigen::SparseMatrix<double> matrix(columnOf(pieces), columnOf(pieces));
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  CRADLE_CHECK(solver.info() == Eigen::Success);
  const MatrixX derivatives = solver.solve(right);
  for (std::size_t knot = first; knot <= pieces; ++knot) {
    if (knot == pieces && !repeats_) continue;
    const double seam = knot == pieces ? part.seam : 1;
    const Eigen::Index row = columnOf(knot == pieces ? 0 : knot);
    const double scale = scaleOf(knot);
    values(knots_[knot].first) = seam / scale * derivatives.row(row).transpose();
    values(knots_[knot].second) = seam / (scale * scale) * derivatives.row(row + 1).transpose();
  }
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
