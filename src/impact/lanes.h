#pragma once

#include <cmath>
#include <cstddef>

namespace cradle {

/// Asks for something that is soon read, or written (`isWritten`), wherever it lies in memory.
template <bool isWritten, class Thing>
void fetchAhead(const Thing& thing) {
  constexpr std::size_t kLine = 64;  // bytes
  const char* from = reinterpret_cast<const char*>(&thing);
  for (std::size_t at = 0; at < sizeof(Thing); at += kLine) __builtin_prefetch(from + at, isWritten);
}

/// Two numbers of two contacts that are worked on at once: one contact a lane. All operations are those of doubles,
/// lane by lane.
using Lanes = double __attribute__((vector_size(16)));
constexpr int kLanes = 2;
using LaneMask = decltype(Lanes{} < Lanes{});

inline Lanes same(double value) {
  return Lanes{value, value};
}
inline Lanes larger(Lanes a, Lanes b) {
  return a > b ? a : b;
}
inline Lanes smaller(Lanes a, Lanes b) {
  return a < b ? a : b;
}
inline Lanes squareRoot(Lanes a) {
  return Lanes{std::sqrt(a[0]), std::sqrt(a[1])};
}

struct LaneVector {
  Lanes x, y, z;
};
inline LaneVector operator+(const LaneVector& a, const LaneVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline LaneVector operator-(const LaneVector& a, const LaneVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline LaneVector operator*(Lanes factor, const LaneVector& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}
inline Lanes dot(const LaneVector& a, const LaneVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Linear and angular part of a body's motion.
struct LaneMotion {
  LaneVector linear, angular;
};

/// The same of one body. Contiguous in pairs of numbers, so that a lane is three loads and three stores.
struct alignas(64) BodyMotion {
  Lanes xy{}, zu{}, vw{};  // linear x, y, z; angular u, v, w
};
inline BodyMotion operator+(const BodyMotion& a, const BodyMotion& b) {
  return {a.xy + b.xy, a.zu + b.zu, a.vw + b.vw};
}
inline BodyMotion operator-(const BodyMotion& a, const BodyMotion& b) {
  return {a.xy - b.xy, a.zu - b.zu, a.vw - b.vw};
}

inline LaneMotion gather(const BodyMotion& first, const BodyMotion& second) {
  const auto low = [](Lanes a, Lanes b) { return Lanes{a[0], b[0]}; };
  const auto high = [](Lanes a, Lanes b) { return Lanes{a[1], b[1]}; };
  return {{low(first.xy, second.xy), high(first.xy, second.xy), low(first.zu, second.zu)},
          {high(first.zu, second.zu), low(first.vw, second.vw), high(first.vw, second.vw)}};
}

template <int lane>
void scatter(const LaneMotion& motion, BodyMotion& body) {
  body.xy = Lanes{motion.linear.x[lane], motion.linear.y[lane]};
  body.zu = Lanes{motion.linear.z[lane], motion.angular.x[lane]};
  body.vw = Lanes{motion.angular.y[lane], motion.angular.z[lane]};
}

}  // namespace cradle
