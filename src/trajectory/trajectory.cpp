#include "trajectory/trajectory.h"

#include <array>
#include <cmath>

#include "core/error.h"

namespace cradle {
namespace {

constexpr std::array<const char*, 12> kEventKindNames = {"impact", "taut",      "slack",   "rest",
                                                         "slip",   "stick",     "roll",    "release",
                                                         "wake",   "pushStart", "pushEnd", "pushMissed"};

constexpr double kLargest = 1e30;  // m: 1e12 m/s^2 for 1e9 s come to less
constexpr double kUnitError = 1e-3;

}  // namespace

bool isPossible(const BodyState& state) {
  const auto isBelow = [](const Vec3& vector) { return vector.cwiseAbs().maxCoeff() < kLargest; };
  return state.position.allFinite() && isBelow(state.position) && state.linearVelocity.allFinite() &&
         isBelow(state.linearVelocity) && state.angularVelocity.allFinite() && isBelow(state.angularVelocity) &&
         std::abs(state.orientation.norm() - 1) < kUnitError;  // false where it is not finite
}

std::string eventKindName(EventKind kind) {
  return kEventKindNames.at(static_cast<std::size_t>(kind));
}

EventKind eventKindFromName(const std::string& name) {
  for (std::size_t i = 0; i < kEventKindNames.size(); ++i)
    if (name == kEventKindNames[i]) return static_cast<EventKind>(i);
  throw Error(ErrorKind::scene, "", "unknown event kind \"" + name + "\" in a trajectory");
}

}  // namespace cradle
