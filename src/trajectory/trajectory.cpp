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

bool isPossiblePlace(const Vec3& place) {
  return place.allFinite() && place.cwiseAbs().maxCoeff() < kLargest;
}

bool isPossible(const BodyState& state) {
  return isPossiblePlace(state.position) && isPossiblePlace(state.linearVelocity) &&
         isPossiblePlace(state.angularVelocity) &&
         std::abs(state.orientation.norm() - 1) < kUnitError;  // false where it is not finite
}

bool isPossible(const JointState& state) {
  const auto isPossibleNumber = [](double number) { return std::abs(number) < kLargestNumber; };
  return isPossibleNumber(state.coordinate) && isPossibleNumber(state.velocity) && isPossibleNumber(state.force);
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
